"""True numbers inside the stated intervals, on arms of the independent plant."""

from __future__ import annotations

import numpy as np
from identification.possible_arms import possible_robot, scores


def test_true_numbers_lie_inside_the_stated_intervals() -> None:
    """95 % intervals of base parameters and friction; `benchmarks/identification_coverage.py` has
    more arms."""
    robot = possible_robot()
    z = np.array([scores(robot, seed)[1] for seed in (501, 502, 503)])
    inside = float(np.mean(np.abs(z) < 1.96))
    assert 0.90 <= inside <= 1.0
    assert 0.6 < float(np.sqrt(np.mean(z**2))) < 1.25
