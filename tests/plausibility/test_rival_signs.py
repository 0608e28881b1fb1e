"""Of a wrist torques may not tell whether an angle or its torque has the other sign: both are
said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.evidence import Fit
from irb2400_ctrl.plausibility.reading import Reading, as_labelled, torque_readings
from irb2400_ctrl.plausibility.rival_signs import AS_WELL, with_its_rival
from irb2400_ctrl.robot import load_robot

(TURNED,) = (
    reading
    for reading in torque_readings(load_robot("irb2400"))
    if reading.kind == "torque_sign" and reading.joints == (4,)
)


def fit(cost: float) -> Fit:
    return Fit(cost, 0.0, np.full(6, 0.05))


@pytest.mark.parametrize(("more", "both"), [(AS_WELL - 1.0, True), (AS_WELL + 1.0, False)])
def test_the_other_sign_is_said_where_it_fits_as_well(more: float, both: bool) -> None:
    asked: list[Reading] = []

    def rival(reading: Reading) -> Fit:
        asked.append(reading)
        return fit(100.0 + more)

    found = with_its_rival(TURNED, fit(100.0), rival)
    assert (found.kind, found.joints) == ("torque_sign", (4,))
    assert ("or its angle, which fits as well" in found.says) == both
    (one,) = asked
    assert one.kind == "angle_sign"
    np.testing.assert_array_equal(one.angles, TURNED.torques)
    np.testing.assert_array_equal(one.torques, np.eye(6))


def test_other_readings_have_no_rival() -> None:
    clock = replace(as_labelled(6), kind="time_scale", says="the clock looks slow", clock=0.1)
    beside = replace(TURNED, says=f"{TURNED.says}; beside it {clock.says}", clock=0.1)
    for reading in (clock, beside):
        assert with_its_rival(reading, fit(1.0), lambda other: fit(0.0)).says == reading.says


def test_both_are_said_of_an_axis_that_is_alike_on_both_sides() -> None:
    """It was the angle, of which a column map made a sound log of another arm."""
    drawn = other_arm_log(800008)
    told = []
    for joint in (6, 4):
        tau = drawn.log.tau * (1.0 - 2.0 * np.eye(6)[joint - 1])
        problem = log_problem(drawn.robot, replace(drawn.log, tau=tau))
        assert problem is not None
        assert problem.joints == (joint,)
        told.append("which fits as well" in problem.says)
    assert told == [True, False]
