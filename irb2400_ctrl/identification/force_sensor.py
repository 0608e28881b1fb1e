"""What hangs on a force sensor at the flange: mass, centre, inertia (as the paper's Tab. 4).

The sensor reads what the flange gives to the load, in the flange's axes about its origin:

    f = m A + alpha x m c + w x (w x m c) + f0,    n = I alpha + w x (I w) + m c x A + n0,

A the acceleration of the origin less gravity, w and alpha the turning, f0, n0 the zero of the
sensor. Several postures at rest show m, m c and the zero; the inertia I needs brisk turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, cross_matrices
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.fitting.consistent_fit import consistent_minimum
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body, Robot

CHANNELS = ("fx_N", "fy_N", "fz_N", "nx_Nm", "ny_Nm", "nz_Nm")
"""columns of a log that hold the sensor"""
RATE = 20.0
"""[Hz] rows that are looked at"""
BLOCKS = 30
"""stretches of time whose scatter gives the errors"""
SIZE = 0.1
"""[m] radius of gyration where brisk turns do not show the inertia, known to a factor"""
LEAST_TURN = 0.2
"""spread of the direction of gravity in the flange's axes, of 1, that shows mass and centre"""


@dataclass(frozen=True)
class SensedLoad:
    """The load in the flange's axes.

    Args:
        body: as in Tab. 4; errors: standard ones of mass [kg], centre [m] (3), and I_O about the
            flange's origin [kg m2] (6); zero: f0, n0 of the sensor, (6,) [N, Nm].
    """

    body: Body
    errors: Array
    zero: Array

    def says(self) -> list[str]:
        """Lines for the reader."""
        e = 1.96 * self.errors
        centre = ", ".join(
            f"{1000 * c:.1f} ± {1000 * w:.1f}" for c, w in zip(self.body.com_m, e[1:4], strict=True)
        )
        return [
            f"force sensor: the load weighs {self.body.mass_kg:.3f} ± {e[0]:.3f} kg, its centre at "
            f"({centre}) mm in the flange's axes"
        ]

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        return {
            "mass_kg": self.body.mass_kg,
            "com_m": list(self.body.com_m),
            "inertia_kgm2": list(self.body.inertia_kgm2),
            "standard_errors": {
                "mass_kg": float(self.errors[0]),
                "com_m": [float(v) for v in self.errors[1:4]],
                "inertia_about_flange_kgm2": [float(v) for v in self.errors[4:]],
            },
            "sensor_zero": [float(v) for v in self.zero],
        }


def sensed_load(robot: Robot, logs: Sequence[Log]) -> SensedLoad | None:
    """The load from all logs that hold the columns of a sensor; None if none does.

    Raises:
        InputError: too few postures, or forces of the other sign.
    """
    with_sensor = [log for log in logs if all(name in log.extra for name in CHANNELS)]
    if not with_sensor:
        return None
    model = Model(robot.bare())
    rows, read = (
        np.concatenate(some)
        for some in zip(*(_rows(model, robot, log) for log in with_sensor), strict=True)
    )
    falls = rows[:, :3, 0]
    # at rest A is minus gravity: its direction has to change for the zero to be told from weight
    spread = np.linalg.svd(falls - falls.mean(axis=0), compute_uv=False) / np.sqrt(len(falls))
    if spread[1] < LEAST_TURN * np.linalg.norm(robot.gravity_m_s2):
        raise InputError(
            "force sensor: found the flange in nearly one direction, expected several postures "
            "(turn the wrist by 90 degrees at least, about two axes)"
        )
    return _fitted(rows, read)


def with_load(robot: Robot, load: SensedLoad | None) -> Robot:
    """The robot whose tool is what the sensor weighed; one without a tool holds it in its last
    link."""
    if load is None or robot.tool is None:
        return robot
    return robot.model_copy(update={"tool": robot.tool.model_copy(update={"body": load.body})})


def _rows(model: Model, robot: Robot, log: Log) -> tuple[Array, Array]:
    """d (f, n) / d (phi, zero), (k, 6, 16), and what was read, (k, 6)."""
    motion = prepare(log)
    poses = model.flange_pose(motion.q)
    R = np.swapaxes(poses[:, :3, :3], 1, 2)
    h = motion.step
    speed = np.einsum("kij,kj->ki", model.tcp_jacobian(motion.q)[:, 3:], motion.qd)
    acceleration = np.gradient(np.gradient(poses[:, :3, 3], h, axis=0), h, axis=0)
    A = np.einsum("kij,kj->ki", R, acceleration - np.array(robot.gravity_m_s2))
    w = np.einsum("kij,kj->ki", R, speed)
    alpha = np.einsum("kij,kj->ki", R, np.gradient(speed, h, axis=0))
    k = len(A)
    found = np.zeros((k, 6, 16))
    found[:, :3, 0] = A
    found[:, :3, 1:4] = cross_matrices(alpha) + cross_matrices(w) @ cross_matrices(w)
    found[:, 3:, 1:4] = -cross_matrices(A)
    found[:, 3:, 4:10] = _turning(alpha) + cross_matrices(w) @ _turning(w)
    found[:, :, 10:] = np.eye(6)
    read = np.column_stack([np.interp(motion.time, log.time, log.extra[c]) for c in CHANNELS])
    every = slice(2, -2, max(1, round(1.0 / (RATE * h))))
    return found[every], read[every]


def _turning(v: Array) -> Array:
    """d (I v) / d (Ixx, Ixy, Ixz, Iyy, Iyz, Izz), (k, 3, 6)."""
    x, y, z = v.T
    found = np.zeros((len(v), 3, 6))
    for row, column, value in (
        (0, 0, x), (0, 1, y), (0, 2, z), (1, 1, x), (1, 3, y),
        (1, 4, z), (2, 2, x), (2, 4, y), (2, 5, z),
    ):  # fmt: skip
        found[:, row, column] = value
    return found


def _fitted(rows: Array, read: Array) -> SensedLoad:
    """Least squares over bodies that can exist, forces and moments over what each leaves."""
    sigma: Array = np.ones(6)
    theta: Array = np.zeros(16)
    for _ in range(4):
        flat = (rows / sigma[:, None]).reshape(-1, 16)
        theta = np.asarray(np.linalg.lstsq(flat, (read / sigma).ravel(), rcond=None)[0], float)
        left = read - rows @ theta
        both = np.sqrt([np.mean(left[:, :3] ** 2), np.mean(left[:, 3:] ** 2)])
        sigma = np.asarray(np.maximum(np.repeat(both, 3), 1e-6), dtype=float)
    if theta[0] <= 0.0:
        raise InputError(
            f"force sensor: found a mass of {theta[0]:.2f} kg, expected a positive one: columns "
            f"{CHANNELS[0]} ... {CHANNELS[-1]} are what the flange gives to the load, in the "
            "flange's axes; turn the signs if the sensor reads the load's weight"
        )
    mass = theta[0]
    wide = np.concatenate([np.full(4, np.inf), np.full(6, mass * SIZE**2), np.full(6, np.inf)])
    wide[[5, 6, 8]] *= 0.5
    precision = 1.0 / wide**2
    middle = np.zeros(16)
    middle[[4, 7, 9]] = mass * SIZE**2
    flat = (rows / sigma[:, None]).reshape(-1, 16)
    A = flat.T @ flat + np.diag(precision)
    b = flat.T @ (read / sigma).ravel() + precision * middle
    c = theta[1:4] / mass
    ball = mass * (SIZE**2 + c @ c)
    start = theta.copy()
    start[4:10] = (np.eye(3) * ball - mass * np.outer(c, c))[np.triu_indices(3)]
    none = np.array([], dtype=np.int64)
    theta = consistent_minimum(A, b, 1, none, start)
    return SensedLoad(
        Body.of_parameters(theta[:10]), _errors(A, rows, read, theta, sigma), theta[10:]
    )


def _errors(A: Array, rows: Array, read: Array, theta: Array, sigma: Array) -> Array:
    """Standard errors of mass, centre, I_O from the scatter between blocks of time."""
    left = (read - rows @ theta) / sigma**2
    parts = np.array_split(np.arange(len(rows)), BLOCKS)
    scores = np.array([np.einsum("kij,ki->j", rows[p], left[p]) for p in parts])
    inverse = scaled_inverse(A)
    covariance = inverse @ (scores.T @ scores) @ inverse
    mass = theta[0]
    turn = np.eye(10, 16)
    turn[1:4, 1:4] /= mass
    turn[1:4, 0] = -theta[1:4] / mass**2
    return np.asarray(np.sqrt(np.diag(turn @ covariance @ turn.T)))
