"""A recorded speed of something else, and a command that is a copy: said, and not refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.plausibility.columns.agreement import command_remarks, plan_remarks, speed_remarks

TIME = np.arange(0.0, 20.0, 0.008)
RATE = np.array([1.0, 1.3, 1.7, 2.1, 2.6, 0.0])
Q = np.sin(TIME[:, None] * RATE) + 0.2
SPEED = RATE * np.cos(TIME[:, None] * RATE)
NOISE = np.random.default_rng(5).standard_normal(Q.shape)
LOG = Log(TIME, Q, 10 * Q + 0.1 * NOISE)


def test_angles_under_the_name_of_speeds_are_told() -> None:
    log = replace(LOG, qd=Q)
    [said] = speed_remarks(log)
    assert said.startswith("the recorded speed of joints 1, 2, 3")
    assert said in check_log(None, log).remarks
    assert check_log(None, log).sound


@pytest.mark.parametrize("kind", ["exact", "noisy", "noisier", "late", "coarse"])
def test_a_speed_of_the_joint_is_none_of_these(kind: str) -> None:
    late = np.roll(SPEED, 24, axis=0)
    speeds = {
        "exact": SPEED,
        "noisy": SPEED + 0.5 * NOISE,
        "noisier": SPEED + 1.5 * NOISE,
        "late": late,
        "coarse": np.round(2.0 * SPEED) / 2.0,
    }
    assert speed_remarks(replace(LOG, qd=speeds[kind])) == []


def test_one_speed_of_something_else_is_told() -> None:
    speed = SPEED.copy()
    speed[:, 3] = NOISE[:, 3]
    [said] = speed_remarks(replace(LOG, qd=speed))
    assert "recorded speed of joint 4 has nothing" in said


def test_a_command_that_is_a_copy_is_told() -> None:
    [said] = command_remarks(replace(LOG, q_ref=Q))
    assert "joints 1, 2, 3, 4, 5 are the same to the last digit" in said
    assert command_remarks(replace(LOG, q_ref=Q + 1e-6)) == []
    assert command_remarks(LOG) == []


def test_the_columns_of_a_plan_are_told() -> None:
    """`diagnose plan/trajectory.csv` said that a body is off, of torques that the model had
    made."""
    planned = {f"qdd{j + 1}_deg_s2": Q[:, j] for j in range(Q.shape[1])}
    [said] = plan_remarks(replace(LOG, extra=planned | {"s": Q[:, 0]}))
    assert "are those of a plan" in said
    assert said in check_log(None, replace(LOG, extra=planned | {"s": Q[:, 0]})).remarks
    assert plan_remarks(replace(LOG, extra=planned)) == []
    assert plan_remarks(LOG) == []
