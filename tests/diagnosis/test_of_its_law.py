"""A name is that of its law: what is mostly off its law is another one's."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.estimation.fit import Fitter
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.joined_log import prepare_together

CABLE = {"stiffness_Nm_rad": 0.59, "neutral_rad": 1.2}
LOOP = {"amplitude_Nm": 7.5, "width_rad": 0.014, "replaced_Nm": 6.0}


@pytest.fixture(scope="module")
def acceptance() -> Acceptance:
    time = np.arange(0.0, 10.0, 0.01)
    q = 1.2 * np.sin(np.linspace(0.7, 2.3, 6) * time[:, None] + np.arange(6.0))
    fitter = Fitter.__new__(Fitter)
    fitter.bases = Bases(irb.load_robot("irb2400"))
    fitter.motion = prepare_together([Log(time, q, q)])
    fitter._cache = {}
    return Acceptance(fitter, Criteria())


@pytest.mark.parametrize(
    ("effect", "told"),
    [
        (LIBRARY["cable_spring"].of(1, **CABLE), True),
        (LIBRARY["cable_spring"].of(1, **CABLE, discrepancy=(0.1, -0.05)), True),
        (LIBRARY["cable_spring"].of(1, **CABLE, discrepancy=(2.5, 0.9)), False),
        # a loop of 7.5 Nm takes the place of 6 Nm of dry friction: it is no law of 1.5 Nm
        (LIBRARY["hysteresis"].of(1, **LOOP, discrepancy=(20.0, 4.0)), True),
        (LIBRARY["hysteresis"].of(1, **LOOP, discrepancy=(300.0, 0.0)), False),
        # an asymmetry is nearly constant: its rms counts, not how it varies
        (LIBRARY["coulomb_asymmetry"].of(1, delta_Nm=2.0, discrepancy=(0.5, 0.8)), True),
        (LIBRARY["coulomb_asymmetry"].of(1, delta_Nm=2.0, discrepancy=(0.5, 3.0)), False),
    ],
)
def test_an_effect_is_more_its_law_than_what_it_is_off_that(
    acceptance: Acceptance, effect: Effect, told: bool
) -> None:
    """A soft stop of axis 1 was a cable (0.97) whose bends were four times its pull."""
    assert acceptance._of_its_law(effect) is told
