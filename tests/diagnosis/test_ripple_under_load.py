"""A gear's ripple that grows with the torque that it carries is named, with its amplitude under the
usual one."""

from __future__ import annotations

import pytest
from plant_logs import case_of, diagnosed


@pytest.mark.slow
def test_it_is_named_with_its_amplitude_under_the_usual_load() -> None:
    """It was a function of two angles without a name, of which the other changes the load."""
    case = case_of(20263541, "single/42")
    (drawn,) = case.made.effects
    diagnosis = diagnosed(case)
    (effect,) = diagnosis.robot.effects
    assert (effect.kind, effect.joint, diagnosis.verdict) == ("gear_ripple", 2, "explained")
    assert effect.amplitude_Nm == pytest.approx(drawn.told()["amplitude_Nm"], rel=0.05)
    assert effect.order == pytest.approx(drawn.told()["order_per_rev"], rel=0.01)
