"""The rows of a motion without jumps without a C compiler: the same sums as the machine code's, and
those that differences of the slacks say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from spline_paths import random_path

from irb2400_ctrl import load_robot
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.timing.rate_limited.cell_rows import (
    RowsOfCells,
    interpreted,
    machine_code,
)
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited

SEEDS = range(5)
MU = 0.3


def drawn(seed: int, viscous: float = 0.3) -> tuple[RowsOfCells, dict[str, Array]]:
    """Rows without a meaning on a number of cells that no block divides, and what belongs to
    them."""
    draw = np.random.default_rng(seed)
    m = 64 * seed + 37
    k = 3
    parabolas = draw.normal(size=(5, k, 3, m))
    parabolas[2] *= viscous
    motion = draw.normal(size=(7, 3, m))
    # speeds are positive
    motion[:3] = np.abs(motion[:3])
    rows = RowsOfCells(
        h=draw.uniform(0.5, 2.0, m),
        parabolas=parabolas,
        per_limit=draw.uniform(0.01, 0.1, (k, m)),
        per_rate=draw.uniform(0.01, 0.1, (k, m)),
        kept=draw.uniform(0.9, 1.0, (2, k, m)),
        scale=draw.uniform(0.5, 2.0, (3, m)),
        motion=motion,
        linear=draw.normal(size=(4, 3, m)),
        offset=np.array([1.0, 1.0, 1.0, 0.0]),
    )
    given = {
        "z": draw.uniform(0.5, 1.5, m + 2),
        "dz": draw.normal(size=m + 2),
        "bottom": -draw.uniform(size=(k, m)),
        "top": draw.uniform(size=(k, m)),
        "multipliers": draw.uniform(0.1, 1.0, (12 * k + 4, m)),
    }
    return rows, given


def slacks(rows: RowsOfCells, given: dict[str, Array], z: Array) -> Array:
    found = np.empty_like(given["multipliers"])
    machine_code.slacks(rows, z, given["bottom"], given["top"], found)
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_numpy_and_c_agree(seed: int) -> None:
    assert machine_code._library() is not None
    rows, given = drawn(seed)
    z, dz, bottom, top, multipliers = given.values()
    every = []
    for code in (machine_code, interpreted):
        slack = np.full_like(multipliers, np.nan)
        product = code.slacks(rows, z, bottom, top, slack)
        relative = np.full_like(multipliers, np.nan)
        code.along(rows, z, dz, slack, relative)
        sums = code.sums(rows, z, slack, multipliers, MU)
        down = code.steepest(slack, multipliers, relative, MU)
        after = code.updated(multipliers, slack, relative, np.abs(slack), MU, 0.7, 10.0)
        every.append((slack, product, relative, sums.pulled, sums.squares, down, after))
    for fast, slow in zip(*every, strict=True):
        scale = np.abs(slow).max()
        np.testing.assert_allclose(fast, slow, 1e-9, 1e-11 * scale)


@pytest.mark.parametrize("seed", SEEDS)
def test_sums_are_those_of_the_slopes_of_the_slacks(seed: int) -> None:
    rows, given = drawn(seed)
    z, dz, *_, multipliers = given.values()
    slack = slacks(rows, given, z)
    step = 1e-6
    change = (slacks(rows, given, z + step * dz) - slacks(rows, given, z - step * dz)) / (2 * step)
    relative = np.empty_like(slack)
    machine_code.along(rows, z, dz, slack, relative)
    np.testing.assert_allclose(relative * slack, change, 1e-6, 1e-6)
    local = np.stack([dz[:-2], dz[1:-1], dz[2:]], axis=1)
    sums = machine_code.sums(rows, z, slack, multipliers, MU)
    first, second = (sums.pulled * local).sum(axis=(1, 2))
    assert first == pytest.approx((MU / slack * change).sum(), rel=1e-5)
    assert second == pytest.approx((multipliers * change).sum(), rel=1e-5)
    square = np.einsum("mqr,mq,mr", sums.squares[0], local, local)
    assert square == pytest.approx((multipliers / slack * change**2).sum(), rel=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_bend_is_that_of_the_spare_rates(seed: int) -> None:
    """Without e the slacks are linear but for rate / sqrt(x)."""
    rows, given = drawn(seed, viscous=0.0)
    z, dz, *_, multipliers = given.values()
    slack = slacks(rows, given, z)
    step = 1e-4
    around = slacks(rows, given, z + step * dz) + slacks(rows, given, z - step * dz)
    bend = (multipliers * (around - 2 * slack)).sum() / step**2
    local = np.stack([dz[:-2], dz[1:-1], dz[2:]], axis=1)
    squares = machine_code.sums(rows, z, slack, multipliers, MU).squares[1]
    assert np.einsum("mqr,mq,mr", squares, local, local) == pytest.approx(bend, rel=1e-4)


def test_a_path_is_timed_without_a_compiler_as_with_one(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = load_robot("irb2400")
    limits = MotionLimits.of(robot)
    limits = replace(limits, torque_rate=20 * limits.tau_max)
    fast = time_rate_limited(path_dynamics(robot), random_path(0), limits, count=60)
    monkeypatch.setattr(machine_code, "_library", lambda: None)
    slow = time_rate_limited(path_dynamics(robot), random_path(0), limits, count=60)
    assert slow.duration == pytest.approx(fast.duration, rel=1e-6)
