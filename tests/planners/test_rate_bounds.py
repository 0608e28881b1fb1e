"""Bounds of outputs and of their rates on parts of cells, against the sums by hand where nothing
varies and against what they bound where everything does; and the law of motion they are made
for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited import output_bounds
from irb2400_ctrl.planners.timing.rate_limited.cell_motion import CellMotion, is_joined
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.hyperbolic_motion import arc, hyperbolic
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw

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
    assert found.worst == 9.0
    # never at the ends
    np.testing.assert_array_equal(found.to_cut(False), [0, 0, 0, 1, 0, 0])
    inner = ratios(np.vstack([np.zeros(2), value[1:3], np.zeros(2)]))
    np.testing.assert_array_equal(inner.to_cut(False), [0, 0, 0, 0])
    # within some parts in a hundred of the largest of its kind: 0.9, and 0.2
    np.testing.assert_array_equal(inner.to_cut(True), [0, 0, 1, 0])
    fast = ratios(np.zeros((3, 1)), speed=np.array([[0.0], [1.1], [0.0]]))
    np.testing.assert_array_equal(fast.to_cut(False), [0, 1, 0])
    assert fast.worst == 1.1
    lost = ratios(np.zeros((3, 1)), rate=np.array([[0.0], [np.nan], [0.3]]))
    np.testing.assert_array_equal(lost.to_cut(False), [0, 1, 0])
    assert lost.worst == 0.3


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


@pytest.mark.parametrize("beta", [-4.0, -1e-3, -0.099, 0.0, 1e-3, 0.099, 4.0])
def test_motion_in_closed_form_is_that_of_an_integrator(beta: float) -> None:
    """s'' = u + beta s from 0 at 0.7 m/s: s = 0.7 S1 + u S2, v = 0.7 C + u S1."""
    time = np.linspace(0.0, 0.7, 8)
    u = 0.9
    found = solve_ivp(
        lambda t, z: [z[1], u + beta * z[0]],
        (0.0, 0.7),
        [0.0, 0.7],
        t_eval=time,
        rtol=1e-12,
        atol=1e-13,
    )
    C, S1, S2 = hyperbolic(np.full(8, beta), time)
    np.testing.assert_allclose(0.7 * S1 + u * S2, found.y[0], atol=1e-11)
    np.testing.assert_allclose(0.7 * C + u * S1, found.y[1], atol=1e-11)
    # and the time of a way: h / (v_i + v_{i+1}) = tanh(w t / 2) / w
    half = S2[1:] * u + S1[1:] * 0.7
    half = half / (0.7 + found.y[1][1:])
    np.testing.assert_allclose(2 * half * arc(beta * half**2), time[1:], rtol=1e-10)


@pytest.fixture(scope="module")
def law() -> RateLimitedLaw:
    """Up to speed, even, down again, with end cells of constant jerk: x_1 = 3 h u_1 / 2."""
    s = np.array([0.0, 0.1, 0.3, 0.6, 0.8, 0.9])
    u = np.array([0.0, 2.0, 1.0, -1.0, -2.0, 0.0])
    h = np.diff(s)
    x = np.zeros(6)
    x[1] = 1.5 * h[0] * u[1]
    for k in (1, 2, 3):
        x[k + 1] = x[k] + h[k] * (u[k] + u[k + 1])
    return RateLimitedLaw(s, x, u)


def test_a_law_is_consistent_only_with_its_own_numbers(law: RateLimitedLaw) -> None:
    assert law.is_consistent()
    for name, place, change in (
        ("x", 0, 1e-9), ("x", -1, 1e-9), ("u", 0, 1e-9), ("u", -1, -1e-9), ("x", 1, 1e-9),
        ("x", 4, 1e-9), ("x", 2, 1e-9), ("x", 3, -1e-9), ("u", 2, 1e-9), ("s", 2, 1e-9),
        ("s", 2, 0.4), ("u", 2, np.nan), ("x", 2, -9.0), ("x", 2, 1e-13),
    ):  # fmt: skip
        values = getattr(law, name).copy()
        values[place] += change
        assert replace(law, **{name: values}).is_consistent() == (change == 1e-13)
    short = RateLimitedLaw(law.s[:3].copy(), np.array([0.0, 0.3, 0.0]), np.zeros(3))
    assert not short.is_consistent()


def test_times_and_places_of_a_law_are_those_of_its_acceleration(law: RateLimitedLaw) -> None:
    v = np.sqrt(law.x)
    np.testing.assert_allclose(law.slope[1:-1], [-5.0, -2.0 / 0.3, -5.0])
    # at an end s = h (t / T)^3 passes h with 3 h / T
    np.testing.assert_allclose(law.time[1], 3 * 0.1 / v[1])
    np.testing.assert_allclose(law.time[-1] - law.time[-2], 3 * 0.1 / v[-2])
    for k in (1, 2, 3):
        # dt = ds / sqrt(x), by many small steps
        s = np.linspace(law.s[k], law.s[k + 1], 20001)
        x = law.on(s[1:-1])[0]
        assert np.all(x > 0)
        middle = law.on((s[1:] + s[:-1]) / 2)[0]
        np.testing.assert_allclose(
            law.time[k + 1] - law.time[k], (np.diff(s) / np.sqrt(middle)).sum(), rtol=1e-8
        )
    time = np.linspace(0.0, law.duration, 3001)
    s, speed, u = law.at(time)
    np.testing.assert_allclose(np.gradient(s, time)[1:-1], speed[1:-1], atol=2e-6)
    np.testing.assert_allclose(np.gradient(speed, time)[2:-2], u[2:-2], atol=2e-2)
    x, turn = law.on(s)
    inside = (s > law.s[1]) & (s < law.s[-2])
    np.testing.assert_allclose(x[inside], speed[inside] ** 2, rtol=1e-9)
    np.testing.assert_allclose(turn[inside], u[inside], rtol=1e-6, atol=1e-9)
    # at rest before and after, and nothing else there
    for t, place in ((-1.0, 0.0), (law.duration + 1.0, 0.9)):
        np.testing.assert_allclose(np.array(law.at(np.array([t])))[:, 0], [place, 0.0, 0.0])
    np.testing.assert_array_equal(law.on(law.s[[0, -1]]), np.zeros((2, 2)))


def test_the_largest_speed_of_a_cell_is_bounded_by_its_ends_and_its_slope(
    law: RateLimitedLaw,
) -> None:
    h = np.diff(law.s)
    ends = np.maximum(law.x[:-1], law.x[1:])
    tangent = law.x[:-1] + h * law.u[:-1]
    np.testing.assert_allclose(law.largest[1:-1], np.maximum(ends, tangent)[1:-1])
    np.testing.assert_allclose(law.largest[[0, -1]], law.x[[1, -2]])
    for k in (1, 2, 3):
        s = np.linspace(law.s[k], law.s[k + 1], 101)[:-1]
        assert law.on(s)[0].max() <= law.largest[k] + 1e-12


def test_a_slower_law_takes_as_many_times_as_long(law: RateLimitedLaw) -> None:
    slow = law.slowed(2.0)
    assert slow.is_consistent()
    np.testing.assert_allclose(slow.duration, 2 * law.duration)
    np.testing.assert_allclose(slow.u, law.u / 4)


def test_polynomials_of_a_law_on_parts_of_its_cells(law: RateLimitedLaw) -> None:
    s = np.array([0.0, 0.1, 0.15, 0.3, 0.4, 0.6, 0.8, 0.9])
    parts = law.on_cells(s)
    for k in range(1, 6):
        places = s[k] + T * (s[k + 1] - s[k])
        x, u = law.on(places[:-1])
        np.testing.assert_allclose(along(parts.x)[k, :-1], x, rtol=1e-12)
        np.testing.assert_allclose(along(parts.u)[k, :-1], u, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(parts.slope[1:-1], law.slope[[1, 1, 2, 2, 3]])
    # at the ends: the largest speed, u at both ends, and the jerk over the speed: for
    # s = h (t / T)^3 the jerk is 6 h / T^3, the speed 3 h / T
    for end, near, v in ((0, 1, np.sqrt(law.x[1])), (-1, -2, np.sqrt(law.x[-2]))):
        T_end = 3 * 0.1 / v
        np.testing.assert_allclose(parts.x[end], law.x[near])
        np.testing.assert_allclose(parts.slope[end], 6 * 0.1 / T_end**3 / v)
    np.testing.assert_allclose(parts.u[0], [0.0, 2.0])
    np.testing.assert_allclose(parts.u[-1], [-2.0, 0.0])
    some = parts.part(2, 4)
    assert isinstance(some, CellMotion)
    np.testing.assert_array_equal(some.s, s[2:5])
    np.testing.assert_array_equal(some.slope, parts.slope[2:4])


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_a_path_is_joined_up_to_its_second_derivative(order: int) -> None:
    smooth = JointPath.through(np.linspace(0.0, 1.0, 5), np.sin(np.arange(10.0)).reshape(5, 2))
    assert is_joined(smooth)
    for size, joined in ((1e-9, True), (1e-5, order == 3)):
        bent = smooth.coefficients.copy()
        bent[order, -1, 1] += size
        assert is_joined(JointPath(smooth.knots.copy(), bent)) == joined
