"""A motion without jumps that is slowed by the little left above its limits is read elsewhere."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.rate_limited import time_rate_limited as module
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import _Search

# what cannot be held back
TOO_MUCH = 1.0123


class Law:
    """A duration alone."""

    def __init__(self, duration: float) -> None:
        self.duration = duration

    def slowed(self, factor: float) -> Law:
        assert factor > 1
        return Law(self.duration * factor)


def searched(
    monkeypatch: pytest.MonkeyPatch, left: list[float], asked: list[float], rate: float
) -> Any:
    """What a search finds whose motions are read so, one after another.

    Args:
        monkeypatch: of the test.
        left: the largest ratios that are still to come.
        asked: gets those that were held back.
        rate: of the rows [1/s].
    """

    def holding_back(ratios: Any, law: Law) -> Any:
        asked.append(ratios)
        if ratios == TOO_MUCH:
            raise InfeasiblePointError(0.0, ", no motion")
        return problem

    problem: Any = SimpleNamespace(
        program=SimpleNamespace(outputs=None),
        start=lambda rough: np.zeros(1),
        law=lambda z: Law(10.0),
        holding_back=holding_back,
        inside=lambda z: z,
    )
    nothing: Any = None
    sampling: Any = SimpleNamespace(rate=rate)
    search = _Search(nothing, nothing, nothing, nothing, sampling, nothing)
    monkeypatch.setattr(module, "solve", lambda *a, **k: None)
    monkeypatch.setattr(module, "_largest", lambda ratio: ratio)
    monkeypatch.setattr(module, "_refuse", lambda *a: None)
    monkeypatch.setattr(_Search, "program", lambda self, s, rough: problem)
    monkeypatch.setattr(_Search, "ratios", lambda self, law: None)
    monkeypatch.setattr(_Search, "as_read", lambda self, law, ratios: left.pop(0))
    return search.within(nothing, nothing)


@pytest.mark.parametrize(
    ("shown", "solved", "held", "worst", "slower"),
    [
        # within a little at once, and slowed
        ([1.0003, 0.9999], 1, [], 0.9999, 2e-4),
        # above it, then within
        ([1.02, 1.0003, 0.9999], 2, [1.02], 0.9999, 2e-4),
        # slowed by 0.02 % the rows of a CAM file swung 1.1 % above the feed, and the whole motion
        # was slowed by as much
        ([1.0003, 1.011, 0.99, 1.0002, 0.9999], 2, [1.011], 0.9999, 2e-4),
        # by less than a thousandth: not worth another solution
        ([1.0003, 1.0008, 0.9999], 1, [], 0.9999, 8e-4),
        # better, then no better: the one before
        (
            [1.0003, 1.02, 0.99, 1.0004, 1.002, 0.9999, 1.0, 1.003, 0.99],
            3,
            [1.02, 1.002],
            0.9999,
            0.00169,
        ),
        # a second motion that does not come within its limits is none, however fast
        ([1.0003, 1.011, 0.99, *[1.0002] * 12], 2, [1.011], 0.99, 8e-3),
        # nor is a first one
        ([1.0003, *[1.002] * 11, 1.0002, 0.9999], 2, [1.002], 0.9999, 1.5e-4),
        # what cannot be held back leaves the first motion
        ([1.0003, TOO_MUCH, 0.99], 1, [TOO_MUCH], 0.99, 8.8e-3),
        # slowed by little, and not within its limits all the same
        ([1.0003, *[1.00001] * 10, 1.00001, 1.0002, 0.9999], 2, [1.00001], 0.9999, 1.5e-4),
        # what ten solutions did not settle has four more
        (
            [*[1.02] * 10, 0.99, *[1.02] * 3, 1.0003, 0.9999],
            14,
            [*[1.02] * 9, 0.99, *[1.02] * 3],
            0.9999,
            2e-4,
        ),
    ],
)
def test_what_the_slowed_motion_shows_is_held_back(
    monkeypatch: pytest.MonkeyPatch,
    shown: list[float],
    solved: int,
    held: list[float],
    worst: float,
    slower: float,
) -> None:
    left = list(shown)
    asked: list[float] = []
    found = searched(monkeypatch, left, asked, rate=1e4)
    assert found.rounds == solved
    assert asked == held
    assert found.worst == worst
    assert found.law.duration == pytest.approx(10.0 * (1 + slower), rel=1e-4)
    assert left == []


def test_less_than_a_row_is_not_worth_another_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    for rate, solved in ((50.0, 1), (500.0, 2)):
        # 13 ms are lost
        left = [1.0003, 1.0015, 0.9999, 0.9999]
        found = searched(monkeypatch, left, [], rate)
        assert found.rounds == solved
