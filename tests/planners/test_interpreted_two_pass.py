"""The two passes without a C compiler: the same result as the machine code's."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.planners.timing.two_pass import two_pass
from irb2400_ctrl.planners.timing.two_pass.interpreted import interpreted_two_pass


def drawn(seed: int, margin: float) -> tuple[np.ndarray, ...]:
    """Rows like torque limits: both signs of p, some without u, r below zero where margin is."""
    draw = np.random.default_rng(seed)
    m = 40
    k = 10
    rows = draw.normal(size=(m, k, 3))
    rows[:, 0, 0] = 0.0
    rows[:, 1, 0] = 1e-16
    rows[..., 2] = np.abs(rows[..., 2]) + margin
    high = np.full(m + 1, 4.0)
    high[[0, -1]] = 0.0
    return rows, draw.uniform(0.01, 0.1, m), np.zeros(m + 1), high


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("margin", [0.2, -0.05])
def test_numpy_and_c_agree(seed: int, margin: float) -> None:
    given = drawn(seed, margin)
    fast = two_pass(*given)
    slow = interpreted_two_pass(*given)
    assert slow.infeasible_cell == fast.infeasible_cell
    if fast.infeasible_cell is None:
        assert np.ptp(fast.x) > 0
        for name in ("x", "low", "high"):
            np.testing.assert_allclose(getattr(slow, name), getattr(fast, name), 1e-12, 1e-13)


def test_both_outcomes_are_drawn() -> None:
    """The draws above hold feasible and infeasible grids."""
    cells = {
        two_pass(*drawn(seed, margin)).infeasible_cell is None
        for seed in range(20)
        for margin in (0.2, -0.05)
    }
    assert cells == {True, False}


@pytest.mark.parametrize("seed", range(6))
def test_passes_over_blocks_are_those_over_all_cells(seed: int) -> None:
    table, h, low, high = drawn(seed, 0.5 if seed % 2 else 3.0)
    m = len(h)
    blocks = [slice(first, min(first + 7, m)) for first in range(0, m, 7)]
    assert m > 14, "several blocks"
    whole = two_pass(table, h, low, high)
    parts = two_pass(table, h, low, high, blocks)
    assert parts.infeasible_cell == whole.infeasible_cell
    # as far as they go, to the last bit
    for name in ("x", "low", "high"):
        assert np.array_equal(getattr(parts, name), getattr(whole, name)), name
