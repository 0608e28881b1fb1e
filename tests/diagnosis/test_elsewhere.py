"""What one second says nearly alone is an event, unless the law acts in hardly more than that
second."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.preparation.noise import NoiseModel

RATE = 50
TIME = np.arange(6 * RATE) / RATE
SHORT = np.where((TIME >= 2) & (TIME < 3), 1.0, np.where(TIME < 2, 0.2, 0.0)) * np.sin(9 * TIME)
THROUGHOUT = np.sin(9 * TIME)
EVENT = np.where((TIME >= 2) & (TIME < 3), 1.0, 0.0) * np.sin(9 * TIME)


def judge(torque: Array, turning: Array | None = None) -> StepComparison:
    """Of one joint with white noise, beside an offset; `turning`: its reversals."""
    noise = np.random.default_rng(3).normal(0, 0.01, len(TIME))
    motion = SimpleNamespace(n=1, row_time=TIME, step=1 / RATE)
    scan: Any = SimpleNamespace(motion=motion)
    reversal = np.zeros(len(TIME), dtype=bool) if turning is None else turning
    base = np.full((len(TIME), 1, 1), 0.1)
    known = np.ones((len(TIME), 1), dtype=bool)
    model = NoiseModel(known, reversal[:, None], np.zeros(1), 1 / RATE)
    return StepComparison(scan, model, (torque + noise)[:, None], base)


def shown(
    torque: Array, law: Array, begins: tuple[float, ...] = (), turning: Array | None = None
) -> float:
    """`StepComparison.elsewhere` of a law."""
    comparison = judge(torque, turning)
    size = float(law @ torque / (law @ law))
    candidate: Any = SimpleNamespace(torque=lambda n: size * law[:, None], begins=begins)
    return comparison.elsewhere(candidate)


def test_a_law_that_acts_in_hardly_more_than_one_second_may_say_it_there() -> None:
    assert shown(SHORT, SHORT) == pytest.approx(1.0, abs=0.1)


def test_an_event_is_no_law_that_acts_throughout() -> None:
    assert shown(EVENT, THROUGHOUT) < 0.2


def test_what_began_within_the_record_must_show_beyond_one_second() -> None:
    assert shown(SHORT, SHORT, begins=(0.0,)) < 0.2


def test_what_shows_at_turns_above_all_shows_in_all_of_them() -> None:
    """A delay of a joint with much friction, in motion not quite as large: beside it the base
    leaves a noise of reversals that holds all of it, and by that noise all but one second spoke
    against it."""
    turning = TIME % 0.5 < 0.1
    law = np.where(turning, 1.0, 0.2) * THROUGHOUT
    whole = turning | (np.floor(TIME) == 4)
    assert shown(np.where(whole, law, 0.4 * law), law, turning=turning) > 0.8
