"""What a fit has left of a motion, slowly: noise of every later one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from irb2400_ctrl.identification.held_out import slowly_left

STEP = 0.004


def log(wander: float, noise: float = 1.0, seconds: float = 60.0, known: int | None = None) -> Any:
    """Two joints, of which the second has noise alone; `known`: the first so many rows."""
    rng = np.random.default_rng([round(1e3 * wander), round(1e3 * noise), round(1e3 * seconds)])
    count = round(seconds / STEP)
    slow = gaussian_filter1d(rng.standard_normal(15_000), 0.5 / STEP)
    left = noise * rng.standard_normal((count, 2))
    left[:, 0] += wander * (slow / slow.std())[:count]
    rows = np.ones((count, 2), dtype=bool)
    if known is not None:
        rows[known:] = False
    return SimpleNamespace(
        time=STEP * np.arange(count),
        qd=np.ones((count, 2)),
        measured=left,
        unseen=np.zeros((count, 2)),
        known=rows,
    )


def test_it_is_that_of_the_worst_log_without_its_noise() -> None:
    found = slowly_left([log(0.5), log(2.0), log(1.0)])
    assert found[0] == pytest.approx(2.0, rel=0.1)
    assert found[1] < 0.1  # the means over 50 samples alone would be 0.14
    # averaged over the motions it would be less than one of them leaves
    assert slowly_left([log(2.0)])[0] == pytest.approx(found[0], rel=0.01)


def test_a_log_with_hardly_any_known_rows_is_not_the_worst_by_chance() -> None:
    few = [log(0.5, noise=3.0, seconds=1.0 + k / 100.0, known=60) for k in range(20)]
    alone = slowly_left([log(0.5, noise=3.0)])
    np.testing.assert_allclose(slowly_left([log(0.5, noise=3.0), *few]), alone)
    # where there are no others they count together
    assert 0.0 < slowly_left(few)[0] < 1.5


def test_what_sticks_at_turns_is_not_left_elsewhere() -> None:
    """A diagnosis takes it for no effect on any joint: noise of the whole motion hid others."""
    one = log(0.0)
    one.qd = np.cos(2.0 * np.pi * 0.25 * one.time)[:, None] * np.ones(2)
    sticks = log(0.0)
    sticks.qd = one.qd
    sticks.measured = one.measured + 10.0 * (np.abs(one.qd) < 0.05)
    np.testing.assert_allclose(slowly_left([sticks]), slowly_left([one]))
