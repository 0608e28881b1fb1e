"""Dry friction that turns over within a milliradian or two is no hysteresis; a loop is one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.selection import UNSETTLED
from irb2400_ctrl.effects.hysteresis import Hysteresis
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")


def sliders(q: npt.NDArray[np.float64], angle: float) -> npt.NDArray[np.float64]:
    """Maxwell slip: three contacts of a third each that hold over 0.4, 1 and 2.2 times an angle,
    between -1 and 1."""
    breadth = angle * np.array([0.4, 1.0, 2.2])
    stuck = np.zeros(3)
    found = np.zeros(len(q))
    for k, step in enumerate(np.diff(q, prepend=q[0])):
        stuck = np.clip(stuck + step / breadth, -1.0, 1.0)
        found[k] = stuck.mean()
    return found


def log_of(joint: int, angle: float, *, in_place: bool) -> Log:
    """A sound arm with contacts of 8 Nm on a joint (from 1): `in_place` of as much dry friction,
    or beside it."""
    log = Case(77, duration=25.0, validation_duration=3.0).simulate()[0]
    q = log.q[:, joint - 1]
    jump = np.sign(np.gradient(q, log.time)) if in_place else 0.0
    tau = log.tau.copy()
    tau[:, joint - 1] += 8.0 * (sliders(q, angle) - jump)
    return Log(log.time, log.q, tau, qd=log.qd, q_ref=log.q_ref)


@pytest.mark.parametrize(("angle", "names"), [(0.9e-3, []), (12e-3, ["hysteresis"])])
def test_contacts_that_hold_over_two_milliradians_are_none(angle: float, names: list[str]) -> None:
    """Of 64 other arms with contacts of 0.6 to 2.7 mrad five were told a hysteresis there, at 0.82
    to 0.95."""
    found = diagnose(ROBOT, log_of(6, angle, in_place=True))
    assert [f.effect.kind for f in found.findings] == names
    assert UNSETTLED not in found.weak


def test_a_loop_is_found_beside_dry_friction_that_the_file_does_not_state() -> None:
    """The loop's own dry part and the robot's shared that friction at will, 12 Nm of the other sign
    beside a loop of 8, so that no width was plausible: 48 standard deviations, nothing said."""
    robot = ROBOT.with_unknown_friction(range(1, 7))
    found = diagnose(robot, log_of(5, 12e-3, in_place=False))
    (loop,) = (f.effect for f in found.findings)
    assert isinstance(loop, Hysteresis)
    assert loop.joint == 5
    assert loop.replaced_Nm == 0.0
    assert loop.amplitude_Nm == pytest.approx(8.0, rel=0.2)


def test_a_search_that_ends_before_it_settled_says_so() -> None:
    log = log_of(6, 12e-3, in_place=True)
    found = diagnose(ROBOT, log, criteria=Criteria(most_looks=1))
    assert UNSETTLED in found.weak
