"""A motion without jumps that is slowed by the little left above its limits is read elsewhere."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.planners.timing.rate_limited import time_rate_limited as module
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import _Search


@pytest.mark.parametrize(
    ("shown", "solved", "end"),
    [
        # within a little at once, and slowed
        ([1.0003, 0.9999], 1, 1.0),
        # above it, then within
        ([1.02, 1.0003, 0.9999], 2, 1.0),
        # slowed by 0.02 % the rows of a CAM file swung 1.1 % above the feed, and the whole motion
        # was slowed by as much
        ([1.0003, 1.011, 1.0002, 1.0004], 2, 1.0004),
    ],
)
def test_what_the_slowed_motion_shows_is_held_back(
    monkeypatch: pytest.MonkeyPatch, shown: list[float], solved: int, end: float
) -> None:
    left = list(shown)
    held: list[float] = []

    class Law:
        def slowed(self, factor: float) -> Law:
            assert 1.0 < factor < 1.001
            return Law()

    def holding_back(ratios: Any, law: Law) -> Any:
        held.append(ratios)
        return problem

    problem: Any = SimpleNamespace(
        program=SimpleNamespace(outputs=None),
        start=lambda rough: np.zeros(1),
        law=lambda z: Law(),
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
    _, ratios, iterations = search.settled(nothing, nothing)
    assert iterations == solved
    assert len(held) == solved - 1
    assert ratios == pytest.approx(end, abs=2e-4)
    assert left == []
