"""The closed loop: files, instruments, reproducibility, and that its step is fine enough."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from simulation.arms import START, STOP, arm, quintic_move, strong, with_effect, without_friction

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.simulation import (
    IDEAL_ACTUATORS,
    IDEAL_SENSORS,
    Actuators,
    Sensors,
    Simulation,
    make_loop,
    perturbed_robot,
    simulate,
)
from irb2400_ctrl.simulation.viscous_step import needed_substeps

MOVE = quintic_move(START, STOP, 1.2)


@pytest.fixture(scope="module")
def run() -> Simulation:
    return simulate(arm(), MOVE, "computed_torque", plant=perturbed_robot(arm(), 5), hold=0.2)


def test_tracks_within_a_millimetre(run: Simulation) -> None:
    assert 0 < run.tcp_error.max() < 1.5e-3
    assert run.contour_error.max() <= run.tcp_error.max() + 1e-12


def test_error_of_the_tool_is_the_distance_of_the_poses(run: Simulation) -> None:
    k = 700
    model = Model(arm())
    actual = model.tcp_pose(run.q[k])
    wanted = model.tcp_pose(run.q_ref[k])
    assert run.tcp_error[k] == pytest.approx(
        np.linalg.norm(actual[:3, 3] - wanted[:3, 3]), rel=1e-9
    )


def test_contour_error_forgives_being_late() -> None:
    from irb2400_ctrl.simulation.tracking import contour_errors

    s = np.linspace(0, 1, 501)
    path = np.column_stack([np.cos(s), np.sin(s), s])
    late = np.vstack([path[:10], path[:-10]])
    off = path + np.array([0, 0, 2e-3])
    assert contour_errors(path, late, 40).max() < 1e-9
    expected = 2e-3 * np.sqrt(0.5)  # the helix rises at 45 degrees
    np.testing.assert_allclose(contour_errors(path, off, 40)[50:-50], expected, rtol=1e-3)


def test_writes_the_log_of_the_contract(run: Simulation, tmp_path) -> None:
    log, summary = run.write(tmp_path)
    header, *rows = log.read_text().splitlines()
    names = header.split(",")
    assert names[:2] == ["time_s", "q1_deg"]
    assert {"qd6_deg_s", "tau6_Nm", "q6_ref_deg"} <= set(names)
    table = np.array([[float(x) for x in row.split(",")] for row in rows])
    np.testing.assert_allclose(np.diff(table[:, 0]), 0.004, atol=1e-9)
    np.testing.assert_allclose(table[:, 1:7], np.degrees(run.signals["q_seen"][::4]), atol=1e-6)
    data = json.loads(summary.read_text())
    assert data["tcp_error_mm"]["max"] == pytest.approx(1e3 * run.tcp_error.max())
    assert data["controller"] == "computed_torque"


def test_measured_angles_lie_on_the_encoder_grid(run: Simulation) -> None:
    step = run.sensors.encoder_step_rad
    counts = run.signals["q_seen"] / step
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
    assert np.abs(run.signals["q_seen"] - run.q).max() <= 0.51 * step


def test_speed_is_the_filtered_difference(run: Simulation) -> None:
    period = 1e-3
    f = run.sensors.speed_filter_Hz
    share = 1 - np.exp(-2 * np.pi * f * period)
    q = run.signals["q_seen"]
    qd = run.signals["qd_seen"]
    expected = qd[:-1] + share * (np.diff(q, axis=0) / period - qd[:-1])
    np.testing.assert_allclose(qd[1:], expected, atol=1e-12)


def test_the_command_of_one_sample_acts_at_the_next(run: Simulation) -> None:
    limit = run.plant.tau_max
    np.testing.assert_array_equal(run.tau[1:], np.clip(run.signals["command"][:-1], -limit, limit))


def test_same_seed_same_bits(run: Simulation) -> None:
    again = simulate(arm(), MOVE, "computed_torque", plant=perturbed_robot(arm(), 5), hold=0.2)
    np.testing.assert_array_equal(again.q, run.q)
    robot = arm()
    assert (
        robot.friction[0, 0] == 36.3
    )  # cached arrays of the nominal arm must not travel into the copy
    assert (
        perturbed_robot(robot, 6).friction[:, :3] != perturbed_robot(robot, 5).friction[:, :3]
    ).all()
    assert (perturbed_robot(robot, 6).friction[:, :3] != robot.friction[:, :3]).all()


def test_a_finer_step_tells_the_same_story(run: Simulation) -> None:
    fine = simulate(
        arm(), MOVE, "computed_torque", plant=perturbed_robot(arm(), 5), hold=0.2, substeps=8
    )
    assert np.abs(fine.p_BT - run.p_BT).max() < 0.15 * run.tcp_error.max()
    assert np.sqrt(np.mean(fine.tcp_error**2)) == pytest.approx(
        np.sqrt(np.mean(run.tcp_error**2)), rel=0.06
    )


def test_one_loop_serves_many_plants(run: Simulation) -> None:
    loop = make_loop(arm(), "computed_torque")
    other = loop.run(MOVE, plant=perturbed_robot(arm(), 5), hold=0.2)
    np.testing.assert_array_equal(other.q, run.q)
    with pytest.raises(InputError, match="other effects"):
        loop.run(MOVE, plant=with_effect(arm(), "cable_spring", 2, {"stiffness_Nm_rad": 10.0}))


def test_log_obeys_the_plants_equations(run: Simulation) -> None:
    """The simulated torque is the plant's inverse dynamics of the simulated motion."""
    h = 1e-3
    qdd = (run.qd[2:] - run.qd[:-2]) / (2 * h)
    tau = 0.5 * (run.tau[1:-1] + run.tau[:-2])
    moving = (np.abs(run.qd[1:-1]) > 0.15).all(axis=1)
    predicted = Model(run.plant).inverse_dynamics(run.q[1:-1], run.qd[1:-1], qdd)
    residual = (predicted - tau)[moving]
    assert moving.sum() > 300
    assert (np.abs(residual).max(axis=0) < 0.01 * run.plant.tau_max).all()


def test_measuring_chain_of_the_plant_reaches_the_log_only() -> None:
    plant = with_effect(arm(), "torque_gain", 2, {"gain": 1.1})
    plant = with_effect(plant, "torque_offset", 4, {"offset_Nm": 2.0})
    plant = with_effect(plant, "time_delay", 1, {"delay_s": 0.004})
    changed, plain = (simulate(arm(), MOVE, "computed_torque", plant=p) for p in (plant, arm()))
    np.testing.assert_array_equal(changed.q, plain.q)
    reported = changed.reported_torque()
    at = plain.tau[1:] / 2 + plain.tau[:-1] / 2
    np.testing.assert_allclose(reported[1:, 1], 1.1 * at[:, 1])
    np.testing.assert_allclose(reported[1:, 3], at[:, 3] + 2.0)
    np.testing.assert_allclose(reported[5:, 0], at[:-4, 0], atol=1e-9)


def test_an_angle_that_is_recorded_late_reaches_the_log_only() -> None:
    plant = with_effect(arm(), "time_delay", 2, {"delay_s": 0.008, "of_angle": True})
    late, plain = (simulate(arm(), MOVE, "computed_torque", plant=p) for p in (plant, arm()))
    np.testing.assert_array_equal(late.q, plain.q)
    np.testing.assert_array_equal(late.reported_torque(), plain.reported_torque())
    then = late.log()
    now = plain.log()
    assert then.qd is not None
    assert now.qd is not None
    for a, b in ((then.q, now.q), (then.qd, now.qd)):
        rows = round(0.008 / (now.time[1] - now.time[0]))
        np.testing.assert_allclose(a[rows:, 1], b[:-rows, 1], atol=1e-9)
        np.testing.assert_array_equal(np.delete(a, 1, axis=1), np.delete(b, 1, axis=1))


def test_encoder_zero_shifts_the_arm_not_the_reading() -> None:
    plant = with_effect(arm(), "encoder_zero", 3, {"zero_rad": 0.002})
    run = simulate(arm(), MOVE, "computed_torque", plant=plant)
    assert np.abs(run.signals["q_seen"] - run.q_ref).max() < 1e-3
    np.testing.assert_allclose(run.q[:, 2] - run.signals["q_seen"][:, 2], 0.002, atol=5e-6)


def test_starts_without_a_bump() -> None:
    still = quintic_move(START, START, 0.3)
    for name in ("pid", "gravity_pd", "feedforward_pid", "computed_torque"):
        run = simulate(arm(), still, name)
        assert np.abs(run.q - START).max() < 1e-8, name


def test_lag_of_the_torque_path() -> None:
    run = simulate(
        strong(without_friction(arm())), quintic_move(START, START, 0.05), "gravity_pd",
        sensors=IDEAL_SENSORS, actuators=Actuators(delay_samples=0, lag_s=0.005),
        gains={"kp": np.zeros(6), "kd": np.zeros(6)},
    )  # fmt: skip
    # in balance: the lagged torque equals the gravity torque all the time
    np.testing.assert_allclose(run.tau, np.tile(run.tau[0], (len(run.time), 1)), atol=1e-9)


def test_torque_noise_is_that_of_the_seed() -> None:
    noisy = Sensors(torque_noise_Nm=1.0)
    a, b = (simulate(arm(), MOVE, "gravity_pd", sensors=noisy, seed=s) for s in (1, 2))
    np.testing.assert_array_equal(a.tau, b.tau)
    assert np.std(a.reported_torque() - b.reported_torque()) == pytest.approx(2**0.5, rel=0.05)
    assert (a.reported_torque() != b.reported_torque()).any()


def test_an_unstable_loop_is_an_error_not_a_nan() -> None:
    with pytest.raises(InputError, match="diverged"):
        simulate(
            strong(arm()),
            MOVE,
            "gravity_pd",
            gains={"kp": np.full(6, 1e7), "kd": np.zeros(6)},
            actuators=IDEAL_ACTUATORS,
            hold=2.0,
        )


def test_friction_that_stops_a_joint_within_a_period_is_what_diverges() -> None:
    """Of a file with 180 Nm s/rad at the wrist the message blamed gains and masses."""
    robot = strong(arm())
    *others, last = robot.joints
    friction = last.friction.model_copy(update={"viscous_Nms_rad": 5e4})
    stiff = robot.model_copy(
        update={"joints": (*others, last.model_copy(update={"friction": friction}))}
    )
    with pytest.raises(InputError, match=r"viscous friction of 5e\+04 Nm s/rad stops joint 6"):
        simulate(stiff, MOVE, "gravity_pd", actuators=IDEAL_ACTUATORS)


def test_a_light_joint_with_much_friction_gets_finer_time_steps() -> None:
    """A Puma 560 without its rotors diverged at 1 kHz; so did arms of a URDF with damping and
    nothing of their rotors."""
    robot = load_robot("puma560").bare()
    start = np.radians([0.0, -45.0, -60.0, 0.0, 40.0, 0.0])
    stop = start + np.radians([20.0, 20.0, 20.0, 60.0, -60.0, 90.0])
    loop = make_loop(robot, "computed_torque", sensors=IDEAL_SENSORS)
    assert loop.substeps == needed_substeps(robot, 1e-3) > 1
    run = loop.run(quintic_move(start, stop, 1.0))
    assert np.degrees(np.abs(run.q - run.q_ref).max()) < 0.5
    coarse = make_loop(robot, "computed_torque", sensors=IDEAL_SENSORS, substeps=1)
    with pytest.raises(InputError, match=rf"stops joint 6, .* or substeps={loop.substeps}"):
        coarse.run(quintic_move(start, stop, 1.0))
    assert needed_substeps(arm(), 1e-3) == 1


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"rate": 0}, "rate is 0; expected a positive number"),
        ({"rate": 0.001}, "a rate in 1/s"),
        ({"hold": -1.0}, "hold is -1.0"),
        ({"seed": -1}, "seed is -1"),
        ({"plant": "irb2400.toml"}, "plant: found .irb2400.toml., expected a Robot"),
        ({"gains": {"kp": np.nan}}, "kp: found nan; expected finite numbers"),
        ({"gains": {"kp": -1.0}}, "kp: found -1.0; expected at least 0.0"),
        ({"gains": {"kp": [1.0, 2.0]}}, r"kp: found shape \(2,\)"),
        ({"wrench": np.full((1201, 6), np.nan)}, "wrench: row 1 holds no number"),
    ],
)
def test_a_wrong_request_is_refused_in_words(asked: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        simulate(arm(), MOVE, "gravity_pd", **asked)


def own_law(torque: Callable[[ca.SX], ca.SX], n: int = 6) -> Block:
    """A controller of the measured angles alone."""
    q = ca.SX.sym("q", n)
    step = ca.Function("own", [q], [torque(q)], ["q"], ["tau"])
    fields = (Field("q", n, "rad", "angles"),), (Field("tau", n, "Nm", "torques"),)
    return Block("own", "a law of one's own", 1e-3, (), *fields, (), step)


def test_a_controller_without_numbers_is_not_blamed_on_the_arm() -> None:
    with pytest.raises(InputError, match=r"controller 'own' gives no number as tau at 0\.000 s"):
        simulate(arm(), MOVE, own_law(lambda q: ca.sqrt(-1 - q**2)))


def test_a_controller_of_another_arm_or_no_controller_is_refused() -> None:
    with pytest.raises(InputError, match="q has 2 elements; expected 6: the arm has 6 joints"):
        simulate(arm(), MOVE, own_law(lambda q: -q, n=2))
    with pytest.raises(InputError, match="controller: found a function, expected a Block"):
        simulate(arm(), MOVE, lambda q: -q)


def test_a_fast_stream_keeps_its_times_in_the_file(tmp_path: Path) -> None:
    """With four decimals steps of 1/3 ms were written as 0.3, 0.4 and 0.3 ms."""
    run = simulate(arm(), MOVE, "gravity_pd", rate=3000.0, sensors=Sensors(rate_Hz=3000.0))
    time = np.loadtxt(run.write(tmp_path)[0], delimiter=",", skiprows=1, usecols=0)
    np.testing.assert_allclose(np.diff(time), 1 / 3000.0, rtol=1e-4)


def test_says_what_does_not_fit() -> None:
    with pytest.raises(InputError, match="no controller 'pidd'"):
        simulate(arm(), MOVE, "pidd")
    with pytest.raises(InputError, match="gravity_pd has no parameter kq"):
        simulate(arm(), MOVE, "gravity_pd", gains={"kq": 1.0})
    with pytest.raises(InputError, match=r"wrench: found shape \(3, 6\)"):
        simulate(arm(), MOVE, "gravity_pd", wrench=np.zeros((3, 6)))


def test_encoder_noise_enters_the_loop_and_is_that_of_the_seed() -> None:
    noisy = Sensors(encoder_noise_rad=1e-5)
    loop = make_loop(arm(), "computed_torque", sensors=noisy)
    a, b, c = (loop.run(MOVE, seed=s) for s in (1, 1, 2))
    np.testing.assert_array_equal(a.q, b.q)
    assert (a.q != c.q).any()
    assert np.std(a.signals["q_seen"] - a.q) == pytest.approx(1e-5, rel=0.05)


def test_generated_c_of_the_whole_loop_follows_the_expression_step_by_step() -> None:
    plant = with_effect(perturbed_robot(arm(), 5), "elastic_joint", 1, {"stiffness_Nm_rad": 1e5})
    loop = make_loop(arm(), "adaptive", plant=plant)
    motion = MOVE.at_rate(1000.0)
    inputs = np.hstack([motion.q, motion.qd, motion.qdd])[300:340]
    block = loop.compiled.block
    x = loop.compiled.initial_state
    x[:6] = motion.q[300]
    states, outputs = loop.compiled.rollout(inputs, x0=x)
    flat = block.flat()
    for k, u in enumerate(inputs):
        # from the same state each time: a stick event a rounding earlier is no difference of the
        # code
        after, y = flat(states[k], u, loop.compiled.default_parameters)
        np.testing.assert_allclose(states[k + 1], np.asarray(after).ravel(), rtol=1e-9, atol=1e-7)
        np.testing.assert_allclose(outputs[k], np.asarray(y).ravel(), rtol=1e-9, atol=1e-7)


def test_default_spread_is_that_of_the_data_sheet() -> None:
    """Masses 2 %, centres of mass 5 mm, inertias 5 %, friction 4 %; the draws are normal deviates
    cut at two, which makes them smaller by 0.96."""
    arms = [perturbed_robot(arm(), seed) for seed in range(40)]
    friction = np.array([a.friction[:, :3] / arm().friction[:, :3] - 1 for a in arms])
    assert friction.std() == pytest.approx(0.96 * 0.04, rel=0.1)
    links = [pair for robot in arms for pair in zip(robot.links, arm().links, strict=True)]
    bodies = [(found.body, nominal.body) for found, nominal in links]
    mass = np.array([a.mass_kg / b.mass_kg - 1 for a, b in bodies if b.mass_kg])
    com = np.array([np.subtract(a.com_m, b.com_m) for a, b in bodies])
    assert mass.std() == pytest.approx(0.96 * 0.02, rel=0.15)
    inertia = np.array([a.inertia_kgm2[0] / b.inertia_kgm2[0] - 1 for a, b in bodies])
    assert com.std() == pytest.approx(0.96 * 0.005, rel=0.15)
    assert inertia.std() == pytest.approx(0.96 * 0.05, rel=0.15)
