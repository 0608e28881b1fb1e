"""The law of a motion without jumps: its times, places, polynomials and what makes it one."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited.cell_motion import (
    CellMotion,
    is_joined,
    refined_grid,
)
from irb2400_ctrl.planners.timing.rate_limited.hyperbolic_motion import arc, hyperbolic
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw

T = np.linspace(0.0, 1.0, 101)


def along(f: Array) -> Array:
    """Values of Bernstein coefficients in every part, shape (m, T, …)."""
    return np.einsum("tk,mk...->mt...", bernstein.basis(f.shape[1] - 1, T), f)


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
    for piece in range(4):
        # nothing follows the last piece, whose third derivative is its own affair
        for size, joined in ((1e-9, True), (1e-5, order == 3 and piece == 3)):
            bent = smooth.coefficients.copy()
            bent[order, piece, 1] += size
            assert is_joined(JointPath(smooth.knots.copy(), bent)) == joined


def test_knots_that_are_on_the_grid_but_for_rounding_are_not_added() -> None:
    s = np.array([0.0, 0.1, 0.3, 0.6, 0.8, 0.9])
    path: Any = SimpleNamespace(
        knots=np.array([0.0, 0.05, 0.3 + 1e-14, 0.45, 0.6 - 1e-14, 0.9]),
        reversals=lambda: np.array([0.45 + 1e-14, 0.7, 0.85]),
    )
    np.testing.assert_array_equal(refined_grid(s, path), [0.0, 0.1, 0.3, 0.45, 0.6, 0.7, 0.8, 0.9])


def test_a_law_that_is_none_has_no_bounds(law: RateLimitedLaw) -> None:
    wrong = replace(law, x=law.x + 1.0)
    nothing: Any = None
    found = wrong.bounds(nothing, nothing, nothing)
    assert found.torque_at == (0.0, 1)
    assert np.isinf([found.torque_ratio, found.velocity_ratio, found.jerk_ratio]).all()
