"""Bounds of outputs and of their rates on parts of cells, against the sums by hand where nothing
varies and against what they bound where everything does."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Range
from irb2400_ctrl.planners.timing.rate_limited import output_bounds
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios

M = 200
K = 2
T = np.linspace(0.0, 1.0, 101)
LIMIT = np.array([40.0, 50.0])
RATE = np.array([300.0, np.inf])


def along(f: Array) -> Array:
    """Values of Bernstein coefficients in every part, shape (m, T, …)."""
    return np.einsum("tk,mk...->mt...", bernstein.basis(f.shape[1] - 1, T), f)


def outputs(seed: int, *, constant: bool = False) -> ConstrainedOutputs:
    rng = np.random.default_rng(seed)

    def parabolas() -> Array:
        values = 5 * rng.normal(size=(M, 3, K))
        return np.repeat(values[:, :1], 3, axis=1) if constant else values

    a, b, e, c = (parabolas() for _ in range(4))
    everywhere = np.ones((M, K))
    return ConstrainedOutputs(
        h=rng.uniform(0.05, 0.2, M), a=a, b=b, e=e, c_high=c, c_low=c,
        remainder=np.zeros((4, M, K)), slow=0.3 * everywhere, forwards=everywhere > 0,
        backwards=everywhere < 0, friction=np.array([0.0, 0, 0, 1])[:, None, None] * everywhere,
        limit=LIMIT * everywhere, rate=RATE * everywhere,
        axis=np.tile(np.arange(1, K + 1), (M, 1)),
    )  # fmt: skip


def motion(c: ConstrainedOutputs, seed: int) -> tuple[Array, Array, Array]:
    """x quadratic and u = x' / 2 linear in s on every part; the slope of u."""
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(M, 2))
    x0 = rng.uniform(0.8, 2.0, M)
    x = np.stack([x0, x0 + c.h * u[:, 0], x0 + c.h * u.sum(axis=1)], axis=1)
    return x, u, np.diff(u, axis=1)[:, 0] / c.h


def value(c: ConstrainedOutputs, x: Array, u: Array) -> Array:
    """a u + b x + e sqrt(x) + c in every part at all T, shape (m, T, k)."""
    there = along(x)[..., None]
    moving = along(c.a) * along(u)[..., None] + along(c.b) * there + along(c.e) * np.sqrt(there)
    return moving + along(c.c_high)


def test_values_lie_within_their_bounds_and_close_to_them() -> None:
    c = outputs(1)
    x, u, _ = motion(c, 2)
    seen = np.abs(value(c, x, u)).max(axis=1)
    bound = LIMIT * output_bounds._values(c, None, x, u, ())
    assert (bound >= seen - 1e-12).all()
    assert np.median(bound / seen) < 1.15


def test_values_are_the_sum_where_nothing_varies() -> None:
    c = outputs(3, constant=True)
    u = np.zeros((M, 2))
    x = np.full((M, 3), 1.44)
    seen = value(c, x, u)[:, 50]
    np.testing.assert_allclose(
        LIMIT * output_bounds._values(c, None, x, u, ()), np.abs(seen), atol=1e-12
    )
    # a band of c, dry friction and what the parabolas miss
    u = np.full((M, 2), -0.5)
    rest = np.random.default_rng(4).uniform(0.1, 1.0, (4, M, K))
    friction = np.array([9.0, 4.0, 0.0, 0.5])[:, None, None] * np.ones((4, M, K))
    odd = replace(c, c_low=c.c_low - 2.0, remainder=rest, friction=friction)
    missed = np.einsum("k,kmj->mj", [0.5, 1.44, 1.2, 1.0], rest)
    plain = c.a[:, 0] * -0.5 + c.b[:, 0] * 1.44 + c.e[:, 0] * 1.2 + c.c_high[:, 0]
    level = 4.0 + 5.0 * np.exp(-((0.3 * 1.2 / 0.5) ** 2))
    found = LIMIT * output_bounds._values(odd, None, x, u, ())
    # forwards: at most the level at the slowest speed, at least Coulomb's
    expected = np.maximum(plain + level, -(plain - 2.0) - 4.0) + missed
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_at_an_end_every_term_is_at_its_largest() -> None:
    """From rest: x up to 0.64, u up to 0.9, each from zero, as they come together or not."""
    c = outputs(5)
    u = np.zeros((M, 2))
    x = np.full((M, 3), 0.64)
    u[0] = [0.0, 0.9]
    u[-1] = [-0.9, 0.0]
    found = LIMIT * output_bounds._values(c, None, x, u, (0, -1))
    inner = LIMIT * output_bounds._values(c, None, x, u, ())
    np.testing.assert_array_equal(found[1:-1], inner[1:-1])
    for end, turn in ((0, 0.9), (-1, -0.9)):
        sides = []
        for side in (1.0, -1.0):
            terms = [
                (side * size * f[end]).max(axis=0)
                for size, f in ((turn, c.a), (0.64, c.b), (0.8, c.e))
            ]
            sides.append(np.maximum(terms, 0.0).sum(axis=0) + (side * c.c_high[end]).max(axis=0))
        np.testing.assert_allclose(found[end], np.max(sides, axis=0))


def test_effects_of_the_time_add_to_the_coefficients_of_the_torques() -> None:
    """Of two outputs the first is a torque: a factor that is known is a number more in a, b and e,
    one that is known to lie in a band is at worst at either end of it."""
    c = outputs(15)
    x, u, _ = motion(c, 16)
    more = 2.0 * np.ones((M, 3, 1))
    nothing = np.zeros((M, 1))

    def added(low: float, high: float) -> Added:
        band = Range(low * more, high * more)
        return Added(
            a=band, b=band, e=band, laws=(), direction=(nothing, nothing), states=(),
            load=(np.zeros(0),) * 3, load_remainder=np.zeros(0),
            square=0.0 * more, square_remainder=nothing,
            friction=FrictionLaw(*np.ones((4, 1))),
        )  # fmt: skip

    def numbers(factor: float) -> ConstrainedOutputs:
        step = factor * 2.0 * np.array([1.0, 0.0])
        return replace(c, a=c.a + step, b=c.b + step, e=c.e + step)

    for ends in ((), (0, -1)):
        plain = output_bounds._values(c, None, x, u, ends)
        for factor in (0.5, -0.5):
            found = output_bounds._values(c, added(factor, factor), x, u, ends)
            expected = output_bounds._values(numbers(factor), None, x, u, ends)
            np.testing.assert_allclose(found, expected, rtol=1e-12)
            np.testing.assert_array_equal(found[:, 1], plain[:, 1])
    band = output_bounds._values(c, added(-0.5, 0.5), x, u, ())
    either = [output_bounds._values(numbers(factor), None, x, u, ()) for factor in (-0.5, 0.5)]
    assert (band >= np.max(either, axis=0) - 1e-12).all()


def rate_of(c: ConstrainedOutputs, x: Array, u: Array) -> Array:
    """d/dt of the value, by differences of it over s times sdot, shape (m, T - 1, k)."""
    step = (c.h[:, None] * np.diff(T))[..., None]
    speed = np.sqrt(along(x))[..., None]
    return np.diff(value(c, x, u), axis=1) / step * (speed[:, 1:] + speed[:, :-1]) / 2


def test_rates_lie_within_their_bounds_and_close_to_them() -> None:
    c = outputs(6)
    x, u, slope = motion(c, 7)
    seen = np.abs(rate_of(c, x, u)).max(axis=1)
    bound = output_bounds._rates(c, x, u, slope, ())
    # differences of samples are exact to their curvature
    assert (RATE[0] * bound[:, 0] >= seen[:, 0] * (1 - 2e-3)).all()
    assert np.median(RATE[0] * bound[:, 0] / seen[:, 0]) < 1.35
    np.testing.assert_array_equal(bound[:, 1], 0.0)
    # in a band the slope of c is not known
    band = replace(c, c_low=c.c_low - [[[1.0, 0.0]]])
    assert np.isinf(output_bounds._rates(band, x, u, slope, ())[:, 0]).all()


def test_rates_are_the_sum_where_nothing_varies() -> None:
    """sqrt(x) (2 b u + a u') + e u, with the parabolas exact and with what they miss."""
    c = outputs(8, constant=True)
    turn = 0.5 * np.ones(M)
    slope = 3.0 * np.ones(M)
    still = replace(c, h=np.full(M, 1e-9))  # so short that x and u are numbers
    x = np.full((M, 3), 1.44)
    u = np.repeat(turn[:, None], 2, axis=1)
    exact = 1.2 * (2 * c.b[:, 0] * 0.5 + c.a[:, 0] * 3.0) + c.e[:, 0] * 0.5
    found = RATE[0] * output_bounds._rates(still, x, u, slope, ())
    np.testing.assert_allclose(found[:, 0], np.abs(exact)[:, 0])
    # slopes of a, b, e, c over a part of width 2: b' x, a' u, e' x, c'
    sloped = replace(c, h=np.full(M, 2.0))
    for name, factor in (("a", 1.2 * 0.5), ("b", 1.2 * 1.44), ("e", 1.44), ("c_high", 1.2)):
        zero = {k: np.zeros_like(c.a) for k in ("a", "b", "e", "c_high", "c_low")}
        line = np.repeat(np.array([-1.0, 0.0, 1.0])[None, :, None], M, axis=0) * np.ones(K)
        given = zero | {name: line} | ({"c_low": line} if name == "c_high" else {})
        one = replace(sloped, **given)
        found = RATE[0] * output_bounds._rates(one, x, u, slope, ())[:, 0]
        largest = factor + {"a": 1.2 * 3.0, "b": 1.2 * 2 * 0.5, "e": 0.5}.get(name, 0.0)
        np.testing.assert_allclose(found, largest)
    # a derivative of what is missed: 6.2 of it over half the width
    assert pytest.approx(6.2, abs=0.05) == output_bounds._DERIVATIVE
    rest = np.random.default_rng(9).uniform(0.1, 1.0, (4, M, K))
    odd = replace(sloped, remainder=rest)
    r_a, r_b, r_e, _ = rest[:, :, 0]
    s_a, s_b, s_e, s_c = output_bounds._DERIVATIVE * rest[:, :, 0]
    missed = 1.2 * ((s_a + 2 * r_b) * 0.5 + 3.0 * r_a + s_b * 1.44 + s_c) + r_e * 0.5 + s_e * 1.44
    found = RATE[0] * output_bounds._rates(odd, x, u, slope, ())[:, 0]
    np.testing.assert_allclose(found, np.abs(exact[:, 0]) + missed)


def test_a_viscous_term_by_the_distance_of_its_speed_from_the_middle_one() -> None:
    """e u alone: over sqrt(x) it is e u / r in the middle and departs by e u (1/sqrt(low) - 1/r);
    the tangent of 1/sqrt(x) is lowest where x is largest."""
    c = outputs(13, constant=True)
    nothing = np.zeros_like(c.a)
    only = replace(c, a=nothing, b=nothing, c_high=nothing, c_low=nothing)
    u = np.tile([0.3, -0.6], (M, 1))
    x = np.tile([0.64, 0.9, 1.44], (M, 1))
    r = np.sqrt(1.04)
    size = np.abs(c.e[:, 0, 0]) * 0.6
    line = 1.5 / r - 1.44 / (2 * r**3)
    found = RATE[0] * output_bounds._rates(only, x, u, np.zeros(M), ())[:, 0]
    np.testing.assert_allclose(found, size * (1 / r + 1 / 0.8 - 1 / r) / line)


def test_what_is_missed_of_the_torque_counts_at_the_largest_turn() -> None:
    c = outputs(14, constant=True)
    rest = np.random.default_rng(17).uniform(0.1, 1.0, (4, M, K))
    u = np.tile([0.0, -0.8], (M, 1))
    x = np.full((M, 3), 1.0)
    more = output_bounds._values(replace(c, remainder=rest), None, x, u, ())
    plain = output_bounds._values(c, None, x, u, ())
    missed = 0.8 * rest[0] + rest[1] + rest[2] + rest[3]
    np.testing.assert_allclose(LIMIT * (more - plain), missed)


def test_rates_at_an_end_are_the_sum_of_the_largest_terms() -> None:
    c = replace(outputs(10), remainder=np.random.default_rng(11).uniform(0, 1, (4, M, K)))
    x = np.full((M, 3), 0.64)
    u = np.full((M, 2), 0.5)
    u[0] = [0.0, 0.9]
    u[-1] = [-0.7, 0.0]
    slope = np.full(M, 2.0)
    found = RATE[0] * output_bounds._rates(c, x, u, slope, (0, -1))[:, 0]
    for end, turn in ((0, 0.9), (-1, 0.7)):
        miss = c.remainder[:, end, 0]
        size = [np.abs(f[end, :, 0]).max() + m for f, m in zip((c.a, c.b, c.e), miss, strict=False)]
        half = c.h[end] / 2
        slopes = [
            np.abs(np.diff(f[end, :, 0]) / half).max() + output_bounds._DERIVATIVE * m / half
            for f, m in zip((c.a, c.b, c.e, c.c_high), miss, strict=True)
        ]
        a, b, e = size
        p, q, s, t = slopes
        expected = 0.8 * ((p + 2 * b) * turn + a * 2.0 + q * 0.64 + t) + e * turn + s * 0.64
        np.testing.assert_allclose(found[end], expected)


def test_a_motion_that_nearly_stops_in_a_part_has_no_bound_of_its_rate() -> None:
    """The tangent of 1/sqrt(x) is positive up to three times the middle of the range."""
    c = outputs(12, constant=True)
    u = np.zeros((M, 2))
    for largest, known in ((2.9, True), (1e9, False)):
        x = np.full((M, 3), 1.0)
        x[:, 2] = largest
        found = output_bounds._rates(c, x, u, np.ones(M), ())
        assert np.isfinite(found[:, 0]).all() or not known


@pytest.mark.parametrize("irregular", [False, True])
def test_speeds_and_what_has_no_bound(irregular: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two axes that move by 0.5 rad and not at all in a metre; effects without a form leave the
    torque without a bound, and its rate where it has a limit."""
    c = outputs(18)
    _, u, slope = motion(c, 19)
    x = np.full((M, 3), 1.44)
    cells = SimpleNamespace(speed=np.tile([0.5, 0.0], (M, 3, 1)), added=None)
    monkeypatch.setattr(output_bounds, "enclose", lambda dynamics, path, s: cells)
    given = SimpleNamespace(of=lambda *_: c)
    monkeypatch.setattr(output_bounds, "ConstrainedOutputs", given)
    moved: Any = SimpleNamespace(x=x, u=u, slope=slope, s=np.arange(M + 1.0))
    limits: Any = SimpleNamespace(qd_max=np.array([2.0, 3.0]))
    dynamics: Any = SimpleNamespace(n=1, friction=None, irregular=irregular)
    path: Any = None
    found = output_bounds._ratios(moved, path, limits, dynamics, ())
    np.testing.assert_allclose(found.speed[:, 0], 0.5 * 1.2 / 2.0)
    np.testing.assert_array_equal(found.speed[:, 1], 0.0)
    np.testing.assert_array_equal(np.isinf(found.value), [[irregular, False]] * M)
    np.testing.assert_array_equal(np.isinf(found.rate), [[irregular, False]] * M)


def test_how_fast_the_acceleration_may_build_up_and_for_how_long() -> None:
    """By the rate of the first output alone, until its limit or the speed that is asked for."""
    c = outputs(20, constant=True)
    c = replace(c, a=np.tile([-5.0, 2.0], (M, 3, 1)))
    jerk, time = c.building_up(np.full(M, 100.0))
    np.testing.assert_allclose(jerk, 300.0 / 5.0)
    np.testing.assert_allclose(time, 40.0 / 5.0 / 60.0)
    np.testing.assert_allclose(c.building_up(np.full(M, 1e-4))[1], np.sqrt(1e-2 / 60.0))


def ratios(value: Array, rate: Array | None = None, speed: Array | None = None) -> OutputRatios:
    nothing = np.zeros_like(value)
    return OutputRatios(
        np.arange(len(value) + 1.0),
        value,
        nothing if rate is None else rate,
        nothing if speed is None else speed,
    )


def test_what_is_above_a_limit_is_cut_and_where_asked_for_what_is_near_the_largest() -> None:
    value = np.array([[9.0, 0.0], [0.5, 0.1], [0.9, 0.2], [1.01, 0.3], [0.2, 0.99], [9.0, 0.0]])
    found = ratios(value)
    # never at the ends
    np.testing.assert_array_equal(found.to_cut(False), [0, 0, 0, 1, 0, 0])
    # above a limit also where something else is far above it
    np.testing.assert_array_equal(found.to_cut(True), [0, 0, 0, 1, 1, 0])
    inner = ratios(np.vstack([np.zeros(2), value[1:3], np.zeros(2)]))
    np.testing.assert_array_equal(inner.to_cut(False), [0, 0, 0, 0])
    # within some parts in a hundred of the largest of its kind: 0.9, and 0.2
    np.testing.assert_array_equal(inner.to_cut(True), [0, 0, 1, 0])
    fast = ratios(np.zeros((3, 1)), speed=np.array([[0.0], [1.1], [0.0]]))
    np.testing.assert_array_equal(fast.to_cut(False), [0, 1, 0])
    lost = ratios(np.zeros((3, 1)), rate=np.array([[0.0], [np.nan], [0.3]]))
    np.testing.assert_array_equal(lost.to_cut(False), [0, 1, 0])


def test_halves_take_the_place_of_a_part() -> None:
    whole = ratios(np.array([[1.0], [2.0], [3.0]]))
    halves = ratios(np.array([[1.5], [1.7]]), rate=np.array([[7.0], [8.0]]))
    s = np.array([0.0, 1.0, 1.5, 2.0, 3.0])
    found = whole.cut(np.array([False, True, False]), s, halves)
    np.testing.assert_array_equal(found.s, s)
    np.testing.assert_array_equal(found.value[:, 0], [1.0, 1.5, 1.7, 3.0])
    np.testing.assert_array_equal(found.rate[:, 0], [0.0, 7.0, 8.0, 0.0])


def test_the_largest_of_each_kind_and_where_the_torque_is() -> None:
    value = np.array([[0.1, 0.2, 0.7], [0.3, 0.9, 0.6], [0.4, 0.5, 0.8]])
    rate = np.array([[0.5, 0.1, 0.2], [0.1, 0.4, 0.3], [0.1, 0.1, 0.1]])
    found = ratios(value, rate, np.array([[0.2], [0.6], [0.1]])).checked(2)
    assert (found.torque_ratio, found.torque_at) == (0.9, (1.0, 2))
    assert (found.velocity_ratio, found.acceleration_ratio) == (0.6, 0.8)
    assert (found.torque_rate_ratio, found.jerk_ratio) == (0.5, 0.3)
    alone = ratios(value[:, :2], rate[:, :2]).checked(2)
    assert (alone.acceleration_ratio, alone.jerk_ratio) == (0.0, 0.0)
