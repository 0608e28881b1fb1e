"""What diagnosis refuses to name, and how sure it lets itself be."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.estimation.candidate import plausible


@pytest.mark.parametrize(
    ("joint", "delay", "named"),
    [
        (None, 0.0005, False),
        (None, 0.001, True),
        (None, -0.001, False),
        (None, -0.002, False),
        (None, -0.004, True),
        (1, 0.001, False),
        (1, 0.003, True),
    ],
)
def test_a_delay_below_the_truth_of_the_time_stamps_is_not_named(
    joint: int | None, delay: float, named: bool
) -> None:
    assert (plausible("time_delay", joint, np.array([delay]), {}) is not None) == named


def test_bounds_of_the_physics_hold() -> None:
    assert plausible("rotor_inertia", 1, np.array([-1.0]), {}) is None
    assert plausible("rotor_inertia", 1, np.array([1.0]), {}) is not None
