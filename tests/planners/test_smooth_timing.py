"""Torque rate and jerk stay below their limits at every instant, rest to rest, at the price of a
fine reference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from smooth_reference import reference_duration
from spline_paths import random_path

from irb2400_ctrl import load_robot
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners import Certificate, MotionLimits, check
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited.cell_motion import refined_grid
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import output_ratios
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path

ROBOT = load_robot("irb2400")
DYNAMICS = path_dynamics(ROBOT)
LIMITS = MotionLimits.of(ROBOT)
# torque by another door than the coefficients: the model's own inverse dynamics, with and without
# friction
TORQUE = compile_function(DYNAMICS.model.function("inverse_dynamics"))
SMOOTH_TORQUE = compile_function(DYNAMICS.model.function("inverse_dynamics_without_friction"))


def rated(per_second: float) -> MotionLimits:
    """Torque rates as multiples of the torque limits."""
    return replace(LIMITS, torque_rate=per_second * LIMITS.tau_max)


def seen(path: JointPath, law: RateLimitedLaw, rate: float = 1e4) -> dict[str, np.ndarray]:
    """Peaks over all samples, and torque without dry friction at the samples."""
    time = np.append(np.arange(0.0, law.duration, 1 / rate), law.duration)
    _, q, qd, qdd = law.motion(path, time)
    (tau,) = TORQUE.map(q, qd, qdd, np.zeros(1))
    (smooth,) = SMOOTH_TORQUE.map(q, qd, qdd, np.zeros(1))
    smooth = smooth + ROBOT.friction[:, 2] * qd
    dt = np.diff(time)[:, None]
    return {
        "torque": np.abs(tau).max(axis=0),
        "speed": np.abs(qd).max(axis=0),
        "acceleration": np.abs(qdd).max(axis=0),
        "torque rate": np.abs(np.diff(smooth, axis=0) / dt).max(axis=0),
        "jerk": np.abs(np.diff(qdd, axis=0) / dt).max(axis=0),
        "smooth": smooth,
        "qdd": qdd,
    }


@pytest.fixture(scope="module")
def timed() -> RateLimitedLaw:
    return time_rate_limited(DYNAMICS, random_path(0), rated(20))


# one path at each rate
SEEDS = [range(4), pytest.param(range(4, 50), marks=pytest.mark.slow)]


@pytest.mark.parametrize("seeds", SEEDS, ids=["few", "many"])
def test_no_violation_at_10_khz_on_random_paths(seeds: range) -> None:
    for seed in seeds:
        path = random_path(seed)
        limits = rated((5, 10, 20, 50)[seed % 4])
        law = time_rate_limited(DYNAMICS, path, limits, count=250)
        peaks = seen(path, law)
        assert (peaks["torque"] <= limits.tau_max).all()
        assert (peaks["speed"] <= limits.qd_max).all()
        # a difference of two torques is exact to about 1e-11 of them, over 0.1 ms
        assert limits.torque_rate is not None
        assert (peaks["torque rate"] <= limits.torque_rate * (1 + 1e-7)).all()
        assert check(Certificate(path, law, limits), DYNAMICS.model, DYNAMICS).holds()


def test_rest_to_rest_without_a_jump(timed: RateLimitedLaw) -> None:
    path = random_path(0)
    limits = rated(20)
    peaks = seen(path, timed)
    held = DYNAMICS.model.gravity(path(np.array([0.0, 1.0])))
    for end, place in ((0, 0), (-1, 1)):
        assert np.abs(peaks["qdd"][end]).max() < 1e-9
        np.testing.assert_allclose(peaks["smooth"][end], held[place], rtol=0, atol=1e-9)
    # and not a microsecond later either: the torque leaves from there at its rate
    assert limits.torque_rate is not None
    for time in (1e-9, 1e-6, 1e-5):
        for t in (time, timed.duration - time):
            _, q, qd, qdd = timed.motion(path, np.array([t]))
            start = held[0] if t < 1 else held[1]
            now = (
                DYNAMICS.model.inverse_dynamics(q, qd, qdd)
                - DYNAMICS.model.friction(qd)
                + ROBOT.friction[:, 2] * qd
            )
            assert (np.abs(now[0] - start) <= limits.torque_rate * time * (1 + 1e-6) + 1e-8).all()


def test_certificate_is_checked_without_the_solver(timed: RateLimitedLaw) -> None:
    path = random_path(0)
    limits = rated(20)
    checked = check(Certificate(path, timed, limits), DYNAMICS.model)
    assert checked.holds()
    peaks = seen(path, timed)
    assert (peaks["torque"] / limits.tau_max).max() <= checked.torque_ratio
    assert limits.torque_rate is not None
    ratio = (peaks["torque rate"] / limits.torque_rate).max()
    assert checked.torque_rate_ratio - 3e-3 <= ratio <= checked.torque_rate_ratio + 1e-7
    # the bounds are sharp, and a faster motion is caught by both
    assert checked.torque_ratio > 0.999
    assert checked.torque_rate_ratio > 0.999
    faster = check(Certificate(path, timed.slowed(0.998), limits), DYNAMICS.model)
    assert faster.torque_rate_ratio > 1
    assert faster.torque_ratio > 1


def test_numbers_that_are_no_motion_are_caught(timed: RateLimitedLaw) -> None:
    law = timed
    path = random_path(0)
    x = law.x.copy()
    x[300] *= 0.999
    assert not check(
        Certificate(path, RateLimitedLaw(law.s.copy(), x, law.u.copy()), rated(20)), DYNAMICS.model
    ).holds()
    u = law.u.copy()
    u[0] = 0.5
    assert not check(
        Certificate(path, RateLimitedLaw(law.s.copy(), law.x.copy(), u), rated(20)), DYNAMICS.model
    ).holds()
    # nor is a path whose second derivative jumps
    bent = path.coefficients.copy()
    bent[2, 2:] += 1e-3
    assert not check(
        Certificate(JointPath(path.knots.copy(), bent), law, rated(20)), DYNAMICS.model
    ).holds()


def test_law_is_its_own_integral(timed: RateLimitedLaw) -> None:
    law = timed
    time = np.linspace(0.0, law.duration, 400001)
    s, v, u = law.at(time)
    dt = time[1]
    assert np.abs(np.diff(s) / dt - (v[1:] + v[:-1]) / 2).max() < 1e-7
    assert np.abs(np.diff(v) / dt - (u[1:] + u[:-1]) / 2).max() < 1e-3
    # at the grid points it is where and as fast as it says
    s, v, u = law.at(law.time[:-1])
    np.testing.assert_allclose(s, law.s[:-1], atol=1e-12)
    np.testing.assert_allclose(v**2, law.x[:-1], rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(u, law.u[:-1], rtol=1e-7, atol=1e-9)
    # from the left, too
    s, v, u = law.at(law.time[1:] - 1e-12)
    np.testing.assert_allclose(s, law.s[1:], atol=1e-10)
    np.testing.assert_allclose(u, law.u[1:], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    ("seed", "rate"), [(0, 20.0), pytest.param(3, 10.0, marks=pytest.mark.slow)]
)
def test_duration_against_a_reference_of_another_kind(seed: int, rate: float) -> None:
    path = random_path(seed)
    limits = rated(rate)
    law = time_rate_limited(DYNAMICS, path, limits, count=100)
    reference = reference_duration(DYNAMICS, path, limits, law, 500)
    assert law.duration < 1.005 * reference
    assert law.duration > 0.999 * reference


def test_the_price_falls_with_the_rate_and_with_the_cells() -> None:
    path = random_path(2)
    found = [time_rate_limited(DYNAMICS, path, rated(r), count=250) for r in (5, 20, 200)]
    durations = [law.duration for law in found]
    assert (np.diff(durations) < 0).all()
    assert durations[-1] < 1.004 * time_joint_path(DYNAMICS, path, LIMITS)[0].duration
    counts = [time_rate_limited(DYNAMICS, path, rated(20), count=n).duration for n in (100, 1000)]
    assert counts[0] < 1.005 * counts[1]


def test_jerk_and_acceleration() -> None:
    path = random_path(4)
    limits = replace(LIMITS, jerk=np.full(6, 80.0), qdd_max=np.full(6, 6.0))
    law = time_rate_limited(DYNAMICS, path, limits)
    peaks = seen(path, law)
    assert peaks["jerk"].max() <= 80.0 * (1 + 1e-6)
    assert peaks["jerk"].max() > 79.5
    assert 5.97 < peaks["acceleration"].max() <= 6.0
    checked = check(Certificate(path, law, limits), DYNAMICS.model, DYNAMICS)
    assert checked.holds()
    assert checked.torque_rate_ratio == 0.0
    assert min(checked.jerk_ratio, checked.acceleration_ratio) > 0.995


def test_both_rates_on_a_part_of_the_joints() -> None:
    path = random_path(1)
    jerk = np.array([np.inf, 60.0, np.inf, np.inf, np.inf, 200.0])
    limits = replace(rated(30), jerk=jerk)
    law = time_rate_limited(DYNAMICS, path, limits)
    peaks = seen(path, law)
    assert (peaks["jerk"] <= jerk * (1 + 1e-6)).all()
    assert limits.torque_rate is not None
    assert (peaks["torque rate"] <= limits.torque_rate * (1 + 1e-7)).all()
    assert law.duration > time_rate_limited(DYNAMICS, path, rated(30)).duration


def test_points_of_a_grid_that_rounding_parts_count_once() -> None:
    path = random_path(0)
    s = np.unique(np.concatenate([path.knots, np.linspace(0.0, path.length, 101)]))
    exact = refined_grid(s, path)
    # the law's numbers went through other sums than the path's
    moved = s.copy()
    moved[1:-1] = np.nextafter(s[1:-1], np.inf)
    found = refined_grid(moved, path)
    assert len(found) == len(exact)
    assert np.diff(found).min() > 1e-10 * path.length
    assert np.abs(found - exact).max() < 1e-12 * path.length


def test_cells_that_are_cut_are_bounded_as_they_lie(timed: RateLimitedLaw) -> None:
    path = random_path(0)
    # half the rate it was made for: much is above
    found = timed.ratios(path, rated(10), DYNAMICS, 2)
    assert len(found.s) > 1.2 * len(timed.s)
    whole = output_ratios(timed.on_cells(found.s), path, rated(10), DYNAMICS)
    for part in ("value", "rate", "speed"):
        np.testing.assert_allclose(getattr(found, part), getattr(whole, part), 1e-6)


def test_feed_is_kept() -> None:
    path = random_path(5)
    law = time_rate_limited(DYNAMICS, path, rated(20), feed=lambda s: np.full(len(s) - 1, 0.15**2))
    time = np.linspace(0.0, law.duration, 20001)
    speed = law.at(time)[1].max()
    assert 0.1499 < speed <= 0.15


def test_what_cannot_be_is_said() -> None:
    weak = replace(rated(20), tau_max=np.array([1300, 40.0, 700, 140, 150, 60]))
    with pytest.raises(
        InfeasibleError, match=r"at \d+\.\d mm, axis 2 cannot hold the arm: needs [\d,]+ of 40 Nm"
    ):
        time_rate_limited(DYNAMICS, random_path(0), weak)
    slow = replace(LIMITS, torque_rate=1e-9 * LIMITS.tau_max)
    with pytest.raises(
        InfeasibleError,
        match=r"at \d+\.\d mm, axis \d would have to be slower .* torque rate of .* Nm/s",
    ):
        time_rate_limited(DYNAMICS, random_path(0), slow)
    with pytest.raises(InputError, match="neither torque_rate nor jerk"):
        time_rate_limited(DYNAMICS, random_path(0), LIMITS)
