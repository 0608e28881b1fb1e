"""The torque bound holds at every instant, costs next to nothing, and can be checked without the
solver."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from spline_paths import random_path

from irb2400_ctrl import load_robot
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Certificate, MotionLimits, check
from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.complex_disc import disc_function
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing import time_optimal
from irb2400_ctrl.planners.timing.motion_limits import speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.two_pass import Passed, two_pass

ROBOT = load_robot("irb2400")
DYNAMICS = path_dynamics(ROBOT)
LIMITS = MotionLimits.of(ROBOT)
# torque by another door than the coefficients: the model's own inverse dynamics
TORQUE = compile_function(DYNAMICS.model.function("inverse_dynamics"))


def worst_ratio(path: JointPath, law: TimeLaw, rate: float = 1e4) -> float:
    time = np.arange(0.0, law.duration, 1 / rate)
    _, q, qd, qdd = law.motion(path, time)
    (tau,) = TORQUE.map(q, qd, qdd, np.zeros(1))
    return float((np.abs(tau) / LIMITS.tau_max).max())


SEEDS = [range(60), pytest.param(range(60, 200), marks=pytest.mark.slow)]


@pytest.mark.parametrize("seeds", SEEDS, ids=["few", "many"])
def test_no_violation_at_10_khz_on_random_paths(seeds: range) -> None:
    speeds = []
    for seed in seeds:
        path = random_path(seed, points=4 + seed % 5)
        timed, _ = time_joint_path(DYNAMICS, path, LIMITS)
        assert worst_ratio(path, timed) <= 1.0
        first = path(timed.s, 1)
        speeds.append((np.abs(first) * np.sqrt(timed.x)[:, None] / LIMITS.qd_max).max())
    assert max(speeds) <= 1 + 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_certificate_is_checked_without_the_solver(seed: int) -> None:
    path = random_path(seed)
    timed, _ = time_joint_path(DYNAMICS, path, LIMITS)
    checked = check(Certificate(path, timed, LIMITS), DYNAMICS.model)
    assert checked.holds()
    assert worst_ratio(path, timed) <= checked.torque_ratio
    # the bound is sharp, and a faster motion is caught
    assert checked.torque_ratio > 0.999
    faster = PiecewiseConstantLaw(timed.s.copy(), 1.001 * timed.x)
    assert not check(Certificate(path, faster, LIMITS), DYNAMICS.model).holds()


@pytest.mark.parametrize("seed", range(3))
def test_no_further_pass_gains_more_than_is_let_go(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = random_path(seed)
    passes: list[object] = []

    def counted(*arguments: Any) -> Passed:
        passes.append(arguments)
        return two_pass(*arguments)

    monkeypatch.setattr(time_optimal, "two_pass", counted)
    ended, _ = time_joint_path(DYNAMICS, path, LIMITS)
    fewer = len(passes)
    monkeypatch.setattr(time_optimal, "_GAIN", -np.inf)
    all_passes, _ = time_joint_path(DYNAMICS, path, LIMITS)
    assert len(passes) - fewer > fewer
    assert ended.duration < 1.0003 * all_passes.duration


@pytest.mark.parametrize("seed", range(4))
def test_the_check_says_which_axis_needs_most_and_where(seed: int) -> None:
    path = random_path(seed)
    timed, _ = time_joint_path(DYNAMICS, path, LIMITS)
    slower = PiecewiseConstantLaw(timed.s.copy(), 0.6 * timed.x)
    checked = check(Certificate(path, slower, LIMITS), DYNAMICS.model)
    place, axis = checked.torque_at
    s, q, qd, qdd = slower.motion(path, np.arange(0.0, slower.duration, 1e-4))
    (tau,) = TORQUE.map(q, qd, qdd, np.zeros(1))
    near = np.abs(s - place) <= 2 * np.diff(slower.s).max()
    needed = (np.abs(tau[near]) / LIMITS.tau_max).max(axis=0)
    assert np.argmax(needed) == axis - 1
    assert needed[axis - 1] > 0.99 * checked.torque_ratio


@pytest.mark.parametrize(("lean", "needs"), [(40, 385), (-40, 383)])
def test_an_axis_that_cannot_hold_the_arm_either_way_is_named(lean: float, needs: float) -> None:
    """Gravity pulls axis 2 forwards or backwards; the largest of the way is said."""
    W = np.radians([[0, lean, 0, 0, 30, 0], [5, lean + 2, 0, 0, 30, 0]])
    held = np.abs(DYNAMICS.model.gravity(W)[:, 1]).max() + ROBOT.friction[1, 1]
    assert held == pytest.approx(needs, abs=60)
    weak = replace(LIMITS, tau_max=LIMITS.tau_max * [1, 0.05, 1, 1, 1, 1])
    with pytest.raises(InfeasibleError, match=rf"axis 2 cannot hold the arm: needs {needs} of 65"):
        time_joint_path(DYNAMICS, JointPath.through(np.array([0.0, 1.0]), W), weak)


def test_certificates_of_one_arm_share_its_coefficients(monkeypatch: pytest.MonkeyPatch) -> None:
    certificates = []
    for seed in (0, 1):
        path = random_path(seed)
        timed, _ = time_joint_path(DYNAMICS, path, LIMITS)
        certificates.append(Certificate(path, timed, LIMITS))
    made = []
    monkeypatch.setattr(
        sys.modules[PathDynamics.__module__],
        "disc_function",
        lambda fn: made.append(fn.name()) or disc_function(fn),
    )
    loaded = ROBOT.with_effects(LIBRARY["payload"].of(None, mass_kg=5.0))
    for robot in (ROBOT, loaded):
        # one of its own: nothing of it is there yet
        arm = Model(robot)
        assert [check(c, arm).holds() for c in certificates] == [robot is ROBOT] * 2
    assert made == ["coefficients"] * 2


@pytest.mark.parametrize("seed", range(4))
def test_as_fast_as_toppra_on_the_same_physics(seed: int) -> None:
    pytest.importorskip("toppra")
    from irb2400_ctrl.planners.timing.toppra_timing import time_with_toppra

    path = random_path(seed)
    timed, _ = time_joint_path(DYNAMICS, path, LIMITS)
    cells = enclose(DYNAMICS, path, grid(path, 1000))
    other = time_with_toppra(cells, LIMITS, ROBOT.friction)
    assert timed.duration <= 1.005 * other.duration


def test_the_guarantee_costs_less_than_a_thousandth_of_the_duration() -> None:
    path = random_path(3)
    durations = [
        time_joint_path(DYNAMICS, path, LIMITS, count=n)[0].duration for n in (250, 500, 1000, 4000)
    ]
    losses = np.array(durations[:3]) / durations[3] - 1
    assert losses[0] > losses[1] > losses[2] > 0
    assert losses[0] < 1e-3


def test_enclosure_holds_the_coefficients_between_the_grid_points() -> None:
    path = random_path(5)
    s = grid(path, 60)
    cells = enclose(DYNAMICS, path, s)
    for t in (0.11, 0.37, 0.73):
        at = s[:-1] + t * np.diff(s)
        piece = path.piece((s[:-1] + s[1:]) / 2)
        exact = DYNAMICS.coefficients(*(path.on_piece(at, piece, order) for order in (0, 1, 2)))
        weights = np.array([(1 - t) ** 2, 2 * t * (1 - t), t**2])
        for number, name in enumerate(("a", "b", "e")):
            parabola = np.einsum("k,mkn->mn", weights, getattr(cells, name))
            error = np.abs(parabola - exact[number])
            assert (error <= cells.remainder[number] + 1e-9).all()
    # coarse as the cells are, the parabolas are off by something: the bound is not empty
    assert cells.remainder[0].max() > 1e-6


def test_remainder_falls_with_the_third_power_of_the_cells() -> None:
    path = random_path(5)
    sizes = [
        np.median(enclose(DYNAMICS, path, grid(path, n)).remainder[0].max(axis=1))
        for n in (2000, 4000)
    ]
    assert 6 < sizes[0] / sizes[1] < 10


def test_no_joint_turns_back_inside_a_cell() -> None:
    path = random_path(8)
    cells = enclose(DYNAMICS, path, grid(path, 500))
    assert len(path.reversals()) > 3
    assert not (cells.forwards & cells.backwards).any()


def test_speed_bounds_hold_between_grid_points() -> None:
    path = random_path(2)
    s = grid(path, 40)
    cells = enclose(DYNAMICS, path, s)
    x = speed_bounds(cells, LIMITS.qd_max)
    fine = np.linspace(0, path.length, 20001)
    qd = path(fine, 1) * np.sqrt(np.interp(fine, s, x))[:, None]
    assert (np.abs(qd) / LIMITS.qd_max).max() <= 1 + 1e-9


def test_disc_radii_hold_for_complex_arguments() -> None:
    x = ca.SX.sym("x", 2)
    f = ca.sin(x[0]) * ca.cos(x[1]) ** 2 + x[0] / (2 + x[1]) - ca.sqrt(3 + x[0] * x[1])
    radius = disc_function(ca.Function("f", [x], [f]))

    def value(z: np.ndarray) -> complex:
        return complex(
            np.sin(z[0]) * np.cos(z[1]) ** 2 + z[0] / (2 + z[1]) - np.sqrt(3 + z[0] * z[1])
        )

    rng = np.random.default_rng(1)
    for _ in range(50):
        centre = rng.uniform(-1, 1, 2)
        r = rng.uniform(0, 0.3, 2)
        bound = float(radius(centre, r))
        offsets = r * np.exp(2j * np.pi * rng.uniform(size=(40, 2)))
        reached = max(abs(value(centre + d) - value(centre)) for d in offsets)
        assert reached <= bound
        assert bound < 20 * reached + 1e-12


def test_effects_of_the_robot_enter_the_bound() -> None:
    effects = [
        LIBRARY["rotor_inertia"].of(2, inertia_kgm2=8.0),
        LIBRARY["payload"].of(None, mass_kg=5.0),
        LIBRARY["gear_ripple"].of(3, amplitude_Nm=8.0, order=37.0),
    ]
    robot = ROBOT.with_effects(*effects)
    dynamics = PathDynamics(path_dynamics(robot).model)
    assert dynamics.irregular == ()
    path = random_path(1)
    timed, _ = time_joint_path(dynamics, path, LIMITS)
    bare, _ = time_joint_path(DYNAMICS, path, LIMITS)
    assert timed.duration > 1.01 * bare.duration
    time = np.arange(0.0, timed.duration, 1e-4)
    _, q, qd, qdd = timed.motion(path, time)
    assert (np.abs(dynamics.model.inverse_dynamics(q, qd, qdd)) <= LIMITS.tau_max).all()


def test_infeasible_names_place_axis_and_torque() -> None:
    weak = replace(LIMITS, tau_max=np.array([1300, 40.0, 700, 140, 150, 60]))
    with pytest.raises(
        InfeasibleError,
        match=r"at \d+\.\d mm, axis 2 cannot hold the arm: needs [\d,]+ of 40 Nm; .*torque share",
    ):
        time_joint_path(DYNAMICS, random_path(0), weak)


def test_an_axis_that_static_friction_keeps_from_setting_off_is_named() -> None:
    """Another axis, with torque left, was named as the closest: only Coulomb's part was counted."""
    path = random_path(0)
    gravity = np.abs(DYNAMICS.model.gravity(path(np.linspace(0.0, path.length, 400)))[:, 4])
    static, coulomb = ROBOT.friction[4, :2]
    limit = gravity.max() + coulomb + 1.0
    assert gravity[0] + static > limit
    weak = replace(LIMITS, tau_max=np.array([1300, 1300, 700, 140, limit, 60]))
    says = rf"axis 5 cannot set off or turn back: .* needs \d+ of {limit:.0f} Nm; .*torque share"
    with pytest.raises(InfeasibleError, match=says):
        time_joint_path(DYNAMICS, path, weak)


def test_acceleration_limit() -> None:
    limited = replace(LIMITS, qdd_max=np.full(6, 4.0))
    path = random_path(4)
    timed, _ = time_joint_path(DYNAMICS, path, limited)
    time = np.arange(0.0, timed.duration, 1e-4)
    _, _, _, qdd = timed.motion(path, time)
    assert np.abs(qdd).max() <= 4.0
    # forwards and backwards
    assert min(qdd.max(), -qdd.min()) > 3.99


@pytest.mark.parametrize("count", [200, 400, 1000, 1500])
def test_comes_to_rest_on_any_grid(count: int) -> None:
    # at rest the speed that may be left is zero, and rounding of the cell before must not read as
    # "stuck"
    rng = np.random.default_rng(1)
    for _ in range(4):
        path = JointPath.through(np.linspace(0.0, 1.0, 6), rng.uniform(-1.0, 1.0, (6, 6)))
        timed, _ = time_joint_path(DYNAMICS, path, LIMITS, count=count)
        assert timed.x[-1] == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_peaks_of_each_axis_hold_and_are_close(seed: int) -> None:
    path = random_path(seed)
    law = time_joint_path(DYNAMICS, path, LIMITS)[0]
    time = np.arange(0.0, law.duration, 1e-4)
    _, q, qd, qdd = law.motion(path, time)
    (tau,) = TORQUE.map(q, qd, qdd, np.zeros(1))
    seen = np.abs(tau).max(axis=0)
    peaks = law.peaks(path, LIMITS, DYNAMICS)
    assert (seen <= peaks.torque).all()
    assert (peaks.torque < 1.05 * seen).all()
    assert peaks.torque_rate_ratio == 0.0
