"""A hysteresis is as high as it is told, however it builds up."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, motion
from plant_logs import of_second_plant

from irb2400_ctrl.diagnosis.estimation.evidence import discrepancy_shares, discrepancy_unit


@pytest.mark.parametrize(
    ("name", "joint", "height"),
    [
        # 95 Nm were told, as a part of the height stood with how it builds up
        ("single/7", 2, 46.5),
        # it was not named: that part was more than the other
        pytest.param("three/7", 3, 13.6, marks=pytest.mark.slow),
    ],
)
def test_its_amplitude_is_its_height(name: str, joint: int, height: float) -> None:
    found = of_second_plant(20263560, name)
    (loop,) = (e for e in found.robot.effects if e.kind == "hysteresis")
    assert loop.joint == joint
    # beside the joint's dry friction
    assert loop.amplitude_Nm - loop.replaced_Nm == pytest.approx(height, rel=0.12)


@pytest.mark.parametrize("joint", range(1, 7))
def test_another_way_of_building_up_does_not_fall_again(joint: int) -> None:
    """z + d (z |z| - z) rises all the way from 0 to 1 where d is at most 1."""
    point = [{"width_rad": 0.02}]
    (law,) = BASES.columns("hysteresis", joint, motion(), point)
    (other,) = BASES.columns("hysteresis", joint, motion(), point, discrepancy=True)
    shares = discrepancy_shares("hysteresis", other.values.shape[2])
    usual = discrepancy_unit(law, np.array([1.0, 0.0]), other, shares)
    assert (usual[:2] < 0.7).all()
