"""What diagnosis refuses to name, and how sure it lets itself be."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.scan import plausible


@pytest.mark.parametrize(("delay", "named"), [(0.0008, False), (-0.0008, False), (0.003, True), (-0.003, True)])
def test_a_delay_below_the_truth_of_the_time_stamps_is_not_named(delay: float, named: bool) -> None:
    assert (plausible("time_delay", None, np.array([delay]), {}) is not None) == named


def test_bounds_of_the_physics_hold() -> None:
    assert plausible("rotor_inertia", 1, np.array([-1.0]), {}) is None
    assert plausible("rotor_inertia", 1, np.array([1.0]), {}) is not None
