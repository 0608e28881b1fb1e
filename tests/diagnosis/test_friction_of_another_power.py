"""Dry friction that grows with a power of the load other than its first is named, and its number is
what it is under the load that the joint usually carries."""

from __future__ import annotations

import numpy as np
import pytest
from third_plant.case import Case
from third_plant.suites import plan

import irb2400_ctrl as irb


def test_its_coefficient_is_that_of_the_usual_load() -> None:
    """It was the one at 50 Nm, on an axis that carries 340 Nm a third of what is there; what it is
    off its law seemed larger than the law, and the arm was unexplained."""
    (arm,) = [one for one in plan(20263481) if one.name == "single/28"]
    case = Case(arm)
    (drawn,) = case.made.effects
    seen = case.identification()
    log = irb.Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)
    diagnosis = irb.diagnose(irb.load_robot("irb2400"), log)
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("load_friction", 2, "explained")
    # s r (soft(load) / r)^p, soft(x) = sqrt(x^2 + t^2) - t
    law = drawn.told()
    r = law["reference_torque_Nm"]
    load = effect.reference_Nm
    assert load == pytest.approx(r, rel=0.2)
    soft = np.hypot(load, law["soft_torque_Nm"]) - law["soft_torque_Nm"]
    friction = law["coefficient"] * r * (soft / r) ** law["exponent"]
    assert effect.coefficient == pytest.approx(friction / load, rel=0.05)
