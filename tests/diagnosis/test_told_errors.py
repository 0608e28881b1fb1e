"""Errors of numbers hold what a law, simpler than the real thing, leaves of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.findings import _standard_errors
from irb2400_ctrl.effects import LIBRARY

NUMBERS: dict[str, dict[str, float]] = {
    "gear_ripple": {"amplitude_Nm": 10.0, "order": 24.0, "phase_rad": 2.0},
    "time_delay": {"delay_s": 0.01},
    "torque_offset": {"offset_Nm": 5.0},
    "elastic_joint": {"stiffness_Nm_rad": 1e4, "damping_ratio": 0.1},
}


@pytest.mark.parametrize(
    ("kind", "number", "more"),
    [
        ("gear_ripple", "amplitude_Nm", 0.15 * 0.22),
        ("gear_ripple", "order", 0.0),
        ("gear_ripple", "phase_rad", 0.0),
        ("time_delay", "delay_s", 0.15 * 0.22),
        ("torque_offset", "offset_Nm", 0.0),
        ("elastic_joint", "stiffness_Nm_rad", 0.35),
        ("elastic_joint", "damping_ratio", 0.35),
    ],
)
def test_what_a_law_leaves_is_in_the_errors(kind: str, number: str, more: float) -> None:
    numbers = NUMBERS[kind]
    fit: Any = SimpleNamespace(
        effects=(LIBRARY[kind].of(2, **numbers),),
        parameters=[SimpleNamespace(effect=0, name=name, element=None) for name in numbers],
        sigma=np.array([0.01 * abs(value) for value in numbers.values()]),
    )
    candidate: Any = SimpleNamespace(spread={})
    noise = INFLATION * 0.01 * abs(numbers[number])
    told = _standard_errors(fit, 0, candidate)[number]
    assert told == pytest.approx(np.hypot(noise, more * numbers[number]))
