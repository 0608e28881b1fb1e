"""Bounds on cells against what they bound, and against the sums by hand where nothing varies."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_cells import (
    FRICTION,
    NO_FRICTION,
    M,
    N,
    T,
    along,
    made,
    torque,
    with_effects,
)

from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.timing.motion_limits import linear_bounds, speed_bounds
from irb2400_ctrl.planners.timing.torque_bounds import (
    squared_speed_ratio,
    timed_torque_bounds,
    torque_bounds,
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
