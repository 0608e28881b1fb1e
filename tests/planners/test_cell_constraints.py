"""What keeps the constraints of a cell keeps the limits; they are exact where nothing varies."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_cells import (
    FRICTION,
    NO_FRICTION,
    NONE,
    M,
    N,
    T,
    along,
    box,
    limits,
    made,
    with_effects,
)

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.timing import time_optimal
from irb2400_ctrl.planners.timing.torque_constraints import (
    ROUNDING,
    _without_root,
    torque_constraints,
)


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


def test_a_root_of_the_speed_pushes_by_its_tangent_and_helps_by_its_chord() -> None:
    """e sqrt(x) at x of 1 to 4, its tangent at 2.25: e (x / 3 + 0.75), or e x / 2 where e is never
    above zero in the cell; where it changes its sign only what pushes is taken."""
    e = np.array([[2.0, 1.0, 0.0], [-2.0, 0.0, -1.0], [-3.0, 1.0, -3.0]])[:, :, None]
    part: Any = SimpleNamespace(b=np.ones_like(e), c=np.zeros_like(e), e=e)
    at: Any = SimpleNamespace(x_bar=np.full(3, 2.25), x_high=np.full(3, 4.0))
    b, c = _without_root(part, at)
    np.testing.assert_allclose(b[0] - 1.0, e[0] / 3)
    np.testing.assert_allclose(c[0], 0.75 * e[0])
    np.testing.assert_allclose(b[1] - 1.0, e[1] / 2)
    np.testing.assert_allclose(c[1], 0.0)
    np.testing.assert_allclose(b[2, :, 0] - 1.0, [0.0, 1 / 3, 0.0])
    np.testing.assert_allclose(c[2, :, 0], [0.0, 0.75, 0.0])
