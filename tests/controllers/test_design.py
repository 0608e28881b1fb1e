"""Gain design: what was wished for is what the discrete loop has; linearisations against finite
differences."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.arms import START, STOP, arm, quintic_move, strong, with_effect, without_friction
from simulation.planar_arm import planar

from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded
from irb2400_ctrl.controllers.design import (
    JointDesign,
    computed_torque_with,
    fastest,
    lqr,
    over_poses,
    place_poles,
    shape_loop,
)
from irb2400_ctrl.controllers.linear import (
    LinearLoop,
    arm_to_control,
    hanging,
    linearize,
    linearize_block,
    to_control,
    viscous_dynamics,
)
from irb2400_ctrl.controllers.margins import frequencies, margins
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.simulation import IDEAL_ACTUATORS, IDEAL_SENSORS, make_loop

IDEAL = Timing(delay_samples=0, speed_filter_Hz=0.0)
RNG = np.random.default_rng(11)


@pytest.mark.parametrize(("bandwidth", "damping"), [(30.0, 1.0), (60.0, 0.7), (120.0, 0.5)])
def test_poles_are_where_they_were_placed(bandwidth: float, damping: float) -> None:
    T = 1e-3
    design = place_poles(bandwidth, damping, IDEAL)
    closed = np.array([[1, T], [0, 1]]) - np.outer([T**2 / 2, T], [design.kp, design.kd])
    wanted = np.exp(T * np.roots([1, 2 * damping * bandwidth, bandwidth**2]))
    np.testing.assert_allclose(
        np.sort_complex(np.linalg.eigvals(closed)), np.sort_complex(wanted), atol=1e-7
    )


@pytest.mark.parametrize(("crossover", "phase"), [(60.0, 60.0), (120.0, 55.0), (200.0, 45.0)])
@pytest.mark.parametrize("timing", [Timing(), Timing(delay_samples=0, lag_s=0.002), IDEAL])
def test_loop_shaping_hits_crossover_and_phase(
    crossover: float, phase: float, timing: Timing
) -> None:
    found = shape_loop(crossover, np.radians(phase), timing).margins
    assert found.crossover == pytest.approx(crossover, rel=1e-3)
    assert np.degrees(found.phase) == pytest.approx(phase, abs=0.1)


def test_lqr_gains_satisfy_the_riccati_equation_and_grow_with_the_wish() -> None:
    slow = lqr(1e-2, 10.0)
    fast = lqr(1e-3, 10.0)
    assert fast.kp > slow.kp
    # continuous limit: kp = a0 / e0, kd = sqrt(2 kp)
    assert slow.kp == pytest.approx(1000.0, rel=0.1)
    assert slow.kd == pytest.approx(np.sqrt(2 * 1000.0), rel=0.05)


def test_margins_of_a_known_loop() -> None:
    """L = 10 / (s (s + 1) (s + 10)): gain margin 11, phase and crossover from the closed form."""
    omega = np.geomspace(1e-2, 1e3, 20001)
    s = 1j * omega
    found = margins(omega, 10 / (s * (s + 1) * (s + 10)))
    assert found.gain_up == pytest.approx(11.0, rel=1e-4)
    w = found.crossover
    assert abs(10 / (1j * w * (1j * w + 1) * (1j * w + 10))) == pytest.approx(1.0, rel=1e-5)
    assert found.phase == pytest.approx(np.pi / 2 - np.arctan(w) - np.arctan(w / 10), rel=1e-4)
    assert found.delay == pytest.approx(found.phase / w, rel=1e-6)


def test_gain_and_delay_margins_are_where_the_loop_goes_unstable() -> None:
    design = place_poles(60.0)
    up = design.margins.gain_up
    assert JointDesign(0.99 * up * design.kp, 0.99 * up * design.kd, design.timing).stable
    assert not JointDesign(1.01 * up * design.kp, 1.01 * up * design.kd, design.timing).stable
    whole = int(design.margins.delay / 1e-3)
    assert JointDesign(design.kp, design.kd, Timing(delay_samples=1 + whole)).stable
    assert not JointDesign(design.kp, design.kd, Timing(delay_samples=2 + whole)).stable


def test_linearised_arm_agrees_with_finite_differences() -> None:
    robot = with_effect(arm(), "cable_spring", 2, {"stiffness_Nm_rad": 300.0})
    dynamics = viscous_dynamics(Model(robot))
    q = RNG.uniform(0.6 * robot.q_min, 0.6 * robot.q_max)
    qd = RNG.normal(size=6)
    tau = 50 * RNG.normal(size=6)
    system = linearize(robot, q, qd, tau)
    h = 1e-6
    point = np.concatenate([q, qd, tau])

    def rate(z: np.ndarray) -> np.ndarray:
        return np.asarray(dynamics(z[:6], z[6:12], z[12:])).ravel()

    slopes = np.column_stack(
        [(rate(point + h * e) - rate(point - h * e)) / (2 * h) for e in np.eye(18)]
    )
    np.testing.assert_allclose(
        np.hstack([system.A[6:], system.B[6:]]), slopes, rtol=1e-5, atol=1e-5
    )


@pytest.mark.parametrize("name", sorted(CONTROLLERS))
def test_linearised_controller_agrees_with_finite_differences(name: str) -> None:
    block = controller(name, arm())
    system = linearize_block(block, START)
    flat = block.flat()
    h = 1e-6
    x0 = np.concatenate([np.zeros(0), *(f.start for f in block.states)])
    u0 = np.concatenate([START if f.name in {"q", "q_ref"} else np.zeros(6) for f in block.inputs])
    p = np.concatenate([f.start for f in block.parameters])

    def torque(step: np.ndarray) -> np.ndarray:
        u = u0.copy()
        u[:12] += step
        return np.asarray(flat(x0, u, p)[1]).ravel()

    slopes = np.column_stack([(torque(h * e) - torque(-h * e)) / (2 * h) for e in np.eye(12)])
    np.testing.assert_allclose(-system.D, slopes, rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize("name", sorted(CONTROLLERS))
def test_default_gains_have_margins_over_the_workspace(name: str) -> None:
    robot = arm()
    poses = np.random.default_rng(5).uniform(robot.q_min, robot.q_max, (8, 6))
    poses[0, 4] = 0.0  # axes 4 and 6 in line
    worst = over_poses(robot, controller(name, robot), poses)
    assert worst.stable
    assert worst.coupled_peak < 2.2, str(worst)
    assert np.degrees(worst.phase) > 35, str(worst)


def test_linear_loop_predicts_the_simulated_one() -> None:
    """Just inside the coupled gain margin the simulated loop settles, just outside it does not."""
    robot = strong(without_friction(arm()))
    block = controller("gravity_pd", robot)
    edge = brink(lambda k: LinearLoop(robot, scaled(block, k), START, Timing()).stable)
    still = quintic_move(START, START, 1.0)
    loop = make_loop(robot, block)
    ends = {}
    for share in (0.93, 1.07):
        gains = {f.name: share * edge * f.start for f in block.parameters}
        run = kicked(loop, still, gains)
        ends[share] = np.abs(run[-100:]).max() / np.abs(run[:200]).max()
    assert ends[0.93] < 0.8
    assert ends[1.07] > 1.5


def scaled(block, factor: float):
    from irb2400_ctrl.controllers.parts import with_gains

    return with_gains(block, **{f.name: factor * f.start for f in block.parameters})


def brink(stable) -> float:
    low = 1.0
    high = 100.0
    while high / low > 1.001:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


def kicked(loop, motion, gains: dict[str, np.ndarray]) -> np.ndarray:
    """Deviation from the reference after a tiny initial speed."""
    block = loop.compiled.block
    values = {f.name: f.start for f in block.states}
    weight = Model(loop.robot).gravity(START)
    values |= {"p_q": START, "p_qd": np.full(6, 1e-4), "q_before": START, "tau_before": weight}
    p = loop.compiled.parameters(**{f"c_{k}": v for k, v in gains.items()})
    motion = motion.at_rate(1000.0)
    states, _ = loop.compiled.rollout(
        np.hstack([motion.q, motion.qd, motion.qdd]),
        x0=np.concatenate([values[f.name] for f in block.states]),
        p=p,
    )
    return loop.compiled.split(block.states, states)["p_qd"]


def test_control_systems_step_like_the_generated_code() -> None:
    import control

    block = controller("feedforward_pid", arm())
    system = to_control(block)
    motion = quintic_move(START, STOP, 0.1).at_rate(1000.0)
    inputs = np.hstack([motion.q + 1e-3, motion.qd, motion.q, motion.qd, motion.qdd])
    response = control.input_output_response(
        system, motion.time, inputs.T, X0=np.zeros(system.nstates)
    )
    from irb2400_ctrl.codegen import compile_block

    _, outputs = compile_block(block).rollout(inputs)
    np.testing.assert_allclose(response.outputs.T, outputs, atol=1e-9)


def test_closed_loop_as_a_control_system() -> None:
    import control

    loop = make_loop(arm(), "gravity_pd", sensors=IDEAL_SENSORS, actuators=IDEAL_ACTUATORS)
    system = to_control(loop.compiled.block)
    x0 = loop.compiled.initial_state
    x0[:6] = START
    u = np.tile(np.concatenate([START, np.zeros(12)])[:, None], (1, 3))
    response = control.input_output_response(system, np.arange(3) * 1e-3, u, X0=x0)
    assert response.outputs.shape[0] == system.noutputs
    assert "q[0]" in system.output_labels


def test_arm_as_a_control_system_agrees_with_its_linearisation() -> None:
    robot = arm()
    system = arm_to_control(robot)
    weight = Model(robot).gravity(START)
    x = np.concatenate([START, np.zeros(6)])
    np.testing.assert_allclose(system.dynamics(0.0, x, weight), 0, atol=1e-9)
    linear = system.linearize(x, weight)
    exact = linearize(robot, START)
    np.testing.assert_allclose(linear.A, exact.A, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(linear.B, exact.B, rtol=1e-3, atol=1e-5)


def test_designed_gains_reach_the_controller_and_its_loop() -> None:
    robot = without_friction(arm())
    design = shape_loop(100, np.radians(60))
    block = computed_torque_with(robot, design)
    loop = LinearLoop(robot, block, START, Timing())
    assert loop.stable
    # with equal gains M k(s) M^-1 / s^2 is diagonal: each joint has the designed loop
    for j in range(6):
        assert loop.joint(j + 1).crossover == pytest.approx(100, rel=0.01)
        assert np.degrees(loop.joint(j + 1).phase) == pytest.approx(60, abs=1)


def test_fastest_stays_below_the_peak() -> None:
    robot = arm()
    bandwidth, block = fastest(
        robot, lambda w: controller("gravity_pd", robot, bandwidth=w), [START], peak=1.8
    )
    assert over_poses(robot, block, [START]).coupled_peak <= 1.8
    over = controller("gravity_pd", robot, bandwidth=1.1 * bandwidth)
    assert over_poses(robot, over, [START]).coupled_peak > 1.8


def test_says_what_cannot_be() -> None:
    with pytest.raises(InfeasibleError, match="leave less than 38 deg"):
        shape_loop(400.0, np.radians(50))
    with pytest.raises(InfeasibleError, match="unstable with delay"):
        place_poles(400.0, timing=Timing(delay_samples=3))
    with pytest.raises(InputError, match="positive numbers"):
        place_poles(-1.0)
    with pytest.raises(InputError, match="expected 1 or 6"):
        computed_torque_with(arm(), [place_poles(60.0)] * 2)
    assert frequencies(1e-3)[-1] < np.pi / 1e-3


@pytest.mark.parametrize(
    ("crossover", "phase", "says"),
    [
        (np.nan, 1.0, "crossover of nan rad/s"),
        (-120.0, 1.0, "crossover of -120 rad/s"),
        (5000.0, 1.0, "expected 0 to 3142 rad/s"),
        (120.0, 60.0, "phase margin of 60 rad"),
    ],
)
def test_a_loop_that_is_none_is_not_shaped(crossover: float, phase: float, says: str) -> None:
    with pytest.raises(InputError, match=says):
        shape_loop(crossover, phase)


def test_margins_of_a_controller_with_guards_are_refused() -> None:
    """They were those of a loop that is not closed: UNSTABLE, any gain, any delay."""
    with pytest.raises(InputError, match="linearise it before `guarded`"):
        over_poses(arm(), guarded(controller("computed_torque", arm()), arm()), START)


def test_a_controller_of_another_arm_is_not_guarded() -> None:
    with pytest.raises(InputError, match="is of an arm of 6 joints, the robot has 2"):
        guarded(controller("pid", arm()), planar())


def test_elastic_joint_in_the_linearised_arm() -> None:
    """Locked motor frequency and the two-mass resonance of joint 1, and the step of the simulated
    plant."""
    from irb2400_ctrl.codegen import compile_block
    from irb2400_ctrl.simulation.plant import plant_block

    robot = with_effect(
        without_friction(arm()),
        "elastic_joint",
        1,
        {"stiffness_Nm_rad": 4e4, "damping_ratio": 0.02},
    )
    robot = with_effect(robot, "rotor_inertia", 1, {"inertia_kgm2": 15.0})
    system = linearize(robot, START)
    assert system.nstates == 14
    free = 1 / np.linalg.inv(Model(arm()).mass_matrix(START))[0, 0]
    resonance = np.sqrt(4e4 * (1 / 15.0 + 1 / free))
    frequencies_found = np.abs(np.linalg.eigvals(system.A))
    assert np.min(np.abs(frequencies_found - resonance)) < 0.02 * resonance
    # a small torque pulse on the simulated plant gives the linear answer
    plant = compile_block(plant_block(robot, 1e-4))
    values = {f.name: f.start for f in plant.block.states}
    link, load = hanging(robot, START, np.zeros(6))
    values |= {"q": START, "link": link[:1]}
    push = np.array([0.5, 0, 0, 0, 0, 0])
    states, _ = plant.rollout(
        np.tile(load + push, (200, 1)),
        x0=np.concatenate([values[f.name] for f in plant.block.states]),
    )
    import control

    answer = control.forced_response(
        system, np.arange(201) * 1e-4, np.tile(push[:, None], (1, 201))
    )
    np.testing.assert_allclose(states[:, 0] - START[0], answer.outputs[0], atol=2e-8)


def test_a_loaded_spring_that_stiffens_is_stiffer_in_the_linearised_arm() -> None:
    k = 4e4
    stiffening = 2000.0
    spring = {"stiffness_Nm_rad": k, "damping_ratio": 0.02, "stiffening_per_rad": stiffening}
    robot = with_effect(without_friction(arm()), "elastic_joint", 3, spring)
    robot = with_effect(robot, "rotor_inertia", 3, {"inertia_kgm2": 15.0})
    _, load = hanging(robot, START, np.zeros(6))
    pushed = abs(stiffening * load[2] / k)
    assert pushed > 1
    # what the motor feels of its own angle
    slope = linearize(robot, START).A[9, 2]
    assert slope == pytest.approx(-k * np.hypot(1, pushed) / 15.0, rel=1e-6)
