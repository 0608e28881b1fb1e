"""Friction at low speed that `identify` writes is one that a robot file may hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.prior import prior_of

STICKS = 5e-4
"""[rad] from a turn of a joint to the middle of the turn of its dry friction"""


def held_back(q: Array) -> Array:
    """Direction of dry friction whose contacts stick before they slide, shape of q, in -1..1."""
    z = np.zeros_like(q)
    for k, step in enumerate(np.diff(q, axis=0), start=1):
        z[k] = np.clip(z[k - 1] + step / STICKS, -1.0, 1.0)
    return z


def sticking_log(robot: irb.Robot) -> irb.Log:
    """Slow sines of an arm whose friction turns over late, behind a recorder without commands."""
    rng = np.random.default_rng(5)
    time = np.arange(0.0, 40.0, 0.004)
    q, qd, qdd = (np.zeros((len(time), robot.n)) for _ in range(3))
    for harmonic in range(1, 8):
        w = 2 * np.pi * harmonic / 16.0
        size = rng.normal(size=robot.n) * 0.2 / harmonic**0.6
        phase = w * time[:, None] + rng.uniform(0.0, 2 * np.pi, robot.n)
        q += size * np.sin(phase)
        qd += size * w * np.cos(phase)
        qdd -= size * w**2 * np.sin(phase)
    friction = robot.friction
    tau = irb.Model(robot).inverse_dynamics(q, qd, qdd, friction=False)
    tau += friction[:, 1] * held_back(q) + friction[:, 2] * qd
    tau += rng.normal(size=tau.shape) * 0.005 * np.abs(tau).max(axis=0)
    return irb.Log(time, q, tau, q_ref=q)


def test_friction_that_turns_over_late_is_no_negative_one(tmp_path: Path) -> None:
    """A dip at low speed was written as static friction below zero, which no file may hold."""
    robot = irb.load_robot("ur10e")
    joints = tuple(
        joint.model_copy(
            update={
                "friction": joint.friction.model_copy(
                    update={"coulomb_Nm": 8.0, "viscous_Nms_rad": 6.0}
                )
            }
        )
        for joint in robot.joints
    )
    log = sticking_log(robot.model_copy(update={"joints": joints}))
    found = irb.identify(robot, log).robot
    assert (found.friction[:, 0] >= found.friction[:, 1]).all()
    irb.save_robot(found, tmp_path / "arm.toml")
    again = irb.load_robot(str(tmp_path / "arm.toml"))
    np.testing.assert_allclose(again.friction, found.friction)


def creeping_log(robot: irb.Robot) -> irb.Log:
    """Joints to and fro at 0.03 rad/s and little more, with friction that falls three times as
    slowly with speed as the file says."""
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 40.0, 0.004)
    q, qd, qdd = (np.zeros((len(time), robot.n)) for _ in range(3))
    period = rng.uniform(6.0, 9.0, robot.n)
    for place, harmonic in enumerate((1, 3, 5, 7)):  # nearly a triangle
        w = 2 * np.pi * harmonic / period
        size = (-1) ** place * 0.05 * period / (np.pi * harmonic) ** 2
        q += size * np.sin(w * time[:, None])
        qd += size * w * np.cos(w * time[:, None])
        qdd -= size * w**2 * np.sin(w * time[:, None])
    static, coulomb, viscous, speed = robot.friction.T
    tau = irb.Model(robot).inverse_dynamics(q, qd, qdd, friction=False)
    bell = np.exp(-((qd / (3.0 * speed)) ** 2))
    tau += np.tanh(qd / 0.004) * (coulomb + (static - coulomb) * bell) + viscous * qd
    tau += rng.normal(size=tau.shape) * 0.004 * np.abs(tau).max(axis=0)
    return irb.Log(time, q, tau, q_ref=q)


def test_friction_at_rest_is_not_told_from_speeds_far_above_it() -> None:
    """Samples from 0.03 rad/s on show a thousandth of a rise at 0.01: 140 and 300 Nm were written
    of a joint with 40."""
    robot = irb.load_robot("irb2400")
    found = irb.identify(robot, creeping_log(robot))
    assert all(extra.kind != "stribeck" for extra in found.layout.extras)
    assert (found.robot.friction[:, 0] < 2.0 * robot.friction[:, 0]).all()


def test_what_a_slow_log_leaves_open_does_not_stop_the_drive_at_speed() -> None:
    """How much of its friction grows with speed, 0.03 rad/s hardly say. What the file lacks was as
    wide as all torque of the log over that speed: 90 Nms/rad of a joint with 7 in a milling log."""
    robot = irb.load_robot("ur10e")
    layout = ColumnLayout(robot.n)
    torque = np.full(robot.n, 20.0)

    def width(speed: float) -> Array:
        scale = (torque, np.full(robot.n, speed), np.ones(robot.n))
        drives = prior_of(robot, layout, scale).drives
        return np.sqrt(drives)[layout.drive("viscous").start - layout.inertial :][: robot.n]

    np.testing.assert_allclose(width(2.0), torque / 2.0)
    np.testing.assert_allclose(width(0.03), torque)
