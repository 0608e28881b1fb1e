"""A controller that is sampled too seldom for its gains is not delivered as one that works."""

from __future__ import annotations

import subprocess
from functools import partial
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from command_line import irb2400
from simulation.arms import without_friction
from simulation.other_arms import ACROSS, SINGLE, arm_of

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import FAULT_PARAMETERS, Package
from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded, momentum_observer
from irb2400_ctrl.controllers.design import over_poses
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.sampling import _Loops, check_sampled_loop, postures
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import joint_move
from irb2400_ctrl.robot.changed import changed
from irb2400_ctrl.trajectory import save_trajectory

ROBOT = irb.load_robot("irb2400")
UR10E = irb.load_robot("ur10e")


@pytest.mark.parametrize("robot", [ROBOT, UR10E], ids=["irb2400", "ur10e"])
@pytest.mark.parametrize("name", CONTROLLERS)
def test_every_controller_as_it_is_suits_its_own_rate(name: str, robot: irb.Robot) -> None:
    assert check_sampled_loop(robot, partial(controller, name, robot), 0.001) == ""


def build(bandwidth: float, sample_time: float) -> Block:
    return controller("computed_torque", ROBOT, sample_time=sample_time, bandwidth=bandwidth)


def grows(bandwidth: float, sample_time: float, steps: int = 400) -> bool:
    """Whether a ten-thousandth of a radian grows where the controller moves its own model, held
    torque and Runge-Kutta between two samples."""
    step = build(bandwidth, sample_time).step
    model = irb.Model(ROBOT)
    hold = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    off = 1e-4 * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    names = step.name_in()
    given = {f.name: f.start for f in build(bandwidth, sample_time).parameters}
    arm = model.function("forward_dynamics_without_friction")
    x = ca.SX.sym("x", 12)
    tau = ca.SX.sym("tau", 6)
    rate = ca.Function("rate", [x, tau], [ca.vertcat(x[6:], arm(x[:6], x[6:], tau, 0))])
    h = sample_time / 4
    now: ca.SX = x
    for _ in range(4):
        k1 = rate(now, tau)
        k2 = rate(now + h / 2 * k1, tau)
        k3 = rate(now + h / 2 * k2, tau)
        now = now + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(now + h * k3, tau))
    plant = ca.Function("plant", [x, tau], [now])
    state = np.concatenate([hold + off, np.zeros(6)])
    for _ in range(steps):
        values = {"q": state[:6], "qd": state[6:], "q_ref": hold, **given}
        result = step(*(values.get(n, np.zeros(6)) for n in names))
        torque = result[-1] if isinstance(result, tuple) else result
        state = np.asarray(plant(state, torque)).ravel()
        if np.abs(state[:6] - hold).max() > 1e-2:
            return True
    return bool(np.abs(state[:6] - hold).max() > 1e-4)


@pytest.mark.parametrize(("bandwidth", "sample_time"), [(60.0, 0.017), (200.0, 0.006)])
def test_what_is_refused_runs_away(bandwidth: float, sample_time: float) -> None:
    assert grows(bandwidth, sample_time)
    with pytest.raises(InputError, match=r"unstable on its own arm.*sample every"):
        check_sampled_loop(ROBOT, partial(build, bandwidth), sample_time)


@pytest.mark.parametrize(("bandwidth", "sample_time"), [(60.0, 0.016), (200.0, 0.0045)])
def test_what_an_ideal_drive_can_do_is_remarked_on(bandwidth: float, sample_time: float) -> None:
    assert not grows(bandwidth, sample_time)
    assert "a sample late" in check_sampled_loop(ROBOT, partial(build, bandwidth), sample_time)


@pytest.mark.parametrize("joint", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_simulate_says_what_codegen_says_of_an_unstable_loop(joint: int, tmp_path: Path) -> None:
    """A rigid law on an elastic joint swung up, and nothing said why."""
    soft = ROBOT.with_effects(
        LIBRARY["elastic_joint"].of(joint, stiffness_Nm_rad=1e5),
        LIBRARY["rotor_inertia"].of(joint, inertia_kgm2=2.0),
    )
    irb.robot.save_robot(soft, tmp_path / "soft.toml")
    move = joint_move(irb.Model(soft), np.zeros(6), np.full(6, 0.1)).trajectory
    save_trajectory(move, tmp_path / "t.csv")
    asked = ("--robot", tmp_path / "soft.toml", "--controller", "computed_torque", "--out")
    simulated = irb2400("simulate", tmp_path / "t.csv", *asked, tmp_path / "s")
    delivered = irb2400("codegen", *asked, tmp_path / "c")
    assert simulated.returncode == 0
    assert "an error doubles" in simulated.stderr
    assert delivered.stderr.startswith(simulated.stderr.splitlines()[0])


@pytest.mark.parametrize("name", ["gravity_pd", "computed_torque"])
def test_an_arm_without_gains_is_guided_by_hand(name: str) -> None:
    """On the ur10e it was "unstable": a held torque balances the weight of a sample ago."""
    build = partial(controller, name, UR10E, bandwidth=0.0)
    assert check_sampled_loop(UR10E, build, 0.001) == ""
    # at a low rate it falls within a second
    with pytest.raises(InputError, match="unstable on its own arm"):
        check_sampled_loop(UR10E, build, 0.02)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_held_torque_lets_an_arm_fall_as_fast_as_is_said(delay: int, tmp_path: Path) -> None:
    """And not at all where it hangs."""
    T = 0.001
    timing = Timing(T, delay_samples=delay, speed_filter_Hz=0.0)
    (turns, body), *_ = SINGLE
    pendulum = arm_of((((turns[0], ACROSS, *turns[2:]), body),), "pendulum", tmp_path)
    upright_and_hanging = np.array([[-np.pi / 2], [np.pi / 2]])
    for robot, poses in ((ROBOT, postures(ROBOT)), (pendulum, upright_and_hanging)):
        loops = _Loops(without_friction(robot), poses)
        block = controller("gravity_pd", robot, T, bandwidth=0.0)
        found = [
            np.log(np.abs(LinearLoop(loops.robot, block, q, timing).poles).max()) / T for q in poses
        ]
        falls = np.maximum(T * (delay + 0.5) * loops.weights, 0.0)
        np.testing.assert_allclose(found, falls, rtol=0.02, atol=2e-3)


def test_gains_that_no_rate_makes_good_are_said_to_be_that() -> None:
    """An integral that turns faster than its loop; "lower the bandwidth" would make it worse."""
    build = partial(controller, "pid", ROBOT, integral_time=1e-3)
    with pytest.raises(InputError, match=r"ask for other gains, .* a rate 128 times as high"):
        check_sampled_loop(ROBOT, build, 0.001)


def test_postures_are_within_a_box_beyond_half_a_turn() -> None:
    turned = changed(ROBOT, ["joints.6.limits.range_deg=[200, 900]"])
    poses = postures(turned)
    assert np.all((poses >= turned.q_min) & (poses <= turned.q_max))
    spread = np.ptp(poses, axis=0)
    assert np.all((spread > 0.5) & (spread < 2 * np.pi))
    assert poses[0] == pytest.approx((turned.q_min + turned.q_max) / 2)


def asked(out: Path, name: str, *options: object) -> subprocess.CompletedProcess[str]:
    """What `irb2400 codegen` does with a controller."""
    return irb2400("codegen", "--controller", name, *options, "--out", out)


def test_the_command_refuses_twenty_milliseconds(tmp_path: Path) -> None:
    """They were "passed"."""
    done = asked(tmp_path, "computed_torque", "--sample-time", 0.02, "--bandwidth", 60)
    assert done.returncode == 2
    assert "doubles every 0.031 s" in done.stderr
    assert "sample every 0.005 s" in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("robot", [ROBOT, UR10E], ids=["irb2400", "ur10e"])
@pytest.mark.parametrize("name", ["computed_torque", "computed_torque_integral", "adaptive"])
def test_a_bandwidth_that_nobody_states_suits_the_sample_time(name: str, robot: irb.Robot) -> None:
    poses = np.vstack([postures(robot)[:1], postures(robot)[-3:]])
    for sample_time in (0.001, 0.004, 0.008):
        block = controller(name, robot, sample_time)
        assert over_poses(robot, block, poses).coupled_peak < 2.7


@pytest.mark.parametrize(("sample_time", "peak"), [(0.004, 4.3), (0.005, 17.1)])
def test_sixty_radians_a_second_are_too_many_for_a_slow_drive(
    sample_time: float, peak: float
) -> None:
    """The default at every sample time."""
    worst = over_poses(ROBOT, build(60.0, sample_time), postures(ROBOT)[:1])
    assert worst.coupled_peak == pytest.approx(peak, rel=0.02)


def test_the_command_remarks_on_what_a_drive_spoils(tmp_path: Path) -> None:
    done = asked(tmp_path, "gravity_pd", "--sample-time", 0.004, "--bandwidth", 40)
    assert done.returncode == 0
    assert "a sample late" in done.stderr
    assert "sample every 0.002 s" in done.stderr
    wide = asked(tmp_path, "computed_torque", "--bandwidth", 5000)
    assert wide.returncode == 2
    assert "a lower bandwidth" in wide.stderr


def test_an_observer_is_slower_than_its_samples() -> None:
    with pytest.raises(InputError, match="at most 1000 rad/s"):
        momentum_observer(ROBOT, bandwidth=3000.0)
    with pytest.raises(InputError, match=r"at most 50 rad/s.*--bare"):
        guarded(build(20.0, 0.02), ROBOT)
    assert guarded(build(20.0, 0.02), ROBOT, consistency=False).name == "computed_torque"
    package = Package(momentum_observer(ROBOT), "double")
    host = HostController(package)
    assert host.init_status == 0
    names = [f.name for f in package.parameter_fields]
    table = host.parameters
    table[6 * names.index("observer")] = 3000.0
    host.parameters = table
    host.reset()
    assert host.init_status == FAULT_PARAMETERS


def test_an_arm_that_cannot_hold_itself_is_not_told_to_change_its_gains() -> None:
    weak = changed(ROBOT, [f"joints.{k}.limits.torque_Nm=5" for k in range(1, 7)])
    with pytest.raises(InputError, match=r"cannot hold its own weight in any of \d+ postures, at"):
        check_sampled_loop(weak, partial(controller, "computed_torque", weak), 0.001)
