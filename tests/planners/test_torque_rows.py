"""The torque rows by machine code: bit by bit those of the arrays."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing import torque_constraints as rows
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits

M = 2_300
N = 6


def drawn_cells(draw: np.random.Generator) -> Cells:
    """Numbers of every size and sign; a few cells where nothing is known."""
    a, b, e, c = draw.normal(size=(4, M, 3, N)) * 10.0 ** draw.integers(-3, 4, (4, M, 1, N))
    # square roots that push, that help, that do both within a cell, and none
    e[::4] = np.abs(e[::4])
    e[1::4] = -np.abs(e[1::4])
    e[2::4] = 0.0
    width = np.abs(draw.normal(size=(M, 3, N)))
    c[5, 1, 2] = np.nan
    e[6, 0, 1] = np.nan
    remainder = np.abs(draw.normal(size=(4, M, N)))
    remainder[:, 7] = np.inf
    speed = draw.normal(size=(M, 3, N))
    return Cells(
        s=np.append(0.0, np.cumsum(draw.uniform(1e-5, 1e-2, M))),
        a=a,
        b=b,
        e=e,
        c_low=c - width,
        c_high=c + width,
        remainder=remainder,
        speed=speed,
        forwards=speed.max(axis=1) > 0,
        backwards=speed.min(axis=1) < 0,
        curvature=draw.normal(size=(M, 2, N)),
    )


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("bounded", [True, False])
def test_numpy_and_c_have_the_same_bits(
    seed: int, bounded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    draw = np.random.default_rng(seed)
    cells = drawn_cells(draw)
    tau_max = draw.uniform(50, 2000, N)
    qdd_max = np.where(np.arange(N) % 2, np.inf, 30.0)
    limits = MotionLimits(draw.uniform(1, 5, N), tau_max, qdd_max)
    friction = np.abs(draw.normal(size=(N, 4))) + 0.1
    low, middle, high = np.sort(draw.uniform(0, 3, (3, M)), axis=0)
    low[:9] = 0.0
    u_max = draw.uniform(0, 5, M) if bounded else np.full(M, np.inf)
    at = rows.Linearisation(middle + 1e-30, low, high, u_max, draw.normal(size=M))
    extra = draw.uniform(0, 5, (M, 2, N)) if seed % 2 else None
    given = (cells, limits, friction, at, extra)
    by_machine = rows.torque_constraints(*given)
    monkeypatch.setattr(rows, "has_machine_code", lambda: False)
    by_arrays = rows.torque_constraints(*given)
    assert by_machine.shape == (M, 8 * N + 8 * (N // 2) + 2 * bounded, 3)
    assert np.isnan(by_machine).any()
    assert not np.isnan(by_machine[10:]).any()
    np.testing.assert_array_equal(by_machine, by_arrays)
