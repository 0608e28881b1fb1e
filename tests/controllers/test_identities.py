"""What each control law promises on paper, to the precision it promises it with."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.arms import (
    FORCE_EFFECTS,
    START,
    STOP,
    arm,
    quintic_move,
    strong,
    with_effect,
    without_friction,
)

from irb2400_ctrl.codegen import Block, compile_block
from irb2400_ctrl.controllers import CONTROLLERS, controller
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import IDEAL_ACTUATORS, IDEAL_SENSORS, simulate

RNG = np.random.default_rng(7)
STILL = quintic_move(START, START, 1.5)


def evaluate(block: Block, **inputs: np.ndarray) -> np.ndarray:
    """First output of one step from the initial state."""
    values = {f.name: f.start for f in (*block.states, *block.parameters)} | inputs
    names = [f.name for f in (*block.states, *block.inputs, *block.parameters)]
    return np.asarray(block.step.call([values[n] for n in names])[len(block.states)]).ravel()


# dry friction turns over with the reference, not with the motion
DRY = {"coulomb_asymmetry", "coulomb_change", "geared_motor", "load_friction"}
SMOOTH = [e for e in FORCE_EFFECTS if e[0] not in DRY]


@pytest.mark.parametrize(("kind", "joint", "fields"), SMOOTH, ids=[e[0] for e in SMOOTH])
def test_computed_torque_linearises_exactly(
    kind: str, joint: int | None, fields: dict[str, object]
) -> None:
    """M (qdd_ref + Kd ed + Kp e) + ... on the nominal frictionless arm gives qdd = qdd_ref + Kd ed
    + Kp e."""
    robot = with_effect(strong(without_friction(arm())), kind, joint, fields)
    block = controller("computed_torque", robot, bandwidth=[20, 30, 40, 50, 60, 70], damping=0.7)
    kp = block.parameters[0].start
    kd = block.parameters[1].start
    for _ in range(5):
        q = RNG.uniform(0.8 * robot.q_min, 0.8 * robot.q_max)
        qd, qd_ref, qdd_ref = RNG.normal(size=(3, 6))
        q_ref = q + 0.05 * RNG.normal(size=6)
        tau = evaluate(block, q=q, qd=qd, q_ref=q_ref, qd_ref=qd_ref, qdd_ref=qdd_ref)
        qdd = Model(robot).forward_dynamics(q, qd, tau)
        np.testing.assert_allclose(
            qdd, qdd_ref + kd * (qd_ref - qd) + kp * (q_ref - q), rtol=1e-9, atol=1e-7
        )


@pytest.mark.parametrize(
    ("kind", "joint", "fields"), FORCE_EFFECTS, ids=[e[0] for e in FORCE_EFFECTS]
)
def test_model_torque_is_inverse_dynamics_on_the_reference(
    kind: str, joint: int | None, fields: dict[str, object]
) -> None:
    """On the reference, in full motion, the model's torque is `Model.inverse_dynamics`, effects
    included."""
    robot = with_effect(strong(arm()), kind, joint, fields)
    q = RNG.uniform(0.8 * robot.q_min, 0.8 * robot.q_max)
    qd = RNG.choice([-1, 1], 6) * RNG.uniform(0.8, 1.5, 6)
    qdd = RNG.normal(size=6)
    expected = Model(robot).inverse_dynamics(q, qd, qdd)
    for name in ("computed_torque", "feedforward_pid"):
        tau = evaluate(controller(name, robot), q=q, qd=qd, q_ref=q, qd_ref=qd, qdd_ref=qdd)
        # the regularised sign lacks (width / speed)^2 / 2 of the dry friction
        np.testing.assert_allclose(tau, expected, atol=1e-3, err_msg=name)


def lyapunov(robot: Robot, q: np.ndarray, qd: np.ndarray, kp: np.ndarray) -> np.ndarray:
    M = Model(robot).mass_matrix(q)
    return 0.5 * np.einsum("ki,kij,kj->k", qd, M, qd) + 0.5 * ((START - q) ** 2 @ kp)


def test_gravity_pd_is_passive() -> None:
    """V = qd' M qd / 2 + e' Kp e / 2 grows by no more than the work of the wrench at the tool."""
    robot = strong(without_friction(arm()))
    block = controller("gravity_pd", robot, 1 / 4000)
    kp = block.parameters[0].start
    still = quintic_move(START, START, 1.0)
    time = np.arange(4001) / 4000
    wrench = np.zeros((4001, 6))
    wrench[:, :3] = (
        300 * np.sin(np.outer(2 * np.pi * time, [1.0, 2.3, 3.1])) * (time < 0.6)[:, None]
    )
    run = simulate(
        robot,
        still,
        block,
        wrench=wrench,
        sensors=IDEAL_SENSORS,
        actuators=IDEAL_ACTUATORS,
        substeps=1,
    )
    V = lyapunov(robot, run.q, run.qd, kp)
    J = Model(robot).tcp_jacobian(run.q)
    power = np.einsum("ki,kij,kj->k", wrench, J, run.qd)
    work = np.concatenate([[0], np.cumsum(0.5 * (power[1:] + power[:-1]) / 4000)])
    assert V.max() > 0.5  # the wrench does move the arm
    assert (V - V[0] <= work + 1e-3 * V.max()).all()
    free = time > 0.62
    assert (np.diff(V[free]) <= 1e-9 * V.max()).all()


def test_steady_state_of_gravity_pd_under_a_wrench() -> None:
    """Kp e = -J^T w."""
    robot = strong(without_friction(arm()))
    wrench = np.tile([60.0, -40.0, 80.0, 2.0, 1.0, -3.0], (1501, 1))
    block = controller("gravity_pd", robot)
    run = simulate(
        robot, STILL, block, wrench=wrench, sensors=IDEAL_SENSORS, actuators=IDEAL_ACTUATORS
    )
    J = Model(robot).tcp_jacobian(run.q[-1])
    np.testing.assert_allclose(
        block.parameters[0].start * (START - run.q[-1]), -J.T @ wrench[0], rtol=1e-4, atol=1e-3
    )


def test_steady_state_of_computed_torque_under_a_wrench() -> None:
    """M Kp e = -J^T w."""
    robot = strong(without_friction(arm()))
    wrench = np.tile([60.0, -40.0, 80.0, 2.0, 1.0, -3.0], (1501, 1))
    run = simulate(
        robot,
        STILL,
        "computed_torque",
        wrench=wrench,
        sensors=IDEAL_SENSORS,
        actuators=IDEAL_ACTUATORS,
    )
    model = Model(robot)
    error = START - run.q[-1]
    expected = -model.tcp_jacobian(run.q[-1]).T @ wrench[0]
    np.testing.assert_allclose(
        model.mass_matrix(run.q[-1]) @ (3600 * error), expected, rtol=1e-3, atol=1e-2
    )


@pytest.mark.parametrize("name", ["pid", "feedforward_pid"])
def test_an_integrator_leaves_no_error_under_a_constant_wrench(name: str) -> None:
    robot = strong(without_friction(arm()))
    wrench = np.tile([60.0, -40.0, 80.0, 2.0, 1.0, -3.0], (1501, 1))
    ends = {}
    for deadband in (0.0, 1e-4):
        run = simulate(
            robot, STILL, name, wrench=wrench, sensors=IDEAL_SENSORS, gains={"deadband": deadband}
        )
        assert np.abs(run.q - START).max() > 1e-4
        ends[deadband] = np.abs(run.q[-1] - START).max()
    assert ends[0.0] < 1e-6
    assert ends[1e-4] < 1e-4


def test_anti_windup_shortens_the_overshoot() -> None:
    """A step that saturates the torque: with back-calculation the arm passes its goal by far
    less."""
    robot = without_friction(arm())
    goal = START + np.array([0.8, 0, 0, 0, 0, 0])
    jump = quintic_move(goal, goal, 2.5)
    overshoot = {}
    for tracking in (0.1, 1e6):
        gains = {"tracking": np.full(6, tracking), "kp": np.full(6, 10.0)}
        run = from_pose(robot, START, jump, gains)
        overshoot[tracking] = run[:, 0].max() - goal[0]
    assert overshoot[1e6] > 0.05
    assert overshoot[0.1] < 0.4 * overshoot[1e6]


def from_pose(robot: Robot, q: np.ndarray, reference, gains: dict[str, np.ndarray]) -> np.ndarray:
    """Angles of a pid loop that starts at another pose than its reference."""
    from irb2400_ctrl.simulation import make_loop

    loop = make_loop(robot, "pid")
    motion = reference.at_rate(1000.0)
    names = [f.name for f in loop.compiled.block.states]
    values = {f.name: f.start for f in loop.compiled.block.states}
    balance = Model(robot).gravity(q)
    values |= {"p_q": q, "q_before": q, "tau_before": balance, "c_integral": balance}
    p = loop.compiled.parameters(**{f"c_{k}": v for k, v in gains.items()})
    inputs = np.hstack([motion.q, motion.qd, motion.qdd])
    states, _ = loop.compiled.rollout(inputs, x0=np.concatenate([values[n] for n in names]), p=p)
    return loop.compiled.split(loop.compiled.block.states, states)["p_q"]


@pytest.mark.parametrize("name", sorted(CONTROLLERS))
def test_generated_c_follows_the_expression_step_by_step(name: str) -> None:
    robot = with_effect(arm(), "hysteresis", 2, {"amplitude_Nm": 5.0, "width_rad": 0.01})
    block = controller(name, robot)
    compiled = compile_block(block)
    motion = quintic_move(START, STOP, 0.8).at_rate(100.0)
    noise = 1e-3 * RNG.normal(size=motion.q.shape)
    inputs = np.hstack([motion.q + noise, motion.qd + 10 * noise, motion.q, motion.qd, motion.qdd])
    states, outputs = compiled.rollout(inputs)
    flat = block.flat()
    x = compiled.initial_state
    for k, u in enumerate(inputs):
        after, y = flat(x, u, compiled.default_parameters)
        np.testing.assert_allclose(outputs[k], np.asarray(y).ravel(), rtol=1e-11, atol=1e-9)
        x = np.asarray(after).ravel()
        np.testing.assert_allclose(states[k + 1], x, rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("name", sorted(CONTROLLERS))
def test_torque_stays_inside_the_limits(name: str) -> None:
    robot = arm()
    block = controller(name, robot)
    far = START + np.array([1.0, -1, 1, -1, 1, -1])
    zero = np.zeros(6)
    tau = evaluate(block, q=START, qd=zero, q_ref=far, qd_ref=zero, qdd_ref=zero)
    assert (np.abs(tau) <= robot.tau_max).all()
    assert (np.abs(tau) == robot.tau_max).any()


def test_the_controller_knows_the_effect_it_was_given() -> None:
    """Payload and hysteresis in plant and controller: the error falls, and by a lot."""
    plant = with_effect(arm(), "payload", None, {"mass_kg": 8.0, "com_m": (0.05, 0.0, 0.15)})
    plant = with_effect(plant, "hysteresis", 2, {"amplitude_Nm": 20.0, "width_rad": 0.02})
    move = quintic_move(START, STOP, 1.2)
    blind, knowing = (simulate(r, move, "computed_torque", plant=plant) for r in (arm(), plant))
    rms = [np.sqrt(np.mean(run.tcp_error**2)) for run in (blind, knowing)]
    assert rms[1] < 0.2 * rms[0]


def test_a_resting_reference_asks_for_no_dry_friction() -> None:
    tau = evaluate(
        controller("computed_torque", arm()),
        q=START,
        qd=np.zeros(6),
        q_ref=START,
        qd_ref=np.zeros(6),
        qdd_ref=np.zeros(6),
    )
    np.testing.assert_allclose(tau, Model(arm()).gravity(START), atol=1e-9)


def test_says_what_it_does_not_know() -> None:
    with pytest.raises(InputError, match="no controller 'lqr'; expected one of pid"):
        controller("lqr", arm())
    with pytest.raises(
        InputError, match="no design parameter bandwith; expected some of bandwidth, damping"
    ):
        controller("computed_torque", arm(), bandwith=3)
    with pytest.raises(InputError, match="one number"):
        controller("computed_torque", arm(), bandwidth=[1, 2])
    with pytest.raises(InputError, match="sample time"):
        controller("pid", arm(), 0.0)
