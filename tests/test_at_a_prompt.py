"""What stands at a prompt of what holds many numbers: one line."""

from __future__ import annotations

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.watch import Watch

ROBOT = irb.load_robot("irb2400")


def test_a_motion_is_one_line() -> None:
    move = irb.planners.joint_move(irb.Model(ROBOT), np.zeros(6), np.full(6, 0.2)).trajectory
    rows = len(move.time)
    assert repr(move) == f"<Trajectory: {rows} rows of 6 joints, {move.duration:.3f} s>"


def test_a_log_and_its_watch_are_one_line() -> None:
    time = np.arange(500) / 250.0
    log = Log(time, np.zeros((500, 6)), np.zeros((500, 6)), name="still.csv")
    assert repr(log) == "<Log still.csv: 500 samples of 6 joints, 1.996 s>"
    watch = Watch(ROBOT, learn=20.0)
    list(watch.feed(log))
    assert repr(watch) == "<Watch of ABB IRB 2400: nothing learned yet, 0 blocks seen>"


def test_what_a_script_makes_first_is_one_line() -> None:
    assert repr(ROBOT) == f"<Robot ABB IRB 2400: 6 joints, {len(ROBOT.effects)} effects>"
    assert str(ROBOT) == repr(ROBOT)
    circle = irb.planners.builders.circle((0.95, 0.0, 0.6), 0.15, feed=0.1)
    points = len(circle.position)
    assert repr(circle) == f"<ToolPath {circle.name}: {points} points with tool axes>"
    block = irb.controller("gravity_pd", ROBOT)
    assert repr(block).startswith("<Block gravity_pd: q qd q_ref ")
    assert repr(block).endswith(", every 1 ms>")
