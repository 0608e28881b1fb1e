"""An effect that the robot's file states may have changed: it keeps its shape, and what is found is
its strength."""

from __future__ import annotations

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.estimation.effect_parameters import changed_of, parameters_of
from irb2400_ctrl.effects.balancer import Balancer
from irb2400_ctrl.effects.gear_ripple import GearRipple
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot

STATED = Balancer(joint=2, torque_Nm=600.0, neutral_rad=0.1, lever_ratio=0.25, free_ratio=-2.0)
ROBOT = load_robot("irb2400").with_effects(STATED)


@pytest.mark.parametrize(("share", "said"), [(0.7, "30 % weaker"), (1.2, "20 % stronger")])
def test_how_much_of_its_strength_a_balancer_has_lost(share: float, said: str) -> None:
    """It was a second balancer of another shape that "helps the axis to carry its weight"."""
    seen = Case(3528000, duration=16.0, validation_duration=3.0).simulate()[0]
    d = seen.q[:, 1] - 0.1
    length = np.sqrt(1.0 + 0.25**2 - 0.5 * np.cos(d))
    tau = seen.tau.copy()
    tau[:, 1] += share * 600.0 * (1.0 + 2.0 * 0.75 / length) * np.sin(d)
    found = diagnose(ROBOT, Log(seen.time, seen.q, tau, q_ref=seen.q_ref))
    assert found.verdict == "explained"
    (one,) = found.findings
    assert one.effect.nonlinear == STATED.nonlinear
    (strength,) = one.effect.coefficients()
    assert strength == pytest.approx((share - 1.0) * 600.0, abs=15.0)
    assert one.sentence == f"Joint 2: the balancer that the file states is {said} than it says."
    assert found.robot.effects[0] == STATED


def test_what_keeps_the_shape_of_a_stated_effect_is_a_change_of_it() -> None:
    weaker = STATED.model_copy(update={"torque_Nm": -100.0})
    assert changed_of(weaker, [STATED]) == STATED
    assert [p.name for p in parameters_of(weaker, 0, [STATED])] == ["torque_Nm"]
    other = weaker.model_copy(update={"lever_ratio": 0.3})
    assert changed_of(other, [STATED]) is None
    assert len(parameters_of(other, 0, [STATED])) == 4
    ripple = GearRipple(joint=2, amplitude_Nm=1.0, order=20.0)
    assert changed_of(ripple, [STATED, ripple.model_copy(update={"joint": 3})]) is None
