"""Effects that change with the time since the start, or remember: a clock that keeps time in single
precision, and a guard and an observer that know what time it is and which way a joint came."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded, momentum_observer
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import from_angles

ROBOT = irb.load_robot("irb2400")
START = np.radians([0.0, 0.0, 20.0, 0.0, 40.0, 0.0])
JOINT = 4
COLD = 28.0
"""[Nm s/rad]"""


def warming(time_constant: float) -> irb.Robot:
    """An arm whose fourth axis is stiff until its grease is warm."""
    kind = LIBRARY["viscous_warmup"]
    return ROBOT.with_effects(kind.of(JOINT, viscous_Nms_rad=COLD, time_constant_s=time_constant))


def torque_at(block: Block, real: str, samples: int) -> float:
    """Of the fourth axis, at a steady speed, so many samples after the start less a few, which are
    run."""
    running = HostController(Package(block, real))  # type: ignore[arg-type]
    given = {f.name: np.zeros(f.size) for f in block.inputs}
    given["q"] = given["q_ref"] = START
    given["qd"] = given["qd_ref"] = np.eye(ROBOT.n)[JOINT - 1]
    u = np.concatenate([given[f.name] for f in block.inputs])
    few = 2000
    names = [f.name for f in block.states]
    x = running.state
    stretch = 2**22
    x[names.index("clock")] = (samples - few) // stretch * (stretch * block.sample_time)
    x[names.index("clock_samples")] = (samples - few) % stretch
    running.state = x
    for _ in range(few):
        running.step(u)
    return float(running.step(u)[0][JOINT - 1])


def test_a_controller_remembers_along_the_reference_and_an_observer_along_the_motion() -> None:
    """As friction does: at a turn the measured speed is noise."""
    robot = ROBOT.with_effects(LIBRARY["hysteresis"].of(JOINT, amplitude_Nm=5.0, width_rad=0.01))
    speed = np.eye(robot.n)[JOINT - 1]
    given = {"q": START, "q_ref": START, "qd": -speed, "qd_ref": speed}
    for block, side in (
        (controller("computed_torque", robot), 1.0),
        (momentum_observer(robot), -1),
    ):
        running = HostController(Package(block, "double"))
        u = [given.get(field.name, np.zeros(field.size)) for field in block.inputs]
        for _ in range(100):
            running.step(np.concatenate(u))
        sizes = [field.size for field in block.states]
        names = np.repeat([field.name for field in block.states], sizes)
        assert running.state[: len(names)][names == f"hysteresis_{JOINT}_0"] == pytest.approx(
            side, abs=1e-3
        )


@pytest.mark.parametrize("sample_time", [1e-3, 1e-4, 1e-5])
def test_the_clock_goes_on_in_single_precision(sample_time: float) -> None:
    """A sum of sample times stood still at 10 kHz after 34 minutes, and ran 2 % slow before."""
    robot = warming(2000.0)
    block = controller("computed_torque", robot, sample_time=sample_time)
    warm = torque_at(controller("computed_torque", warming(1e-3), sample_time), "double", 2**20)
    for samples in (5_000, 2**22 + 1000, 2**24 + 1000, 10**9):
        after = torque_at(block, "float", samples)
        expected = COLD * np.exp(-samples * sample_time / 2000.0)
        assert after - warm == pytest.approx(expected, abs=1e-3), samples


def test_the_clock_starts_anew_with_init() -> None:
    block = controller("computed_torque", warming(20.0))
    running = HostController(Package(block, "float"))
    first = running.state
    for _ in range(100):
        running.step(running.package.initial_input())
    assert running.state[1] == 100
    running.reset()
    np.testing.assert_array_equal(running.state, first)


def swing(seconds: float) -> irb.Trajectory:
    """All axes to and fro, from rest."""
    time = np.arange(0.0, seconds, 0.004)
    share = np.minimum(time / 2.0, 1.0)
    share = share**3 * (10 - 15 * share + 6 * share**2)
    size = np.array([0.8, 0.4, 0.3, 0.8, 0.6, 1.0])
    way = size * np.sin(np.array([1.2, 1.5, 1.1, 1.9, 2.3, 2.9]) * time[:, None])
    return from_angles(time, START + share[:, None] * way)


@pytest.mark.parametrize("name", ["computed_torque", "pid"])
def test_a_guard_knows_that_the_grease_is_warm(name: str) -> None:
    """Its observers took the torque of the start for the whole day and closed the brake after two
    seconds; a controller that knows no effect has no clock to lend them."""
    robot = warming(4.0)
    block = guarded(controller(name, robot), robot)
    run = irb.simulate(robot, swing(8.0), block)
    assert not run.signals["c_brake"].any()


@pytest.mark.parametrize(("joint", "amplitude", "width"), [(5, 12.0, 0.02), (2, 30.0, 0.05)])
def test_a_guard_remembers_which_way_a_joint_came(
    joint: int, amplitude: float, width: float
) -> None:
    """The joint's own dry friction that builds up over an angle: observers that took it for built
    up closed the brake after a reversal."""
    loop = LIBRARY["hysteresis"].of(
        joint, amplitude_Nm=amplitude, width_rad=width, replaced_Nm=amplitude
    )
    robot = ROBOT.with_effects(loop)
    run = irb.simulate(robot, swing(4.0), guarded(controller("computed_torque", robot), robot))
    assert not run.signals["c_brake"].any()


def test_the_observer_sees_no_torque_where_the_grease_is_warm() -> None:
    """Along the motion of the model itself, an hour after the start."""
    robot = warming(20.0)
    block = momentum_observer(robot)
    running = HostController(Package(block, "double"))
    x = running.state
    x[robot.n + 1] = 3600.0
    running.state = x
    assert [f.name for f in block.states][:3] == ["explained", "running", "clock"]
    model = irb.Model(ROBOT)
    qd = np.eye(ROBOT.n)[JOINT - 1]
    for k in range(400):
        q = START + 1e-3 * k * qd
        tau = model.inverse_dynamics(q, qd, np.zeros(ROBOT.n))
        found, status = running.step(np.concatenate([q, qd, tau]))
        assert status == 0
    assert abs(found[JOINT - 1]) < 0.1


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_observer_refuses_angles_that_cannot_be(real: str) -> None:
    """In single precision the sine of 2000 rad is a number like any other, and wrong."""
    running = HostController(Package(momentum_observer(ROBOT), real))  # type: ignore[arg-type]
    rest = np.concatenate([START, np.zeros(12)])
    good, status = running.step(rest)
    assert status == 0
    for place, value in ((0, 2000.0), (2, 7.0), (6, 100.0)):
        wrong = rest.copy()
        wrong[place] = value
        held, status = running.step(wrong)
        assert status == 1
        np.testing.assert_array_equal(held, good)
