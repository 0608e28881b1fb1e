"""Bounds on cells against what they bound, and against the sums by hand where nothing varies.

The cells are made of random numbers, no arm behind them: every term counts, and its size is known.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure import cells as enclosed
from irb2400_ctrl.planners.enclosure.cells import Cells, divided
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Range
from irb2400_ctrl.planners.enclosure.effect_forms import ScalarLaw
from irb2400_ctrl.planners.timing import time_optimal
from irb2400_ctrl.planners.timing.motion_limits import linear_bounds, speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.torque_bounds import (
    squared_speed_ratio,
    timed_torque_bounds,
    torque_bounds,
)
from irb2400_ctrl.planners.timing.torque_constraints import (
    ROUNDING,
    Linearisation,
    torque_constraints,
)

M = 300
N = 2
T = np.linspace(0.0, 1.0, 101)
FRICTION = np.array([[9.0, 4.0, 0.0, 0.5], [6.0, 5.0, 0.0, 0.2]])
"""static, Coulomb, viscous (part of e), Stribeck's speed"""
NO_FRICTION = np.array([[0.0, 0.0, 0.0, 1.0]] * N)
NONE = np.full(N, np.inf)


def made(seed: int, *, constant: bool = False, remainder: bool = False) -> tuple[Cells, Array]:
    """Random cells and sdot^2 at their ends; joint 1 goes forwards, joint 2 backwards."""
    rng = np.random.default_rng(seed)

    def parabolas() -> Array:
        values = rng.normal(size=(M, 3, N))
        return np.repeat(values[:, :1], 3, axis=1) if constant else values

    speed = np.abs(parabolas()) * [1.0, -1.0]
    a, b, e, c = (5 * parabolas() for _ in range(4))
    x = rng.uniform(0.1, 2.0, M + 1)
    forwards = np.tile([True, False], (M, 1))
    return Cells(
        s=np.cumsum(rng.uniform(0.05, 0.2, M + 1)),
        a=a,
        b=b,
        e=e,
        c_low=c,
        c_high=c,
        remainder=rng.uniform(0.1, 1.0, (4, M, N)) * remainder,
        speed=speed,
        forwards=forwards,
        backwards=~forwards,
        curvature=5 * rng.normal(size=(M, 2, N)),
    ), np.full(M + 1, 0.7) if constant else x


def along(f: Array, places: Array = T) -> Array:
    """Values of Bernstein coefficients in every cell, shape (m, places, n)."""
    return np.einsum("tk,mkn->mtn", bernstein.basis(f.shape[1] - 1, places), f)


def torque(cells: Cells, u: Array, x: Array, friction: Array) -> Array:
    """Of every cell at all T, friction by eq. 54 at the speed there, shape (m, T, n)."""
    there = (x[:-1, None] + np.diff(x)[:, None] * T)[..., None]
    qd = along(cells.speed) * np.sqrt(there)
    static, coulomb, _, stribeck = friction.T
    dry = np.sign(qd) * (coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2)))
    return (
        along(cells.a) * u[:, None, None]
        + along(cells.b) * there
        + along(cells.e) * np.sqrt(there)
        + along(cells.c_high)
        + dry
    )


def test_torque_lies_within_its_bounds_and_close_to_them() -> None:
    cells, x = made(1)
    u = np.random.default_rng(2).normal(size=M)
    seen = torque(cells, u, x, FRICTION)
    above, below = torque_bounds(cells, u, x, FRICTION)
    assert (above >= seen.max(axis=1) - 1e-12).all()
    assert (below <= seen.min(axis=1) + 1e-12).all()
    # without what a hull and a slowest speed leave: nearly what is there
    size = np.abs(seen).mean()
    assert np.median(above - seen.max(axis=1)) < 0.15 * size
    assert np.median(seen.min(axis=1) - below) < 0.15 * size


def test_torque_bounds_are_the_torque_where_nothing_varies() -> None:
    cells, x = made(3, constant=True)
    u = np.random.default_rng(4).normal(size=M)
    seen = torque(cells, u, x, NO_FRICTION)
    for bound in torque_bounds(cells, u, x, NO_FRICTION):
        np.testing.assert_allclose(bound, seen[:, 50], rtol=1e-12, atol=1e-12)


def test_dry_friction_is_between_its_least_and_that_at_the_slowest_speed() -> None:
    cells, x = made(3, constant=True)
    nothing = np.zeros(M)
    plain = torque_bounds(cells, nothing, x, NO_FRICTION)[0]
    above, below = torque_bounds(cells, nothing, x, FRICTION)
    qd = along(cells.speed)[:, 50] * np.sqrt(0.7)
    static, coulomb, _, stribeck = FRICTION.T
    level = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
    np.testing.assert_allclose((above - plain)[:, 0], level[:, 0])
    np.testing.assert_allclose((plain - below)[:, 1], level[:, 1])
    # the other way it helps by the least that it ever is
    np.testing.assert_allclose((below - plain)[:, 0], 4.0)
    np.testing.assert_allclose((plain - above)[:, 1], 5.0)


def test_what_the_parabolas_miss_counts_with_what_multiplies_it() -> None:
    with_rest, x = made(5, remainder=True)
    plain, _ = made(5)
    u = np.random.default_rng(6).normal(size=M)
    fastest = np.maximum(x[:-1], x[1:])
    factors = np.stack([np.abs(u), fastest, np.sqrt(fastest), np.ones(M)])
    rest = np.einsum("km,kmn->mn", factors, with_rest.remainder)
    above, below = torque_bounds(with_rest, u, x, FRICTION)
    sharp = torque_bounds(plain, u, x, FRICTION)
    np.testing.assert_allclose(above - sharp[0], rest, atol=1e-12)
    np.testing.assert_allclose(sharp[1] - below, rest, atol=1e-12)


@pytest.mark.parametrize("constant", [True, False])
def test_bounds_of_a_motion_over_the_time(constant: bool) -> None:
    """sdot is 1 and sddot 0: b and e act as they are."""
    cells, _ = made(7, constant=constant, remainder=True)
    still = np.zeros(M)
    seen = torque(cells, still, np.ones(M + 1), FRICTION)
    above, below = timed_torque_bounds(cells, FRICTION)
    room = cells.remainder[1:].sum(axis=0)
    assert (above - room >= seen.max(axis=1) - 1e-12).all()
    assert (below + room <= seen.min(axis=1) + 1e-12).all()
    free = timed_torque_bounds(cells, NO_FRICTION)
    seen = torque(cells, still, np.ones(M + 1), NO_FRICTION)
    if constant:
        np.testing.assert_allclose(free[0] - room, seen[:, 50], atol=1e-12)
        np.testing.assert_allclose(free[1] + room, seen[:, 50], atol=1e-12)
    # of a parabola the hull of degree three is wider by a third of its bend at most
    bend = np.abs(np.diff(cells.b + cells.e + cells.c_high, 2, axis=1))[:, 0]
    assert (free[0] - room - seen.max(axis=1) <= bend / 2 + 1e-12).all()


def test_speed_within_its_bound() -> None:
    cells, x = made(8)
    qd_max = np.array([0.5, 3.0])
    there = (x[:-1, None] + np.diff(x)[:, None] * T)[..., None]
    ratio = along(cells.speed) ** 2 * there / qd_max**2
    bound = squared_speed_ratio(cells, x, qd_max)
    assert (bound >= ratio.max(axis=1) - 1e-12).all()
    assert np.median(bound / ratio.max(axis=1)) < 1.2
    still, x = made(8, constant=True)
    np.testing.assert_allclose(
        squared_speed_ratio(still, x, qd_max), still.speed[:, 0] ** 2 * 0.7 / qd_max**2
    )


def test_straight_lines_below_which_products_stay_below_one() -> None:
    rng = np.random.default_rng(9)
    G = rng.uniform(0.1, 3.0, (M, 5, 3))
    first, last = linear_bounds(G)
    line = first[:, None] + (last - first)[:, None] * T
    value = along(G) * line[..., None]
    assert value.max() <= 1 + 1e-12
    # of one joint some coefficient of the product is at one: it cannot be raised as a whole
    single = [linear_bounds(G[:, :, [k]]) for k in range(3)]
    for k, lines in enumerate(single):
        found = bernstein.product(G[:, :, k], bernstein.linear(*lines))
        np.testing.assert_allclose(found.max(axis=1), 1.0)
        # and the ends are as large against each other as it allows them there
        np.testing.assert_allclose(lines[0] / lines[1], G[:, 4, k] / G[:, 0, k])
    np.testing.assert_array_equal([first, last], np.min(single, axis=0))


def test_a_joint_that_stands_at_an_end_allows_a_hundred_times_there() -> None:
    G = np.array([[0.0, 0.0, 0.0, 0.0, 2.0]])[..., None]
    first, last = linear_bounds(G)
    found = bernstein.product(G, bernstein.linear(np.array([50.0]), np.array([0.5]))[..., None])
    share = max(1.0, found.max())
    np.testing.assert_allclose([first[0], last[0]], [50.0 / share, 0.5 / share])
    np.testing.assert_allclose(linear_bounds(np.zeros((1, 5, 1))), 1e12)


def test_speed_bounds_take_the_slower_of_two_cells_and_the_feed() -> None:
    cells, _ = made(10, constant=True)
    qd_max = np.array([0.5, 3.0])
    allowed = ((qd_max / cells.speed[:, 0]) ** 2).min(axis=1)
    padded = np.concatenate([[np.inf], allowed, [np.inf]])
    expected = np.minimum(padded[:-1], padded[1:])
    np.testing.assert_allclose(speed_bounds(cells, qd_max), expected)
    feed = np.random.default_rng(11).uniform(0.0, 2.0, (2, M))
    both = [np.minimum(allowed, one) for one in feed]
    found = speed_bounds(cells, qd_max, feed)
    np.testing.assert_allclose(found[1:-1], np.minimum(both[0][1:], both[1][:-1]))
    np.testing.assert_allclose(found[[0, -1]], [both[0][0], both[1][-1]])
    np.testing.assert_allclose(
        speed_bounds(cells, qd_max, feed[0]), speed_bounds(cells, qd_max, feed[[0, 0]])
    )


def limits(torque: float = 20.0, acceleration: Array = NONE) -> MotionLimits:
    return MotionLimits(NONE, np.full(N, torque), acceleration)


def box(x_low: float, x_high: float, u_max: float) -> Linearisation:
    whole = np.ones(M)
    middle = (x_low + x_high) / 2
    return Linearisation(middle * whole, x_low * whole, x_high * whole, u_max * whole, 0 * whole)


@pytest.mark.parametrize("acceleration", [NONE, np.array([np.inf, 6.0])])
def test_whatever_keeps_the_constraints_keeps_the_limits(acceleration: Array) -> None:
    cells, _ = made(12, remainder=True)
    cells = replace(cells, c_low=cells.c_low - 1.0)
    at = box(0.2, 1.8, 0.9)
    table = torque_constraints(cells, limits(30.0, acceleration), FRICTION, at)
    rng = np.random.default_rng(13)
    kept = 0
    for _ in range(40):
        u = rng.uniform(-0.9, 0.9, M)
        first = rng.uniform(0.2, 1.8, M)
        last = first + 2 * cells.h * u
        fine = (last >= 0.2) & (last <= 1.8)
        last = np.clip(last, 0.2, 1.8)
        p, q, r = np.moveaxis(table, 2, 0)
        fine &= (p * u[:, None] + q * first[:, None] <= r).all(axis=1)
        kept += int(fine.sum())
        line = (first[:, None] + (last - first)[:, None] * T)[..., None]
        qd = along(cells.speed) * np.sqrt(line)
        static, coulomb, _, stribeck = FRICTION.T
        dry = np.sign(qd) * (coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2)))
        moved = along(cells.a) * u[:, None, None] + along(cells.b) * line
        moved = moved + along(cells.e) * np.sqrt(line) + dry
        rest = cells.remainder[0] * np.abs(u)[:, None]
        rest = (rest + cells.remainder[3])[:, None] + cells.remainder[1][:, None] * line
        rest = rest + cells.remainder[2][:, None] * np.sqrt(line)
        highest = (moved + along(cells.c_high) + rest)[fine]
        lowest = (moved + along(cells.c_low) - rest)[fine]
        assert highest.max() <= 30.0
        assert lowest.min() >= -30.0
        qdd = along(cells.curvature) * line + along(cells.speed) * u[:, None, None]
        assert (np.abs(qdd)[fine] <= acceleration).all()
    assert kept > 500


def test_constraints_are_exact_where_nothing_varies() -> None:
    """A point on the edge: torque over its limit, with friction and what the parabolas miss."""
    cells, _ = made(14, constant=True, remainder=True)
    cells = replace(
        cells, e=np.zeros_like(cells.e), b=np.zeros_like(cells.b), c_low=cells.c_low - 2.0
    )
    at = box(0.5, 0.5, 0.8)
    table = torque_constraints(cells, limits(40.0), FRICTION, at)
    u = 0.3 * np.ones(M)
    p, q, r = np.moveaxis(table, 2, 0)
    left = (r - p * u[:, None] - q * 0.5).reshape(M, -1)
    assert left.shape[1] == 2 * 4 * N + 2
    one, other = (left[:, 8 * k : 8 * k + 8].reshape(M, 4, N) for k in (0, 1))
    qd = cells.speed[:, 0] * np.sqrt(0.5)
    static, coulomb, _, stribeck = FRICTION.T
    level = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
    top = np.where(cells.forwards, level, -coulomb)
    bottom = np.where(cells.backwards, -level, coulomb)
    factors = np.array([0.8, 0.5, np.sqrt(0.5), 1.0])
    rest = np.einsum("k,kmn->mn", factors, cells.remainder)
    above = cells.a[:, 0] * 0.3 + cells.c_high[:, 0] + top + rest
    below = cells.a[:, 0] * 0.3 + cells.c_low[:, 0] + bottom - rest
    for k in range(4):
        np.testing.assert_allclose(one[:, k], 1 - ROUNDING - above / 40.0, atol=1e-12)
        np.testing.assert_allclose(other[:, k], 1 - ROUNDING + below / 40.0, atol=1e-12)
    # |u| <= u_max, the last two
    np.testing.assert_allclose(left[:, -2:], np.tile([0.8 - 0.3, 0.8 + 0.3], (M, 1)))
    held = np.stack([np.full((M, N), 3.0), np.full((M, N), 5.0)], axis=1)
    less = torque_constraints(cells, limits(40.0), FRICTION, at, held)
    np.testing.assert_allclose((table - less)[:, :8, 2], 3.0 / 40.0)
    np.testing.assert_allclose((table - less)[:, 8:16, 2], 5.0 / 40.0)
    # a first guess leaves the remainder out, and does not bound u
    rough = torque_constraints(cells, limits(40.0), FRICTION, replace(at, u_max=np.full(M, np.inf)))
    assert rough.shape[1] == 16
    more = (rough[:, :8, 2] - table[:, :8, 2]).reshape(M, 4, N)
    np.testing.assert_allclose(more, np.repeat((rest / 40.0)[:, None], 4, axis=1))


def test_the_root_is_bounded_by_its_tangent_and_its_chord() -> None:
    """e sqrt(x) of one sign: at the tangent's point, and at both ends of the chord, exactly."""
    cells, _ = made(15, constant=True)
    zero = np.zeros_like(cells.a)
    bare = replace(cells, a=zero, b=zero, c_low=zero, c_high=zero)
    at = box(0.4, 1.6, 0.5)
    for sign in (1.0, -1.0):
        e = sign * np.abs(cells.e)
        table = torque_constraints(replace(bare, e=e), limits(50.0), NO_FRICTION, at)
        q, r = (table[:, :8, k].reshape(M, 4, N)[:, 0] for k in (1, 2))
        bound = {x: 50.0 * (q * x - r + 1 - ROUNDING) for x in (0.0, 1.0, 1.6)}
        if sign > 0:
            np.testing.assert_allclose(bound[1.0], e[:, 0])
            np.testing.assert_allclose(bound[0.0], e[:, 0] / 2)
        else:
            np.testing.assert_allclose(bound[1.6], e[:, 0] * np.sqrt(1.6))
            np.testing.assert_allclose(bound[0.0], 0.0, atol=1e-12)


def test_acceleration_of_a_cell_nearby_bounds_that_of_a_cell() -> None:
    x = np.zeros(40)
    x[20] = 4.0
    h = np.full(39, 0.5)
    found = time_optimal._acceleration_bound(x, h)
    # 3 |dx| / (2 h) of the eleven cells around, and a thousandth of the mean of x twice over h
    expected = np.where(np.abs(np.arange(39) - 19.5) < 6, 12.0, 0.0)
    expected += np.where(np.abs(np.arange(39) - 19.5) < 1, 8e-3, 0.0)
    np.testing.assert_allclose(found, expected)
    np.testing.assert_allclose(
        time_optimal._widened(x), np.where(np.abs(np.arange(40) - 20) <= 3, 4.0, 0.0)
    )
    np.testing.assert_allclose(time_optimal._mean(np.array([1.0, 3.0, 0.0, 0.0])), [2, 1.5, 1e-30])


def test_share_of_the_limit_that_the_enclosure_takes() -> None:
    cells, x = made(16, remainder=True)
    fastest = np.maximum(x[:-1], x[1:])
    u = time_optimal._acceleration_bound(x, cells.h)
    factors = np.stack([u, fastest, np.sqrt(fastest), np.ones(M)])
    rest = np.einsum("km,kmn->mn", factors, cells.remainder) / [20.0, 40.0]
    given = MotionLimits(NONE, np.array([20.0, 40.0]), NONE)
    np.testing.assert_allclose(
        time_optimal.remainder_share(cells, given, FRICTION, x), rest.max(axis=1)
    )


def test_the_law_is_motion_at_constant_acceleration() -> None:
    """v = 0 -> 2 m/s over 1 m, 2 m/s over 3 m, to rest over 0.5 m: by the school's formulas."""
    law = PiecewiseConstantLaw(np.array([0.0, 1.0, 4.0, 4.5]), np.array([0.0, 4.0, 4.0, 0.0]))
    np.testing.assert_allclose(law.u, [2.0, 0.0, -4.0])
    np.testing.assert_allclose(law.time, [0.0, 1.0, 2.5, 3.0])
    assert law.duration == 3.0
    time = np.array([-1.0, 0.0, 0.5, 1.0, 1.75, 2.75, 3.0, 9.0])
    s, v, u = law.at(time)
    np.testing.assert_allclose(s, [0.0, 0.0, 0.25, 1.0, 2.5, 4.375, 4.5, 4.5])
    np.testing.assert_allclose(v, [0.0, 0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0])
    np.testing.assert_allclose(u, [0.0, 2.0, 2.0, 0.0, 0.0, -4.0, 0.0, 0.0])
    x, u = law.on(np.array([0.0, 0.5, 1.0, 4.25, 4.5]))
    np.testing.assert_allclose(x, [0.0, 2.0, 4.0, 2.0, 0.0])
    np.testing.assert_allclose(u, [2.0, 2.0, 0.0, -4.0, -4.0])
    np.testing.assert_allclose(law.largest, [4.0, 4.0, 4.0])
    np.testing.assert_allclose(law.above, [[0.0, 4.0, 4.0], [4.0, 4.0, 0.0]])
    slow = law.slowed(2.0)
    np.testing.assert_allclose(slow.x, [0.0, 1.0, 1.0, 0.0])
    np.testing.assert_allclose(slow.duration, 6.0)


def test_a_law_slowed_where_it_is_asked_for() -> None:
    law = PiecewiseConstantLaw(np.array([0.0, 1.0, 4.0, 4.5]), np.array([0.0, 4.0, 4.0, 0.0]))
    time = np.linspace(0.0, 3.0, 13)
    as_it_is = law.slowed_at(time, np.ones(13))
    np.testing.assert_array_equal(as_it_is.s, law.s)
    np.testing.assert_array_equal(as_it_is.x, law.x)
    factor = np.where(np.isclose(time, 1.75), 2.0, 1.0)
    slow = law.slowed_at(time, factor)
    # passed at 1.5, 1.75 and 2 s; the sample at 1.75 alone is slower
    np.testing.assert_allclose(slow.s, [0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 4.5])
    np.testing.assert_allclose(slow.x, [0.0, 4.0, 4.0, 1.0, 4.0, 4.0, 0.0])
    # what falls on a point of the grid is no point more, and is slower there
    at_point = law.slowed_at(np.array([1.0, 1.5]), np.array([2.0, 1.0]))
    np.testing.assert_allclose(at_point.s, [0.0, 1.0, 2.0, 4.0, 4.5])
    np.testing.assert_allclose(at_point.x, [0.0, 1.0, 4.0, 4.0, 0.0])


def test_grids_are_cut_into_equal_parts() -> None:
    found = divided(np.array([0.0, 1.0, 4.0, 4.5]), np.array([2, 3, 1]))
    np.testing.assert_allclose(found, [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 4.5])


def test_square_of_a_parabola_lies_within_what_its_own_parabola_misses() -> None:
    rng = np.random.default_rng(17)
    speed = rng.normal(size=(M, 3, N))
    parabola, missed = enclosed._square(speed)
    off = np.abs(along(speed) ** 2 - along(parabola))
    assert (off <= missed[:, None] + 1e-12).all()
    # at most twice what is there, and nothing for a straight line squared
    np.testing.assert_allclose(off[:, [0, 50, 100]], 0.0, atol=1e-12)
    assert np.median(missed / off.max(axis=1)) < 1.6
    line = bernstein.raised(speed[:, :2], 2)
    np.testing.assert_allclose(enclosed._square(line)[1], 0.0, atol=1e-12)
    # of t^2 squared, t^4: what the parabola through 0, 1/16 and 1 leaves, at most
    quartic, left = enclosed._square(np.array([[[0.0], [0.0], [1.0]]]))
    np.testing.assert_allclose(quartic[0, :, 0], [0.0, 2 / 16 - 1 / 2, 1.0])
    np.testing.assert_allclose(left, np.sqrt(3) / 36 * 2.5)


def test_c_lies_between_the_directions_that_occur() -> None:
    """From those for motion backwards, at rest, forwards: 1, 2, 3, or with a range around them."""
    c = [k * np.ones((4, 3, 1)) for k in (1.0, 2.0, 3.0)]
    forwards = np.array([[True], [False], [True], [False]])
    backwards = np.array([[False], [True], [True], [False]])
    low, high = enclosed._static_band(c, [], forwards, backwards)
    np.testing.assert_array_equal(low[:, 0, 0], [3.0, 1.0, 1.0, 2.0])
    np.testing.assert_array_equal(high[:, 0, 0], [3.0, 1.0, 3.0, 2.0])
    around = [enclosed.Range(-0.1 * k * c[0], 0.2 * k * c[0]) for k in (1, 2, 3)]
    low, high = enclosed._static_band(c, around, forwards, backwards)
    np.testing.assert_allclose(low[:, 0, 0], [2.7, 0.9, 0.9, 1.8])
    np.testing.assert_allclose(high[:, 0, 0], [3.6, 1.2, 3.6, 2.4])


def test_a_hair_of_rounding_is_no_motion() -> None:
    s = np.array([0.0, 1.0, 2.0])
    eps = np.finfo(float).eps
    curvature = np.ones((2, 2, 1))
    # 32 roundings of the length, 2, times q'', and of the speed itself
    noise = 32 * eps * (2.0 + 1.0)
    for size, moves in ((0.9 * noise, False), (1.1 * noise, True)):
        speed = np.array([[[1.0], [0.5], [-size]], [[-1.0], [-0.5], [size]]])
        forwards, backwards = enclosed._directions(s, speed, curvature)
        np.testing.assert_array_equal(forwards[:, 0], [True, moves])
        np.testing.assert_array_equal(backwards[:, 0], [moves, True])


def test_factors_of_the_time_add_their_ranges_and_what_is_missed() -> None:
    ones = np.ones((2, 3, 1))
    fitted = [float(k) * ones for k in range(12)]
    remainder = np.arange(12.0)[:, None, None] * np.ones((12, 2, 1))
    low, high = np.array([-2.0]), np.array([1.0])
    ranges, rest = enclosed._time_ranges(fitted, remainder, (low, high))
    np.testing.assert_allclose([r.low[0, 0, 0] for r in ranges], [-2.0 * k for k in range(6, 12)])
    np.testing.assert_allclose([r.high[0, 0, 0] for r in ranges], range(6, 12))
    np.testing.assert_allclose(rest[:, 0, 0], [k + 2.0 * (k + 6) for k in range(6)])
    none = np.zeros(0)
    assert enclosed._time_ranges(fitted, remainder, (none, none))[0] == []


ARM = MotionLimits(np.array([1.0, 2.0]), np.array([30.0, 40.0]), np.array([np.inf, 5.0]))
RAIL = ExternalAxes(
    names=("turn",), direction=np.array([[0.0, 0, 1]]), point=np.zeros((1, 3)),
    low=np.array([-1.0]), high=np.array([1.0]), speed=np.array([0.5]),
    acceleration=np.array([2.0]), jerk=np.array([7.0]),
)  # fmt: skip


def test_limits_may_only_be_tightened() -> None:
    wider = replace(ARM, tau_max=np.array([30.0, 40.0 * (1 + 2e-9)]))
    assert ARM.within(ARM) is ARM
    with pytest.raises(InputError, match=r"tau_max of axis 2 is 40 Nm"):
        wider.within(ARM)
    assert replace(ARM, tau_max=np.array([30.0, 40.0 * (1 + 5e-10)])).within(ARM)
    with pytest.raises(InputError, match=r"qd_max of axis 1 is 0 rad/s"):
        replace(ARM, qd_max=np.array([0.0, 2.0])).within(ARM)
    with pytest.raises(InputError, match=r"qdd_max of axis 2 is nan"):
        replace(ARM, qdd_max=np.array([1.0, np.nan])).within(ARM)


def test_rates_are_for_all_axes_or_for_each() -> None:
    assert not ARM.smooth
    rated = ARM.with_rates(100.0, [np.inf, 9.0])
    assert rated.smooth
    np.testing.assert_array_equal(rated.torque_rate, [100.0, 100.0])
    np.testing.assert_array_equal(rated.jerk, [np.inf, 9.0])
    assert not ARM.with_rates(np.inf, None).smooth
    assert ARM.with_rates(None, 3.0).smooth
    for wrong in (0.0, -1.0, [1.0, 0.0], [1.0, 2.0, 3.0], np.nan):
        with pytest.raises(InputError, match="torque_rate"):
            ARM.with_rates(wrong, None)


def test_external_axes_stand_behind_the_arms() -> None:
    found = ARM.with_external(RAIL, None)
    np.testing.assert_array_equal(found.qd_max, [1.0, 2.0, 0.5])
    np.testing.assert_array_equal(found.tau_max, [30.0, 40.0, 2.0])
    np.testing.assert_array_equal(found.qdd_max, [np.inf, 5.0, np.inf])
    np.testing.assert_array_equal(found.torque_rate, [np.inf, np.inf, 7.0])
    assert found.jerk is None
    rated = ARM.with_rates(100.0, 9.0)
    # the smaller of the axis' jerk, 7, and three times its acceleration a second
    np.testing.assert_array_equal(rated.with_external(RAIL, 3.0).torque_rate, [100.0, 100.0, 6.0])
    np.testing.assert_array_equal(rated.with_external(RAIL, 4.0).torque_rate, [100.0, 100.0, 7.0])
    np.testing.assert_array_equal(rated.with_external(RAIL, 4.0).jerk, [9.0, 9.0, np.inf])
    np.testing.assert_array_equal(found.with_room(2, 0.5).tau_max, [30.0, 40.0, 1.0])
    first = rated.with_external(RAIL, 3.0).first(2)
    for name in ("qd_max", "tau_max", "qdd_max", "torque_rate", "jerk"):
        np.testing.assert_array_equal(getattr(first, name), getattr(rated, name))
    assert found.first(2).jerk is None
    assert ARM.first(1).torque_rate is None


def scalar_law(joint: int, of: Literal["speed", "load"], slope: float) -> ScalarLaw:
    """f(w) = 3 + slope w, whatever the direction of motion."""
    w, direction, state = (ca.SX.sym(name) for name in ("w", "direction", "state"))
    values = ca.Function("f", [w, direction, state], [3 + slope * w, slope, 0])
    return ScalarLaw(joint, of, values, np.empty(0), np.empty(0), None, curved=False)


def with_effects(cells: Cells, seed: int, *, load_slope: float) -> Cells:
    """Factors of the time, a law of the speed on joint 1, a law of the load on joint 2."""
    rng = np.random.default_rng(seed)

    def around() -> Range:
        part = 3 * rng.normal(size=(M, 3, N))
        return Range.of([part], np.array([-0.5]), np.array([0.8]))

    one_way = np.where(cells.forwards, 1.0, -1.0)
    square, missed = enclosed._square(cells.speed)
    load = tuple(4 * rng.normal(size=(M, 3, N)) for _ in range(3))
    nothing = (np.zeros(M), np.zeros(M))
    return replace(
        cells,
        added=Added(
            around(),
            around(),
            around(),
            laws=(scalar_law(0, "speed", 2.0), scalar_law(1, "load", load_slope)),
            direction=(one_way, one_way),
            states=(nothing, nothing),
            load=load,
            load_remainder=rng.uniform(0.1, 0.3, (3, M, N)),
            square=square,
            square_remainder=missed,
        ),
    )


@pytest.mark.parametrize("load_slope", [1.5, -1.5])
def test_effects_beside_the_regular_form_lie_within_the_bounds(load_slope: float) -> None:
    """Ranges at either end, 3 + 2 qd^2 on joint 1, 3 ± 1.5 |load| on joint 2, the load off by what
    its parabolas miss."""
    plain, x = made(18)
    cells = with_effects(plain, 19, load_slope=load_slope)
    assert cells.added is not None
    u = np.random.default_rng(20).normal(size=M)
    there = (x[:-1, None] + np.diff(x)[:, None] * T)[..., None]
    regular = torque(plain, u, x, NO_FRICTION)
    speed = 3 + 2 * (along(cells.speed) ** 2 * there)[..., 0]
    a, b, c = (along(f) for f in cells.added.load)
    load = (a * u[:, None, None] + b * there + c)[..., 1]
    r_a, r_b, r_c = cells.added.load_remainder[..., 1]
    off = r_a[:, None] * np.abs(u)[:, None] + r_b[:, None] * there[..., 0] + r_c[:, None]
    ends = []
    for sign in (1.0, -1.0):
        felt = 3 + load_slope * np.abs(load)
        room = 1.5 * off * sign
        law = np.stack([speed, felt + room], axis=2)
        total = regular + law
        for part, factor in (
            (cells.added.a, u[:, None, None]),
            (cells.added.b, there),
            (cells.added.e, np.sqrt(there)),
        ):
            both = [along(end) * factor for end in (part.low, part.high)]
            total = total + (np.maximum(*both) if sign > 0 else np.minimum(*both))
        ends.append(total)
    above, below = torque_bounds(cells, u, x, NO_FRICTION)
    # |load - off| is not below nothing: a load that passes zero may be smaller by less
    passed = np.abs(load).min(axis=1) > off.max(axis=1)
    sound = np.stack([np.ones(M, dtype=bool), passed], axis=1)
    assert passed.sum() > 50
    assert (above >= ends[0].max(axis=1) - 1e-9)[sound].all()
    assert (below <= ends[1].min(axis=1) + 1e-9)[sound].all()
    size = np.abs(ends[0]).mean()
    for joint in range(N):
        here = sound[:, joint]
        assert np.median((above - ends[0].max(axis=1))[here, joint]) < 0.35 * size
        assert np.median((ends[1].min(axis=1) - below)[here, joint]) < 0.35 * size


@pytest.mark.parametrize("load_slope", [1.5, -1.5])
def test_constraints_keep_the_torque_of_effects_and_the_load_within_their_bounds(
    load_slope: float,
) -> None:
    plain, _ = made(21)
    cells = with_effects(plain, 22, load_slope=load_slope)
    assert cells.added is not None
    at = box(0.3, 1.5, 0.6)
    table = torque_constraints(cells, limits(45.0), NO_FRICTION, at)
    p, q, r = np.moveaxis(table, 2, 0)
    # the rows of the load, before the last two of |u|: its law is straight, so only far bounds
    rows = [part[:, -18:-2].reshape(M, 2, 4, N) for part in (p, q, r)]
    a, b, c = cells.added.load
    raised = [bernstein.raised(f, 3) for f in (a, b, c)]
    raised[0] = raised[0] + 2 * cells.h[:, None, None] * bernstein.times_parameter(b)
    cap = 1e6 * 45.0
    for k, side in enumerate((1.0, -1.0)):
        np.testing.assert_allclose(rows[0][:, k], side * raised[0] / cap)
        np.testing.assert_allclose(rows[1][:, k], side * raised[1] / cap)
        np.testing.assert_allclose(rows[2][:, k], 1 - ROUNDING - side * raised[2] / cap)
    rng = np.random.default_rng(23)
    kept = 0
    for _ in range(40):
        u = rng.uniform(-0.6, 0.6, M)
        first = rng.uniform(0.3, 1.5, M)
        last = first + 2 * cells.h * u
        fine = (last >= 0.3) & (last <= 1.5)
        fine &= (p * u[:, None] + q * first[:, None] <= r).all(axis=1)
        kept += int(fine.sum())
        x = np.clip(last, 0.3, 1.5)
        line = (first[:, None] + (x - first)[:, None] * T)[..., None]
        arm = along(cells.a) * u[:, None, None] + along(cells.b) * line
        arm = arm + along(cells.e) * np.sqrt(line) + along(cells.c_high)
        load = (along(a) * u[:, None, None] + along(b) * line + along(c))[..., 1]
        speed = 3 + 2 * (along(cells.speed) ** 2 * line)[..., 0]
        law = np.stack([speed, 3 + load_slope * np.abs(load)], axis=2)
        for sign in (1.0, -1.0):
            total = arm + law
            for part, factor in (
                (cells.added.a, u[:, None, None]),
                (cells.added.b, line),
                (cells.added.e, np.sqrt(line)),
            ):
                both = [along(end) * factor for end in (part.low, part.high)]
                total = total + (np.maximum(*both) if sign > 0 else np.minimum(*both))
            assert (sign * total[fine]).max() <= 45.0
    assert kept > 300
