"""A joint whose zero is not the file's turns the joints behind it, and that is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from other_arm_logs import other_arm_log

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting import zeros
from irb2400_ctrl.identification.fitting.fit import fit
from irb2400_ctrl.identification.fitting.given import given_torque
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.fitting.zeros import Zero, other_zeros
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def off(log: Log, joint: int, degrees: float) -> Log:
    """The log with more on the angle of one joint."""
    q = log.q.copy()
    q[:, joint - 1] += np.radians(degrees)
    return replace(log, q=q, q_ref=None)


def told(robot: Robot, log: Log) -> list[Zero]:
    """Zeros that are not the file's."""
    base, kept = fit_base(robot)
    model = Model(base)
    parts = given_torque(kept, [motion_of(log, "angle")])
    return other_zeros(model, fit(model, parts), parts)


def test_a_zero_that_is_off_on_a_seven_axis_arm_is_said() -> None:
    drawn = other_arm_log(71159)
    found = irb.identify(drawn.robot, off(drawn.log, 4, 12.0))
    (note,) = [note for note in found.notes if "zero of joint" in note]
    assert note.startswith("the zero of joint 4 is not the file's: with -10.4 ")
    assert found.of_bodies == []


@pytest.mark.parametrize(
    ("seed", "joint", "degrees"),
    [(71160, 4, 12.0), pytest.param(71161, 3, -15.0, marks=pytest.mark.slow)],
)
def test_how_far_it_is_off_is_within_what_is_said(seed: int, joint: int, degrees: float) -> None:
    """Joint 3 between parallel axes shows least, and only beside what is left with it."""
    drawn = other_arm_log(seed)
    (zero,) = told(drawn.robot, off(drawn.log, joint, degrees))
    assert zero.joint == joint
    assert abs(zero.off + np.radians(degrees)) < 3.0 * zero.error
    assert zero.error < np.radians(1.5)
    assert zero.left < 0.8


@pytest.mark.parametrize("seed", [71156, 71159])
def test_nothing_is_said_of_arms_whose_zeros_are_right(seed: int) -> None:
    drawn = other_arm_log(seed)
    assert told(drawn.robot, drawn.log) == []


def test_a_log_too_short_for_stretches_tells_none() -> None:
    drawn = other_arm_log(71161)
    log = drawn.log
    inside = log.time < log.time[0] + 4.0
    short = Log(log.time[inside], log.q[inside], log.tau[inside], name="short")
    assert told(drawn.robot, off(short, 3, -15.0)) == []


def test_a_zero_that_predicts_no_better_is_not_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zeros, "LESS", 0.01)
    drawn = other_arm_log(71160)
    assert told(drawn.robot, off(drawn.log, 4, 12.0)) == []
