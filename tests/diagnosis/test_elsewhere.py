"""What one second says nearly alone is an event, unless the law acts in hardly more than that
second."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.comparison import Comparison

RATE = 50
TIME = np.arange(6 * RATE) / RATE
SHORT = np.where((TIME >= 2) & (TIME < 3), 1.0, np.where(TIME < 2, 0.2, 0.0)) * np.sin(9 * TIME)
THROUGHOUT = np.sin(9 * TIME)
EVENT = np.where((TIME >= 2) & (TIME < 3), 1.0, 0.0) * np.sin(9 * TIME)


def shown(torque: Array, law: Array, begins: tuple[float, ...] = ()) -> float:
    """`Comparison.elsewhere` of a law on one joint with white noise, beside an offset."""
    noise = np.random.default_rng(3).normal(0, 0.01, len(TIME))
    motion = SimpleNamespace(
        n=1, row_time=TIME, row_known=np.ones((len(TIME), 1), dtype=bool), step=1 / RATE
    )
    scan: Any = SimpleNamespace(motion=motion)
    turning = np.zeros((len(TIME), 1), dtype=bool)
    base = np.full((len(TIME), 1, 1), 0.1)
    comparison = Comparison(scan, turning, (torque + noise)[:, None], base)
    size = float(law @ torque / (law @ law))
    candidate: Any = SimpleNamespace(torque=lambda n: size * law[:, None], begins=begins)
    return comparison.elsewhere(candidate)


def test_a_law_that_acts_in_hardly_more_than_one_second_may_say_it_there() -> None:
    assert shown(SHORT, SHORT) == pytest.approx(1.0, abs=0.1)


def test_an_event_is_no_law_that_acts_throughout() -> None:
    assert shown(EVENT, THROUGHOUT) < 0.2


def test_what_began_within_the_record_must_show_beyond_one_second() -> None:
    assert shown(SHORT, SHORT, begins=(0.0,)) < 0.2
