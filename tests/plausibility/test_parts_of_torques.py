"""Torques that hold a part of what an arm needs, and columns of something else among the joints."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from other_arm_logs import other_arm_log
from robots.imported import robot
from sound_logs import Drawn, sound_log

import irb2400_ctrl as irb
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log, log_problem, search
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.parts import best_part
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.reading import motion_readings
from irb2400_ctrl.plausibility.rows import Rows
from irb2400_ctrl.robot import Robot, load_robot

ROBOT = load_robot("irb2400")
RNG = np.random.default_rng(7)


@cache
def plain() -> Drawn:
    return sound_log(601, plain=True)


def weight(arm: Robot, log: Log) -> np.ndarray:
    """Torque that holds the postures of a log."""
    rest = 0.0 * log.q
    return np.asarray(irb.Model(arm).inverse_dynamics(log.q, rest, rest, friction=False))


def part(problem: LogProblem | None) -> object:
    return None if problem is None else problem.fits.get("part", problem.kind)


@pytest.mark.parametrize("seed", [None, 990003])
def test_torques_without_gravity_are_told(seed: int | None) -> None:
    """A controller that holds the arm by itself publishes what comes on top: no unit, sign or order
    of it fits, and of 24 arms eight were called sound."""
    drawn = plain() if seed is None else other_arm_log(seed)
    tau = drawn.log.tau - weight(drawn.robot, drawn.log)
    assert part(log_problem(drawn.robot, replace(drawn.log, tau=tau))) == "without_gravity"
    assert log_problem(drawn.robot, drawn.log) is None


@pytest.mark.parametrize("seed", [None, 990001])
def test_gravity_alone_is_told_and_no_clock(seed: int | None) -> None:
    """Beside a clock a thousand times too slow nothing is left of a motion but its postures."""
    drawn = plain() if seed is None else other_arm_log(seed)
    tau = weight(drawn.robot, drawn.log)
    tau = tau + 1e-6 * np.abs(tau).max() * RNG.standard_normal(tau.shape)
    log = replace(drawn.log, tau=tau, qd=None)
    assert part(log_problem(drawn.robot, log)) == "gravity"


def test_a_reading_that_fits_better_than_a_part_is_what_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def near(nominal: Nominal, rows: Rows, labelled: Fit) -> tuple[Fit, LogProblem]:
        fit = Fit(0.6 * labelled.cost, 50.0, 0.5 * labelled.left)
        assert search.clearly_better(fit, labelled)
        return fit, LogProblem("torque_part", "a part")

    monkeypatch.setattr(search, "best_part", near)
    found = log_problem(ROBOT, replace(plain().log, tau=-plain().log.tau))
    assert found is not None
    assert found.kind == "torque_sign"


def test_a_clock_that_slows_a_possible_motion_down_is_no_reading_beside_a_part() -> None:
    log = ur_log()
    arm = robot("ur10e")
    slow = {r.clock: r for r in motion_readings(arm) if r.kind == "time_scale"}
    assert search._slowed(arm, log, slow[1e3])
    assert not search._slowed(arm, log, slow[min(slow)])
    # of degrees under the name of radians the clock may be what is wrong
    assert not search._slowed(arm, replace(log, q=np.degrees(log.q)), slow[1e3])


@pytest.mark.parametrize(
    ("left", "travel", "torque", "asked"),
    [
        (0.3, 0.5, 10.0, True),
        (0.1, 0.5, 10.0, False),
        (0.9, 0.01, 10.0, False),
        (0.9, 0.5, 0.5, False),
    ],
)
def test_gravity_alone_is_asked_of_what_moves_and_has_torque(
    left: float, travel: float, torque: float, asked: bool
) -> None:
    t = np.linspace(0.0, 6.0, 50)[:, None]
    q = np.sin(t) * [0.5, travel]
    tau = np.cos(t) * [100.0, torque]
    rows = Rows(q, q, q, q, q > 9.0, tau, 6.0, np.linspace(0.0, 6.0, len(q)))
    fits: list[bool] = []

    def explained(of: Rows, columns: object) -> Fit:
        fits.append(bool(of.qd.any()))
        return Fit(float(len(fits)), 1.0, np.zeros(2))

    nominal: Any = SimpleNamespace(columns=lambda of: (of.q, of.q), explained=explained)
    _, said = best_part(nominal, rows, Fit(90.0, 90.0, np.array([0.02, left])))
    assert fits == [True, *[False] * asked]
    assert said.fits == {"part": "without_gravity"}


@pytest.mark.parametrize(("travel", "kind"), [(0.0, None), (0.5, "torque_part")])
def test_what_holds_a_joint_at_rest_tells_no_part(
    monkeypatch: pytest.MonkeyPatch, travel: float, kind: str | None
) -> None:
    """Its dry friction may be any: three runs of a real arm of guessed bodies were refused."""
    time = time_of()
    q = ur_log().q.copy()
    q[:, 5] = travel * np.sin(0.9 * time)
    tau = ur_log().tau.copy()
    tau[:, 5] = 5.0 * np.sin(3.1 * time)

    def without_that_joint(nominal: Nominal, rows: Rows, labelled: Fit) -> tuple[Fit, LogProblem]:
        left = np.append(labelled.left[:5], 0.0)
        return Fit(labelled.cost - 1e3, 20.0, left), LogProblem("torque_part", "a part")

    monkeypatch.setattr(search, "best_part", without_that_joint)
    understood = search.understand(robot("ur10e"), Log(time, q, tau))
    assert understood is not None
    assert not search.sound(understood.labelled, 6)
    found = understood.problem
    assert (None if found is None else found.kind) == kind


def among_the_joints(angle: np.ndarray, torque: np.ndarray) -> Log:
    """A gripper in the place of joint 4: what follows goes on by one, and joint 6 is lost."""
    log = plain().log
    q = np.column_stack([log.q[:, :3], angle, log.q[:, 3:5]])
    tau = np.column_stack([log.tau[:, :3], torque, log.tau[:, 3:5]])
    return Log(log.time, q, tau)


def test_a_gripper_among_the_joints_is_told() -> None:
    """Closed all the time it ended in a singular matrix; moved, its torque was called one in
    kNm."""
    time = plain().log.time
    closed = log_problem(ROBOT, among_the_joints(0.0 * time + 0.3, 0.0 * time))
    assert closed is not None
    assert (closed.kind, closed.joints) == ("zero_torque", (4,))
    assert "gripper" in closed.says
    ur = robot("ur10e")
    drawn = replace(ur_log(), q=np.insert(ur_log().q[:, :5], 3, 0.3 + 0.2 * np.sin(time_of()), 1))
    drawn = replace(drawn, tau=np.insert(ur_log().tau[:, :5], 3, 0.01 * np.sin(5 * time_of()), 1))
    moved = log_problem(ur, drawn)
    assert moved is not None
    assert moved.kind == "not_this_robot"


@cache
def ur_log() -> Log:
    """A UR10e on sines, friction besides."""
    time = np.arange(0.0, 25.0, 0.008)
    rate = np.array([0.35, 0.45, 0.55, 0.7, 0.8, 0.9])
    size = np.array([0.9, 0.7, 0.8, 1.2, 1.2, 1.5])
    q = size * np.sin(time[:, None] * rate) + np.array([0.0, -1.5, 1.5, -1.0, 1.5, 0.0])
    qd = size * rate * np.cos(time[:, None] * rate)
    qdd = -size * rate**2 * np.sin(time[:, None] * rate)
    tau = np.asarray(irb.Model(robot("ur10e")).inverse_dynamics(q, qd, qdd, friction=False))
    tau = tau + np.array([9.0, 9.0, 6.0, 2.0, 2.0, 2.0]) * np.tanh(qd / 0.02)
    return Log(time, q, tau + 0.05 * RNG.standard_normal(tau.shape))


def time_of() -> np.ndarray:
    return ur_log().time


def test_a_joint_at_rest_that_needs_no_torque_is_not_refused() -> None:
    """Of an upright first axis gravity asks nothing, with a brake or without."""
    log = ur_log()
    rest = 0.0 * log.q[:, 0]
    q = np.column_stack([rest + 0.2, log.q[:, 1:]])
    qd = np.gradient(q, log.time, axis=0)
    qdd = np.gradient(qd, log.time, axis=0)
    tau = np.asarray(irb.Model(robot("ur10e")).inverse_dynamics(q, qd, qdd, friction=False))
    assert (
        log_problem(robot("ur10e"), Log(log.time, q, np.column_stack([rest, tau[:, 1:]]))) is None
    )


def test_one_reading_twice_is_said_once() -> None:
    slow = next(r for r in motion_readings(ROBOT) if r.clock == 1e3)
    twice = slow.after(slow)
    assert twice.clock == 1e6
    assert twice.says == slow.says


@pytest.mark.parametrize(("seed", "share"), [(None, 0.0), (None, 0.3), (990001, 0.0)])
def test_torques_of_a_model_are_told_by_the_friction_that_they_lack(
    seed: int | None, share: float
) -> None:
    """`target_moment` of a Universal Robot: `identify` remarked on it, `log check` did not."""
    drawn = plain() if seed is None else other_arm_log(seed)
    model = irb.Model(drawn.robot)
    qd = np.gradient(drawn.log.q, drawn.log.time, axis=0)
    qdd = np.gradient(qd, drawn.log.time, axis=0)
    rigid = np.asarray(model.inverse_dynamics(drawn.log.q, qd, qdd, friction=False))
    friction = share * np.sqrt(np.mean(rigid**2, axis=0)) * np.tanh(qd / 0.01)
    made = check_log(drawn.robot, replace(drawn.log, tau=rigid + friction))
    said = [remark for remark in made.remarks if remark.startswith("the torques hold no friction")]
    # an iiwa's or a Doosan's are measured all the same
    assert all("and those of sensors behind the gears" in remark for remark in said)
    assert len(said) == (share == 0.0)
    assert not any("no friction" in one for one in check_log(drawn.robot, drawn.log).remarks)


def test_angles_in_turns_are_told() -> None:
    drawn = plain()
    turns = replace(drawn.log, q=drawn.log.q / (2.0 * np.pi), q_ref=None, qd=None)
    found = log_problem(drawn.robot, turns)
    assert found is not None
    assert (found.kind, found.fits["factor"]) == ("angle_unit", pytest.approx(2.0 * np.pi))
