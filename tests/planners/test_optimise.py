"""Free geometry: nothing violated between knots, way-points met, never worse than the warm start,
and it says so."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import numpy.typing as npt
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_move import joint_move
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import check
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.trajectory_optimisation.knot_coupling import Objective
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots
from irb2400_ctrl.planners.trajectory_optimisation.optimise_motion import _placed, optimise_motion
from irb2400_ctrl.planners.trajectory_optimisation.optimised import Optimised, path_margins
from irb2400_ctrl.planners.trajectory_optimisation.transcription import Transcription

Array = npt.NDArray[np.float64]
HOME = np.radians([0.0, -20.0, 10.0, 0.0, 60.0, 0.0])


def drawn(seed: int, count: int = 6) -> Array:
    return np.asarray(HOME + 0.5 * np.random.default_rng(seed).normal(size=(count, 6)))


@pytest.fixture(scope="module")
def robot() -> irb.Robot:
    return irb.load_robot("irb2400")


@pytest.fixture(scope="module")
def fast(robot: irb.Robot) -> Optimised:
    return optimise_motion(robot, drawn(5), intervals=100)


def keeps_limits_at_10_kHz(robot: irb.Robot, found: Optimised) -> None:
    rows = found.trajectory(irb.Model(robot), rate=1e4)
    assert (np.abs(rows.tau) / robot.tau_max).max() <= 1 + 1e-9
    assert (np.abs(rows.qd) / robot.qd_max).max() <= 1 + 1e-9
    assert (rows.q >= robot.q_min - 1e-9).all()
    assert (rows.q <= robot.q_max + 1e-9).all()
    assert np.abs(rows.qd[[0, -1]]).max() < 1e-9


def test_faster_than_the_fixed_spline_and_certified(robot: irb.Robot, fast: Optimised) -> None:
    assert not fast.fell_back
    assert fast.message.startswith("optimised")
    assert fast.ratio < 0.9
    # the certificate is checked again by itself, and by looking
    assert check(fast.motion.certificate, irb.Model(robot)).holds()
    keeps_limits_at_10_kHz(robot, fast)


def test_what_the_rows_ask_for_as_cubics_is_said_with_its_remedy(
    robot: irb.Robot, fast: Optimised
) -> None:
    """Rows that keep every limit, read as cubics, asked for 5 to 60 % more, and nothing said so."""
    model = irb.Model(robot)
    slow = optimise_motion(robot, drawn(5, 2), intervals=60, torque_rate=50 * robot.tau_max)
    for found in (fast, slow):
        rows = found.trajectory(model)
        read = JointPath.hermite(rows.time, rows.q, rows.qd)
        time = np.linspace(0.0, found.duration, 100_001)[1:-1]
        tau = model.inverse_dynamics(read(time), read(time, 1), read(time, 2))
        seen = (np.abs(tau) / robot.tau_max).max()
        assert seen <= found.torque_as_read * (1 + 1e-6)
        assert seen == pytest.approx(found.torque_as_read, rel=0.02)
        assert found.summary()["max_torque_ratio_as_read"] == found.torque_as_read
    assert fast.torque_as_read > 1.02
    assert f"ask for {100 * fast.torque_as_read:.0f} % of a torque limit" in fast.message
    assert "torque_rate=50 * robot.tau_max" in fast.message
    assert slow.torque_as_read < 1.01
    assert "cubics" not in slow.message


def test_way_points_are_met_in_order(fast: Optimised) -> None:
    _, q, _, _ = fast.motion.certificate.law.motion(
        fast.motion.certificate.path, fast.waypoint_time
    )
    assert np.abs(q - fast.waypoints).max() < 1e-6
    assert (np.diff(fast.waypoint_time) > 0).all()
    assert fast.waypoint_time[-1] == pytest.approx(fast.duration)


def test_peak_torque_and_energy_are_those_of_the_motion(robot: irb.Robot, fast: Optimised) -> None:
    rows = fast.trajectory(irb.Model(robot), rate=1e4)
    seen = np.abs(rows.tau).max(axis=0)
    assert (seen <= fast.motion.peak_torque * (1 + 1e-9)).all()
    assert fast.motion.peak_torque == pytest.approx(seen, rel=0.05)
    power = np.maximum(rows.tau * rows.qd, 0.0)
    energy = (np.diff(rows.time)[:, None] * (power[1:] + power[:-1]) / 2).sum(axis=0)
    assert fast.motion.energy == pytest.approx(energy, rel=0.01)
    # drives give what friction and the net work of gravity take (nothing, between rests at equal
    # heights)
    assert fast.motion.energy.sum() > 0


def test_least_energy_within_the_same_duration(robot: irb.Robot) -> None:
    found = optimise_motion(robot, drawn(2, 3), objective="energy", intervals=60)
    assert not found.fell_back
    assert found.reference is not None
    assert found.duration <= found.reference.duration * (1 + 1e-9)
    assert found.motion.energy.sum() < 0.95 * found.reference.energy.sum()
    keeps_limits_at_10_kHz(robot, found)


def test_torque_rate_is_kept_and_the_start_has_no_jump(robot: irb.Robot) -> None:
    limit = 20 * robot.tau_max
    free = optimise_motion(robot, drawn(2, 3), intervals=60)
    found = optimise_motion(robot, drawn(2, 3), torque_rate=limit, intervals=60)
    assert (free.motion.torque_rate > limit).any()
    assert (found.motion.torque_rate <= limit * (1 + 1e-6)).all()
    # bounded at every instant, and checked again from the certificate alone
    assert found.motion.guaranteed
    assert 0 < check(found.motion.certificate, irb.Model(robot)).torque_rate_ratio <= 1
    assert free.duration < found.duration < 1.1 * free.duration
    # the fixed spline keeps the same limit
    assert found.reference is not None
    assert found.reference.checked.torque_rate_ratio <= 1
    assert found.ratio < 0.95
    rows = found.trajectory(irb.Model(robot), rate=1e4)
    assert np.abs(rows.qdd[0]).max() < 1e-6
    keeps_limits_at_10_kHz(robot, found)


@pytest.mark.slow
def test_the_torque_rate_of_the_robot_file_is_kept(robot: irb.Robot) -> None:
    most = 20 * robot.tau_max
    # the first axis states none
    joints = [
        joint.model_copy(
            update={"limits": joint.limits.model_copy(update={"torque_rate_Nm_s": rate})}
        )
        for joint, rate in zip(robot.joints, [None, *most[1:].tolist()], strict=True)
    ]
    limited = robot.model_copy(update={"joints": tuple(joints)})
    found = optimise_motion(limited, drawn(2, 3), intervals=40)
    assert (found.motion.torque_rate[1:] <= most[1:] * (1 + 1e-6)).all()
    assert found.motion.torque_rate[0] > most[0]
    assert found.motion.guaranteed
    # what is asked for can only be less
    both = optimise_motion(limited, drawn(2, 3), torque_rate=2 * most, intervals=40)
    assert (both.motion.torque_rate[1:] <= most[1:] * (1 + 1e-6)).all()
    keeps_limits_at_10_kHz(robot, found)


@pytest.mark.slow
def test_any_warm_start_ends_at_the_same_duration(robot: irb.Robot) -> None:
    W = drawn(2, 4)
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(W, axis=0)).max(axis=1))])
    found = [
        optimise_motion(robot, W, start=JointPath.through(s, W)) for s in (np.arange(4.0), way)
    ]
    assert found[0].reference is not None
    assert found[1].reference is not None
    assert abs(found[0].reference.duration / found[1].reference.duration - 1) > 0.03
    assert found[0].duration == pytest.approx(found[1].duration, rel=3e-3)


def test_nothing_goes_zigzag_between_the_knots_of_least_energy(robot: irb.Robot) -> None:
    model = path_dynamics(robot).model
    W = drawn(2, 3)
    found = optimise_motion(robot, W, objective="energy", intervals=60)
    path = found.motion.certificate.path

    def energy(time: Array) -> float:
        tau = model.inverse_dynamics(path(time), path(time, 1), path(time, 2))
        power = np.maximum(tau * path(time, 1), 0.0).sum(axis=1)
        return float((np.diff(time) * (power[1:] + power[:-1]) / 2).sum())

    assert energy(path.knots) == pytest.approx(
        energy(np.linspace(0.0, path.knots[-1], 5001)), rel=0.05
    )


def test_speed_is_kept_between_knots(robot: irb.Robot) -> None:
    limits = MotionLimits.of(robot)
    W = drawn(5)[:3]
    cubic = JointPath.through(np.array([0.0, 2.0, 4.0]), W)
    time = np.linspace(0.0, 4.0, 81)
    guess = Knots(time, cubic(time), cubic(time, 1), cubic(time, 2))
    solved = Transcription(path_dynamics(robot).model, limits, W, (40, 40)).solve(guess, 60.0)
    assert solved.converged
    k = solved.knots
    h = np.diff(solved.knots.time)[:, None]
    for part in np.linspace(0.0, 1.0, 11):
        speed = k.qd[:-1] + part * h * (k.qdd[:-1] + part / 2 * np.diff(k.qdd, axis=0))
        assert (np.abs(speed) / limits.qd_max).max() <= 1 + 1e-4


def test_a_place_without_timing_is_named_by_its_way_points() -> None:
    knots = Knots(np.linspace(0.0, 4.0, 21), *np.zeros((3, 21, 6)))
    assert (
        _placed(InfeasiblePointError(2.3, " no way; round it"), knots, (10, 10))
        == "between way-points 2 and 3 no way"
    )
    assert _placed(InfeasibleError("no"), knots, (10, 10)) == "no"


def test_margin_holds_between_knots(robot: irb.Robot) -> None:
    # both ends bend the wrist well; the straight way between them does so less than is asked for
    W = HOME + np.array([[0.0, -0.2, 0.3, 0.0, 0.0, 0.0], [1.2, 0.5, -0.3, 0.5, 0.0, 0.0]])
    model = irb.Model(robot)
    free = optimise_motion(robot, W, intervals=40)
    asked = free.motion.margins["wrist"] + 0.3 * (np.sin(W[0, 4]) - free.motion.margins["wrist"])
    assert asked > free.motion.margins["wrist"]
    found = optimise_motion(robot, W, margins={"wrist": asked}, intervals=40)
    assert found.motion.margins["wrist"] >= asked
    q = found.motion.certificate.path(np.linspace(0, found.motion.certificate.path.knots[-1], 3001))
    assert np.abs(np.sin(q[:, 4])).min() >= asked
    assert path_margins(model, found.motion.certificate.path)["wrist"] >= asked


def test_joint_box_holds_everywhere_at_a_way_point_on_its_edge(robot: irb.Robot) -> None:
    W = np.array([HOME, HOME + 0.3, HOME])
    W[1, 2] = robot.q_max[2]
    found = optimise_motion(robot, W, intervals=60)
    q = found.motion.certificate.path(np.linspace(0, found.motion.certificate.path.knots[-1], 5001))
    assert q[:, 2].max() <= robot.q_max[2] + 1e-9


def test_warm_start_from_a_joint_move(robot: irb.Robot) -> None:
    W = drawn(4, 2)
    move = joint_move(irb.Model(robot), W[0], W[1])
    found = optimise_motion(robot, W, start=move, intervals=40)
    assert found.reference is not None
    assert found.duration <= found.reference.duration * (1 + 1e-9)
    assert found.duration < move.duration


def test_without_iterations_the_warm_start_comes_back_and_says_so(robot: irb.Robot) -> None:
    found = optimise_motion(robot, drawn(5), intervals=100, iterations=0)
    assert found.fell_back
    assert found.message.startswith("fell back to the warm start")
    assert found.solver_status == "Maximum_Iterations_Exceeded"
    assert found.solver_status in found.message
    assert found.iterations == 0
    assert found.ratio == pytest.approx(1.0)
    keeps_limits_at_10_kHz(robot, found)


def test_no_motion_at_all_is_an_error_with_both_reasons(robot: irb.Robot) -> None:
    with pytest.raises(InfeasibleError, match=r"IPOPT.*warm start"):
        optimise_motion(robot, drawn(2, 3), duration=0.05, intervals=40)


@pytest.mark.parametrize("objective", ["time", "energy"])
def test_too_short_a_duration_is_held_against_the_fastest_motion(
    robot: irb.Robot, objective: Objective
) -> None:
    # IPOPT took minutes to prove that none is as fast
    fastest = optimise_motion(robot, drawn(2, 3), intervals=40)
    asked = 0.97 * fastest.duration
    found = f"Solve_Succeeded.*its motion: {fastest.duration:.3f} s are longer than {asked:.3f} s"
    with pytest.raises(InfeasibleError, match=found):
        optimise_motion(robot, drawn(2, 3), objective=objective, duration=asked, intervals=40)


def test_a_motion_is_one_line_at_a_prompt(robot: irb.Robot) -> None:
    found = optimise_motion(robot, drawn(2, 3), intervals=40, iterations=0)
    assert found.message in repr(found)
    assert len(repr(found)) < len(found.message) + 100
    assert len(repr(found.motion)) < 100


def test_derivatives_of_a_knot_match_casadi_and_differences(robot: irb.Robot) -> None:
    model = path_dynamics(robot).model
    W = drawn(1, 2)
    limits = MotionLimits.of(robot)
    program = Transcription(
        model, limits, W, (10,), "energy", margins=((0, 0.1),), torque_rate=robot.tau_max
    )
    interpreted = replace(program, compiled=False)
    rng = np.random.default_rng(0)
    y = np.concatenate([W[0], rng.uniform(-0.5, 0.5, 12)])
    weights = rng.normal(size=program._knot.numel_out(0))
    p = np.concatenate([0.04 * robot.qd_max, rng.uniform(5.0, 50.0, 6)])
    machine = [np.asarray(ca.DM(v)) for v in program._knot_derivatives(y, p, weights)]
    for one, other in zip(machine, interpreted._knot_derivatives(y, p, weights), strict=True):
        assert one == pytest.approx(np.asarray(ca.DM(other)), rel=1e-9, abs=1e-9)
    step = 1e-6
    for j in range(18):
        d = step * np.eye(18)[j]
        slope = (np.asarray(program._knot(y + d, p)) - np.asarray(program._knot(y - d, p)))[
            :, 0
        ] / (2 * step)
        assert machine[1][:, j] == pytest.approx(slope, rel=1e-5, abs=1e-6)
        gradients = [
            np.asarray(ca.DM(program._knot_derivatives(y + k * d, p, weights)[1])).T @ weights
            for k in (1, -1)
        ]
        full = machine[2] + np.triu(machine[2], 1).T
        assert full[:, j] == pytest.approx(
            (gradients[0] - gradients[1]) / (2 * step), rel=1e-4, abs=1e-4
        )


@pytest.mark.parametrize(
    ("change", "options", "match"),
    [
        (lambda W: W[:1], {}, "expected two"),
        (lambda W: W[:, :5], {}, "expected two"),
        (lambda W: np.vstack([W[0], W[0]]), {}, "the same"),
        (lambda W: np.vstack([W[0], W[0] + 9.0]), {}, "way-point 2"),
        (lambda W: W, {"margins": {"wirst": 0.1}}, "wrist"),
        (lambda W: W, {"margins": {"wrist": 0.999}}, "way-point 1"),
        (lambda W: W, {"torque_rate": -1.0}, "torque_rate"),
        (lambda W: W, {"duration": 0.0}, "duration"),
        (
            lambda W: W,
            {"start": JointPath.through(np.array([0.0, 1.0]), drawn(9, 2))},
            "start passes",
        ),
    ],
)
def test_wrong_requests_are_named(
    robot: irb.Robot, change: object, options: dict[str, object], match: str
) -> None:
    assert callable(change)
    with pytest.raises(InputError, match=match):
        optimise_motion(robot, change(drawn(2, 3)), **options)  # type: ignore[arg-type]


def test_no_clock_decides_the_answer(robot: irb.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [optimise_motion(robot, drawn(5), intervals=40, iterations=15) for _ in range(2)]
    # as if the machine were a million times slower
    ticks = iter(range(0, 10**12, 10**6))
    monkeypatch.setattr("time.perf_counter", lambda: float(next(ticks)))
    found.append(optimise_motion(robot, drawn(5), intervals=40, iterations=15))
    assert found[0].iterations <= 15
    assert len({f.duration for f in found}) == 1
    assert len({f.iterations for f in found}) == 1
