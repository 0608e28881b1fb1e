"""Integral action, adaptation, momentum observer and guards: each does what it is for."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from simulation.arms import START, STOP, arm, quintic_move, strong, with_effect, without_friction

from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.controllers import controller, guarded, momentum_observer
from irb2400_ctrl.controllers.parts import back_calculated
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.simulation import (
    IDEAL_ACTUATORS,
    IDEAL_SENSORS,
    Simulation,
    Trajectory,
    perturbed_robot,
    simulate,
)

MOVE = quintic_move(START, STOP, 1.2)
STILL = quintic_move(START, START, 1.0)


def test_an_integral_that_winds_back_within_a_sample_stops_at_the_limit() -> None:
    after = back_calculated(ca.SX(5.0), ca.SX(0.0), ca.SX(-2.0), ca.SX(1e-4), 1e-3)
    assert float(after) == 3.0


def there_and_back(times: int, duration: float = 0.9) -> Trajectory:
    """The same two poses, again and again."""
    legs = [quintic_move(START, STOP, duration), quintic_move(STOP, START, duration)]
    parts = [legs[k % 2] for k in range(times)]
    time = np.concatenate([[0.0], *(k * duration + p.time[1:] for k, p in enumerate(parts))])
    q, qd, qdd = (
        np.vstack([getattr(parts[0], name)[:1], *(getattr(p, name)[1:] for p in parts)])
        for name in ("q", "qd", "qdd")
    )
    return Trajectory(time, q, qd, qdd)


def rms(run: Simulation, share: slice = slice(None)) -> float:
    return float(np.sqrt(np.mean(run.tcp_error[share] ** 2)))


def test_integral_action_removes_an_unknown_weight() -> None:
    plant = with_effect(arm(), "payload", None, {"mass_kg": 8.0, "com_m": (0.05, 0.0, 0.15)})
    plain, integral = (
        simulate(arm(), MOVE, n, plant=plant)
        for n in ("computed_torque", "computed_torque_integral")
    )
    assert rms(integral) < 0.7 * rms(plain)


def test_the_integral_does_not_hunt_at_rest() -> None:
    run = simulate(
        arm(), MOVE, "computed_torque_integral", plant=perturbed_robot(arm(), 3), hold=2.0
    )
    inside = np.abs(run.q[-1500] - run.q_ref[-1]) < 0.9e-4
    assert inside.any()
    tau = run.tau[-1400:, inside]
    np.testing.assert_allclose(
        run.q[-1400:, inside], np.tile(run.q[-1, inside], (1400, 1)), atol=1e-12
    )
    assert np.ptp(tau, axis=0).max() < 30


def test_adaptation_learns_the_load() -> None:
    load = (6.0, (0.05, 0.0, 0.15))
    plant = with_effect(
        without_friction(arm()), "payload", None, {"mass_kg": load[0], "com_m": load[1]}
    )
    motion = there_and_back(8)
    run = simulate(without_friction(arm()), motion, "adaptive", plant=plant, sensors=IDEAL_SENSORS)
    assert rms(run, slice(-900, None)) < 0.2 * rms(run, slice(0, 900))


def test_adaptation_beats_the_fixed_model_with_a_load_and_friction() -> None:
    plant = with_effect(
        perturbed_robot(arm(), 2), "payload", None, {"mass_kg": 8.0, "com_m": (0.05, 0.0, 0.15)}
    )
    motion = there_and_back(4)
    fixed, integral, learned = (
        simulate(arm(), motion, n, plant=plant)
        for n in ("computed_torque", "computed_torque_integral", "adaptive")
    )
    assert rms(learned) < 0.4 * rms(fixed)
    assert rms(learned) < rms(integral)


def observed(run: Simulation, bandwidth: float = 60.0) -> dict[str, np.ndarray]:
    observer = compile_block(momentum_observer(run.robot, bandwidth=bandwidth))
    inputs = np.hstack([run.signals["q_seen"], run.signals["qd_seen"], run.tau])
    _, outputs = observer.rollout(inputs)
    return observer.split(observer.block.outputs, outputs)


def test_observer_sees_nothing_on_the_nominal_arm() -> None:
    run = simulate(
        strong(without_friction(arm())),
        MOVE,
        "computed_torque",
        sensors=IDEAL_SENSORS,
        actuators=IDEAL_ACTUATORS,
    )
    assert np.abs(observed(run)["tau_ext"] / arm().tau_max).max() < 2e-3


def test_observer_agrees_with_a_force_torque_sensor() -> None:
    """A force that rises and stays while the arm moves: the estimate follows with its time
    constant."""
    robot = strong(without_friction(arm()))
    time = MOVE.at_rate(1000.0).time
    wrench = np.zeros((len(time), 6))
    wrench[time > 0.3] = [60.0, -40.0, 90.0, 3.0, -2.0, 4.0]
    run = simulate(
        robot,
        MOVE,
        "computed_torque",
        wrench=wrench,
        sensors=IDEAL_SENSORS,
        actuators=IDEAL_ACTUATORS,
    )
    seen = observed(run)
    truth = np.einsum("kij,ki->kj", Model(robot).tcp_jacobian(run.q), wrench)
    late = time > 0.3 + 6 / 60
    assert np.abs(seen["tau_ext"] - truth)[late].max() < 0.05 * np.abs(truth).max()
    np.testing.assert_allclose(seen["wrench"][late], wrench[late], atol=4.0)
    rise = seen["wrench"][(time > 0.3) & (time < 0.3 + 1 / 60 + 5e-4), 2][-1]
    assert rise / 90.0 == pytest.approx(1 - np.exp(-1), abs=0.08)


def test_observer_on_a_rough_arm_knows_the_push_while_all_joints_move() -> None:
    robot = arm()
    time = MOVE.at_rate(1000.0).time
    wrench = np.zeros((len(time), 6))
    wrench[time > 0.3, 2] = 100.0
    runs = [simulate(robot, MOVE, "computed_torque", wrench=w) for w in (wrench, 0 * wrench)]
    moving = (time > 0.45) & (time < 0.9)
    force = [observed(run)["wrench"][moving, 2] for run in runs]
    assert np.mean(force[0]) == pytest.approx(100.0, abs=15.0)
    assert abs(np.mean(force[1])) < 15.0


def test_guard_starts_without_a_bump_from_any_held_torque() -> None:
    block = guarded(controller("computed_torque", arm()), arm())
    run = simulate(arm(), STILL, block, plant=with_effect(arm(), "payload", None, {"mass_kg": 3.0}))
    assert np.abs(np.diff(run.signals["command"], axis=0)).max() < 0.03 * np.abs(run.tau).max()
    assert np.abs(run.q - START).max() < 2e-3


def test_guard_limits_the_torque_rate() -> None:
    block = guarded(controller("gravity_pd", arm()), arm(), torque_rate=2000.0, start_time=0.0)
    jump = quintic_move(START, START + 0.2, 0.12)
    run = simulate(arm(), jump, block)
    steps = np.abs(np.diff(run.signals["command"], axis=0)).max()
    assert steps == pytest.approx(2.0, rel=1e-9)


def test_guard_bridges_lost_samples_and_brakes_when_too_many_are_lost() -> None:
    block = guarded(controller("computed_torque", arm()), arm(), most_lost=20)
    m = len(MOVE.at_rate(1000.0).time)
    lost = np.zeros(m, bool)
    lost[400:408] = lost[700:715] = True
    bridged, whole = (simulate_with(block, lost_) for lost_ in (lost, None))
    assert bridged.signals["c_brake"].max() == 0
    assert bridged.tcp_error.max() < 3 * whole.tcp_error.max() + 1e-3
    lost[500:540] = True
    braked = simulate_with(block, lost)
    assert braked.signals["c_brake"][519, 0] == 0
    assert (braked.signals["c_brake"][520:, 0] == 1).all()
    assert np.ptp(braked.signals["command"][520:], axis=0).max() == 0


def simulate_with(block, lost) -> Simulation:
    from irb2400_ctrl.simulation import make_loop

    return make_loop(arm(), block).run(MOVE, lost=lost)


def test_lost_samples_need_a_guard() -> None:
    with pytest.raises(InputError, match="no input 'fresh'"):
        simulate_with(controller("pid", arm()), np.zeros(1201, bool))
    with pytest.raises(InputError, match="a guard expects"):
        guarded(momentum_observer(arm()), arm())


def test_guarded_integrator_is_filled_at_the_start() -> None:
    run = simulate(arm(), STILL, guarded(controller("pid", arm()), arm()))
    assert np.abs(run.q - START).max() < 1e-6
