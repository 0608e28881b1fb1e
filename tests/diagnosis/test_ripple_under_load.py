"""A gear's ripple that grows with the torque that it carries is named, with its amplitude under the
usual one."""

from __future__ import annotations

import pytest
from third_plant.case import Case
from third_plant.suites import plan

import irb2400_ctrl as irb


def test_it_is_named_with_its_amplitude_under_the_usual_load() -> None:
    """It was a function of two angles without a name, of which the other changes the load."""
    (arm,) = [one for one in plan(20263541) if one.name == "single/42"]
    case = Case(arm)
    (drawn,) = case.made.effects
    seen = case.identification()
    log = irb.Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)
    diagnosis = irb.diagnose(irb.load_robot("irb2400"), log)
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("gear_ripple", 2, "explained")
    assert effect.amplitude_Nm == pytest.approx(drawn.told()["amplitude_Nm"], rel=0.05)
    assert effect.order == pytest.approx(drawn.told()["order_per_rev"], rel=0.01)
