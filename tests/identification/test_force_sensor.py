"""Mass, centre and inertia of a tool from a force sensor at the flange (Tab. 4)."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.force_sensor import CHANNELS, sensed_load, with_load
from irb2400_ctrl.robot import Body

ROBOT = irb.load_robot("irb2400")
SPINDLE = Body(
    mass_kg=12.7,
    com_m=(-0.0383, 0.0, 0.1293),
    inertia_kgm2=(0.269, 0.274, 0.193, 0.0, 0.0, 0.0),
)
ZERO = np.array([5.0, -3.0, 8.0, 0.4, -0.2, 0.1])


def log_of(size: float, sign: float = 1.0, noise: float = 1.0) -> irb.Log:
    """A motion of some size [rad], and what the sensor reads: the load's joint torques, which the
    tested code does not use, through the transposed Jacobian."""
    model = irb.Model(ROBOT)
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 40.0, 0.004)
    middle = np.array([0.0, 0.2, 0.1, 0.4, 1.0, 0.0])
    q = np.tile(middle, (len(time), 1))
    qd = np.zeros_like(q)
    qdd = np.zeros_like(q)
    for j in range(6):
        for f in (0.11 + 0.03 * j, 0.31 + 0.05 * j):
            a = size / (1.0 if f < 0.3 else 6.0)
            phase = rng.uniform(0, 6.28)
            w = 2 * np.pi * f
            q[:, j] += a * np.sin(w * time + phase)
            qd[:, j] += a * w * np.cos(w * time + phase)
            qdd[:, j] -= a * w**2 * np.sin(w * time + phase)
    phi = np.zeros((6, 10))
    phi[-1] = SPINDLE.parameters(ROBOT.flange.matrix())
    torque = model.body_torque(q, qd, qdd, phi.ravel())
    wrench = np.linalg.solve(np.swapaxes(model.tcp_jacobian(q), 1, 2), torque[..., None])[..., 0]
    flange = model.flange_pose(q)
    arm = model.tcp_pose(q)[:, :3, 3] - flange[:, :3, 3]
    moment = wrench[:, 3:] + np.cross(arm, wrench[:, :3])
    turn = np.swapaxes(flange[:, :3, :3], 1, 2)
    read = np.hstack(
        [np.einsum("kij,kj->ki", turn, wrench[:, :3]), np.einsum("kij,kj->ki", turn, moment)]
    )
    read = sign * read + ZERO
    read += noise * np.array([1, 1, 1, 0.1, 0.1, 0.1]) * rng.standard_normal(read.shape)
    extra = dict(zip(CHANNELS, read.T, strict=True))
    return irb.Log(time, q, torque, extra=extra, name="sensor")


def test_the_spindle_of_the_paper_comes_back() -> None:
    found = sensed_load(ROBOT, [log_of(0.7)])
    assert found is not None
    assert found.body.mass_kg == pytest.approx(SPINDLE.mass_kg, rel=0.005)
    np.testing.assert_allclose(found.body.com_m, SPINDLE.com_m, atol=1e-3)
    inertia = np.array(found.body.inertia_kgm2) - np.array(SPINDLE.inertia_kgm2)
    assert np.abs(inertia).max() < 0.05
    np.testing.assert_allclose(found.zero, ZERO, atol=0.6)
    assert abs(found.body.mass_kg - SPINDLE.mass_kg) < 4 * found.errors[0]
    assert (np.abs(np.subtract(found.body.com_m, SPINDLE.com_m)) < 4 * found.errors[1:4]).all()
    tool = with_load(ROBOT, found).tool
    assert tool is not None
    assert tool.body == found.body


def test_one_posture_is_refused_and_so_is_the_other_sign() -> None:
    with pytest.raises(InputError, match="several postures"):
        sensed_load(ROBOT, [log_of(0.02)])
    with pytest.raises(InputError, match="turn the signs"):
        sensed_load(ROBOT, [log_of(0.7, sign=-1.0)])


def test_a_log_without_the_columns_has_none() -> None:
    log = log_of(0.7)
    assert sensed_load(ROBOT, [irb.Log(log.time, log.q, log.tau)]) is None
    assert with_load(ROBOT, None) is ROBOT
