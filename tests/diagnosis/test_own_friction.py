"""What the torque of a friction is held against."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_criteria import accepts, candidate, threshold
from diagnosis.test_names import ROBOT, names, sound, speed, with_torque

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.own_friction import OwnFriction


def test_a_friction_is_large_against_the_friction_of_its_joint() -> None:
    """On axes 2 and 3, which bear weight, one that had doubled (215 nats), one with the square of
    the speed (531) and one that rose midway (254) were six to nine thousandths of the torque:
    nothing was missing."""
    friction: Any = SimpleNamespace(friction_known=np.ones((3, 4)), friction=np.ones((3, 4)))
    friction.friction[1] = 0.0, 25.0, 10.0, 0.0
    speed = np.array([2.0, -2.0, 2.0, -2.0])
    motion: Any = SimpleNamespace(
        qd=speed[:, None] * np.ones(3), filtered_reading=lambda values: values
    )
    heavy = threshold(measured=300.0)  # one hundredth of it is 3 Nm
    # five times 25 + 10 * 2 Nm are 225
    heavy.friction = OwnFriction(friction, motion)
    assert accepts(candidate((0.0, 2.26, 0.0)), judge=heavy)
    assert not accepts(candidate((0.0, 2.24, 0.0)), judge=heavy)
    # less friction than stated is one, too
    assert accepts(candidate((0.0, -2.26, 0.0)), judge=heavy)

    # and what acts along the motion as often as against it is none
    def held(torque: Any, measured: float = 300.0, **stated: Any) -> float:
        of = SimpleNamespace(**{**vars(friction), **stated})
        rows = np.array(torque)[:, None] * np.ones(3)
        usual = np.full(3, measured)
        return float(OwnFriction(of, motion).counted(rows, usual)[1])  # type: ignore[arg-type]

    assert held([1.0, -1.0, 1.0, -1.0]) == pytest.approx(225.0)
    assert held([1.0, 1.0, 1.0, 1.0]) == 300.0
    assert held([9.0, -9.0, 9.0, 1.0]) == pytest.approx(225.0)
    assert held([9.0, -9.0, 5.0, 3.0]) == 300.0
    # never more than the joint's torque; of a file that does not say it that alone
    assert held([1.0, -1.0, 1.0, -1.0], measured=100.0) == 100.0
    assert held([1.0, -1.0, 1.0, -1.0], friction_known=np.zeros((3, 4))) == 300.0


@pytest.mark.slow
def test_friction_of_an_axis_that_bears_weight_is_named() -> None:
    """1.6 Nm with the square of the speed, on an axis of 244 Nm of which 17 Nm are friction."""
    square = speed(3) * np.abs(speed(3))
    log = with_torque(3, 1.6 * square / np.sqrt(np.mean(square**2)))
    assert 0.01 * np.sqrt(np.mean(sound().tau[:, 2] ** 2)) > 1.6
    found = diagnose(ROBOT, log)
    assert names(found) == [("viscous_power", 3)]
    assert found.verdict == "explained"
