"""A motion without jumps that is slowed by the little left above its limits is read elsewhere."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.planners.timing.rate_limited import time_rate_limited as module
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import _Search


class Law:
    """A duration alone."""

    def __init__(self, duration: float) -> None:
        self.duration = duration

    def slowed(self, factor: float) -> Law:
        assert factor > 1
        return Law(self.duration * factor)


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
        # no better the second time: the first motion
        ([1.0003, 1.002, 0.999, 1.0004, 1.02, 0.99], 2, [1.002], 0.999, 1.6e-3),
        # a second motion that does not come within its limits is none, however fast
        ([1.0003, 1.011, 0.99, *[1.0002] * 11], 2, [1.011], 0.99, 8e-3),
        # nor is a first one
        ([1.0003, *[1.002] * 11, 1.0002, 0.9999], 2, [1.002], 0.9999, 2e-4),
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

    def holding_back(ratios: Any, law: Law) -> Any:
        asked.append(ratios)
        return problem

    problem: Any = SimpleNamespace(
        program=SimpleNamespace(outputs=None),
        start=lambda rough: np.zeros(1),
        law=lambda z: Law(10.0),
        holding_back=holding_back,
        inside=lambda z: z,
    )
    nothing: Any = None
    search = _Search(nothing, nothing, nothing, nothing, nothing, nothing)
    monkeypatch.setattr(module, "solve", lambda *a, **k: SimpleNamespace(z=None, iterations=1))
    monkeypatch.setattr(module, "_largest", lambda ratio: ratio)
    monkeypatch.setattr(module, "_refuse", lambda *a: None)
    monkeypatch.setattr(_Search, "program", lambda self, s, rough: problem)
    monkeypatch.setattr(_Search, "ratios", lambda self, law: None)
    monkeypatch.setattr(_Search, "as_read", lambda self, law, ratios: left.pop(0))
    found = search.within(nothing, nothing)
    assert found.iterations == solved
    assert asked == held
    assert found.worst == worst
    assert found.law.duration == pytest.approx(10.0 * (1 + slower), rel=1e-4)
    assert left == []
