"""The plant against the model it stands for: accelerations, order of convergence, energy, rest."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.arms import FORCE_EFFECTS, START, arm, strong, with_effect, without_friction

from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.plant import plant_block

SPEED = np.array([0.5, -0.4, 0.3, 0.8, -0.6, 0.7])


def roll(
    robot: Robot,
    tau: np.ndarray,
    q: np.ndarray,
    qd: np.ndarray,
    *,
    steps: int = 1,
    period: float = 1e-3,
    sweeps: int = 2,
) -> dict[str, np.ndarray]:
    """States at the control instants (n + 1) under a torque (n, 6), each held for `steps` time
    steps."""
    # a block of one step run oftener: unrolled steps give the same bits and longer compilations
    plant = compile_block(plant_block(robot, period / steps, sweeps=sweeps))
    x0 = plant.initial_state
    x0[:6] = q
    x0[6:12] = qd
    states, _ = plant.rollout(np.repeat(tau, steps, axis=0), x0=x0)
    return plant.split(plant.block.states, states[::steps])


def test_unrolled_steps_are_the_same_as_more_steps() -> None:
    robot = arm()
    tau = Model(robot).gravity(START) + np.array([80.0, -60.0, 50.0, 10.0, -12.0, 8.0])
    plant = compile_block(plant_block(robot, 1e-3, substeps=3))
    x0 = plant.initial_state
    x0[:6] = START
    x0[6:12] = SPEED
    states, _ = plant.rollout(np.tile(tau, (20, 1)), x0=x0)
    finer = roll(robot, np.tile(tau, (20, 1)), START, SPEED, steps=3)
    np.testing.assert_allclose(states[:, :6], finer["q"], rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("kind", "joint", "fields"), FORCE_EFFECTS, ids=[e[0] for e in FORCE_EFFECTS]
)
def test_accelerates_as_the_model_says(
    kind: str, joint: int | None, fields: dict[str, object]
) -> None:
    robot = with_effect(arm(), kind, joint, fields)
    tau = Model(robot).gravity(START) + np.array([80.0, -60.0, 50.0, 10.0, -12.0, 8.0])
    # many tiny steps: the acceleration estimate that load friction looks at has settled
    states = roll(robot, np.tile(tau, (20, 1)), START, SPEED, period=1e-7)
    expected = Model(robot).forward_dynamics(START, SPEED, tau)
    np.testing.assert_allclose(states["qdd"][-1], expected, rtol=1e-4, atol=2e-3)


def test_smooth_motion_converges_with_second_order() -> None:
    robot = without_friction(arm())
    tau = np.zeros((200, 6))
    runs = {k: roll(robot, tau, START, SPEED, steps=k)["q"] for k in (1, 2, 4, 32)}
    errors = [np.abs(runs[k] - runs[32]).max() for k in (1, 2, 4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[0] < 1e-5
    np.testing.assert_allclose(orders, 2.0, atol=0.15)


def test_stick_slip_motion_converges() -> None:
    robot = arm()
    time = np.arange(500)[:, None] * 1e-3
    swing = np.array([150, 150, 80, 25, 45, 14]) * np.sin(
        2 * np.pi * np.array([2, 2.3, 3.1, 4.3, 2.7, 3.9]) * time
    )
    tau = Model(robot).gravity(START) + swing
    fine = roll(robot, tau, START, 0 * SPEED, steps=32, sweeps=6)["q"]
    errors = [
        np.abs(roll(robot, tau, START, 0 * SPEED, steps=k)["q"] - fine).max() for k in (1, 2, 4, 8)
    ]
    assert errors[0] < 2e-4
    assert np.log2(errors[0] / errors[3]) / 3 > 0.9, errors


def test_agrees_with_an_adaptive_multistep_integrator() -> None:
    import casadi as ca

    robot = without_friction(arm())
    dynamics = Model(robot).function("forward_dynamics_without_friction")
    x = ca.SX.sym("x", 12)
    qdd = dynamics(x[:6], x[6:], ca.SX.zeros(6), 0)
    grid = np.linspace(0, 0.3, 4)
    cvodes = ca.integrator(
        "cvodes",
        "cvodes",
        {"x": x, "ode": ca.vertcat(x[6:], qdd)},
        0,
        grid[1:].tolist(),
        {"reltol": 1e-10, "abstol": 1e-12},
    )
    truth = np.asarray(cvodes(x0=np.concatenate([START, SPEED]))["xf"]).T
    states = roll(robot, np.zeros((300, 6)), START, SPEED, steps=16)
    np.testing.assert_allclose(states["q"][[100, 200, 300]], truth[:, :6], atol=5e-8)


def energy(robot: Robot, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """Kinetic and potential energy [J] up to a constant."""
    model = Model(robot)
    kinetic = 0.5 * np.einsum("ki,kij,kj->k", qd, model.mass_matrix(q), qd)
    return kinetic + potential(robot, q)


def potential(robot: Robot, q: np.ndarray) -> np.ndarray:
    """-g^T sum of m c, by the chain product of the link frames."""
    theta = q @ robot.A.T + robot.offset
    total = np.zeros(len(q))
    for k, angles in enumerate(theta):
        X = np.eye(4)
        for link, angle, phi in zip(robot.links, angles, robot.inertial_parameters, strict=True):
            c = np.cos(angle)
            s = np.sin(angle)
            turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
            X = X @ link.frame.matrix() @ turn
            total[k] -= robot.gravity @ (phi[0] * X[:3, 3] + X[:3, :3] @ phi[1:4])
    return total


def test_energy_of_a_frictionless_swing_stays() -> None:
    robot = without_friction(arm())
    drift = {}
    for steps in (1, 2):
        states = roll(robot, np.zeros((4000, 6)), START, SPEED, steps=steps)
        E = energy(robot, states["q"][::50], states["qd"][::50])
        drift[steps] = (E - E[0]) / np.ptp(potential(robot, states["q"][::50]))
    assert np.abs(drift[1]).max() < 3e-4
    # the error is of second order; over the first second the two runs are still at the same place
    assert drift[1][20] / drift[2][20] == pytest.approx(4.0, abs=0.6)


def test_stands_still_within_static_friction() -> None:
    robot = arm()
    push = 0.9 * robot.friction[:, 0] * np.array([1, -1, 1, -1, 1, -1])
    tau = Model(robot).gravity(START) + push
    states = roll(robot, np.tile(tau, (500, 1)), START, np.zeros(6))
    # the sweeps start without a guess; from the second step on nothing moves at all, for ever
    assert np.abs(states["q"][2] - START).max() < 1e-8
    assert (states["q"][2:] == states["q"][2]).all()
    assert (states["qd"][2:] == 0).all()
    np.testing.assert_allclose(states["dry"][-1], push, atol=1e-5)


def test_breaks_loose_above_static_friction_on_that_joint_only() -> None:
    robot = arm()
    push = np.zeros(6)
    push[0] = 1.02 * robot.friction[0, 0]
    tau = Model(robot).gravity(START) + push
    states = roll(robot, np.tile(tau, (200, 1)), START, np.zeros(6))
    assert states["qd"][-1, 0] > 0.01
    assert (states["qd"][2:, 1:] == 0).all()


def test_hysteresis_grows_along_its_law() -> None:
    width = 0.05
    robot = with_effect(
        strong(without_friction(arm())), "hysteresis", 1, {"amplitude_Nm": 5.0, "width_rad": width}
    )
    tau = np.tile(Model(robot).gravity(START), (200, 1))
    states = roll(robot, tau, START, np.array([1.0, 0, 0, 0, 0, 0]))
    way = states["q"][:, 0] - START[0]
    np.testing.assert_allclose(states["memory"][:, 0], 1 - np.exp(-way / width), atol=2e-3)


def test_a_wrench_at_the_tool_acts_through_the_jacobian() -> None:
    robot = without_friction(arm())
    model = Model(robot)
    wrench = np.array([30.0, -20.0, 50.0, 1.0, 2.0, -3.0])
    tau = model.gravity(START)
    plant = compile_block(plant_block(robot, 1e-6, wrench=True))
    x0 = plant.initial_state
    x0[:6] = START
    states, _ = plant.rollout(np.tile(np.concatenate([tau, wrench]), (3, 1)), x0=x0)
    qdd = plant.split(plant.block.states, states)["qdd"][-1]
    expected = np.linalg.solve(model.mass_matrix(START), model.tcp_jacobian(START).T @ wrench)
    np.testing.assert_allclose(qdd, expected, rtol=1e-5, atol=1e-5)


def test_refuses_senseless_steps() -> None:
    with pytest.raises(InputError, match="substeps: found 0"):
        plant_block(arm(), substeps=0)


def test_every_effect_of_the_library_is_simulated_and_tested() -> None:
    """A new kind has to find its place: force, mass data, measuring chain, or a transmission of its
    own."""
    elsewhere = {
        *("hysteresis", "elastic_joint", "transmission_backlash"),
        *("encoder_zero", "torque_gain", "torque_offset", "time_delay"),
        # fitted by an identification; no simulated reading lacks part of the accelerating torque
        "acceleration_reading",
    }
    assert set(LIBRARY) == {kind for kind, _, _ in FORCE_EFFECTS} | elsewhere
