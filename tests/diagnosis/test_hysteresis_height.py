"""A hysteresis is as high as it is told, however it builds up."""

from __future__ import annotations

import pytest
from mujoco_plant.suites import suite
from third_plant_logs import ROBOT

import irb2400_ctrl as irb


@pytest.mark.parametrize(
    ("where", "number", "joint", "height"),
    [
        # 95 Nm were told, as a part of the height stood with how it builds up
        ("single", 7, 2, 46.5),
        # it was not named: that part was more than the other
        pytest.param("three", 7, 3, 13.6, marks=pytest.mark.slow),
    ],
)
def test_its_amplitude_is_its_height(where: str, number: int, joint: int, height: float) -> None:
    (case,) = suite(where, number, 1, 20263560)
    seen = case.simulate()
    log = irb.Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)
    found = irb.diagnose(ROBOT, log)
    (loop,) = (e for e in found.robot.effects if e.kind == "hysteresis")
    assert loop.joint == joint
    # beside the joint's dry friction
    assert loop.amplitude_Nm - loop.replaced_Nm == pytest.approx(height, rel=0.12)
