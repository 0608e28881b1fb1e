"""How large a torque is, where it is known and with what a filter takes away."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from diagnosis.plain_motion import BASES, motion

from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.effects import LIBRARY


def test_of_rows_that_are_known() -> None:
    made: Any = StepComparison.__new__(StepComparison)
    known = np.array([[True, True, False], [True, False, False], [False, True, False]])
    made.noise = SimpleNamespace(known=known)
    torque = np.array([[3.0, 1.0, 9.0], [4.0, 90.0, 9.0], [90.0, 7.0, 9.0]])
    np.testing.assert_allclose(made.known_rms(torque), np.sqrt([12.5, 25.0, 0.0]))


def test_of_the_samples_of_a_swing_a_filter_leaves_little() -> None:
    m = motion()
    made: Any = StepComparison.__new__(StepComparison)
    made.scan = SimpleNamespace(bases=BASES, motion=m)
    stiff = LIBRARY["elastic_joint"].of(6, stiffness_Nm_rad=800.0, damping_ratio=0.02)
    laws = BASES.columns("elastic_joint", 6, m, [stiff.nonlinear], filtered=True)
    filtered = laws[0].torque(np.array(stiff.coefficients()), 6)
    samples = made.sampled_rms(SimpleNamespace(effects=(stiff,)))
    assert samples.shape == (6,)
    assert samples[5] > 1.5 * np.sqrt(np.mean(filtered[:, 5] ** 2))
    two = made.sampled_rms(SimpleNamespace(effects=(stiff, stiff)))
    np.testing.assert_allclose(two, 2.0 * samples)
