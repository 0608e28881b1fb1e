"""What digits, noise and jitter of the angles cost in torque."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.instants.time_base import with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import digit, neighbour_noise
from irb2400_ctrl.measurement.prepared_log import CUTOFF
from irb2400_ctrl.measurement.uniform import (
    LowPass,
    derivative_margin,
    derivatives,
    resample,
    smoothed,
)
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def torque_from_angle_noise(robot: Robot, log: Log) -> Array | None:
    """rms below 10 Hz of M(q) times the acceleration that the angles' own noise makes, shape (n,).

    Returns:
        [Nm]; None for a log too short to be resampled.
    """
    if log.duration < 2.0:
        return None
    noise, step = acceleration_noise(with_time_base(log))
    low_pass = LowPass(CUTOFF, step)
    margin = derivative_margin(step)
    if len(noise) < 2 * (margin + low_pass.half) + 1:
        return None
    return torque_of(robot, log.q, low_pass(noise[margin:-margin]))


def acceleration_noise(even: Log, rate: float | None = None) -> tuple[Array, float]:
    """A draw of what the noise of the angles makes of the accelerations (m, n) [rad/s2], and its
    step [s].

    White on the samples of a log with its time base rebuilt, of the size that neighbours disagree
    by (`neighbour_noise`) or that the last digit leaves open; through the spline, the smoothing and
    the differences that the angles go through.

    Args:
        rate: of the grid [Hz]; default as `resample`.
    """
    size = np.maximum(neighbour_noise(even.q), digit(even.q) / np.sqrt(12.0))
    white = np.random.default_rng(0).standard_normal(even.q.shape) * size
    noise = resample(Log(even.time, white, np.zeros_like(white)), rate)
    return derivatives(smoothed(noise.q, noise.step), noise.step, 2)[2], noise.step


def torque_of(robot: Robot, q: Array, acceleration: Array) -> Array:
    """rms of M(q) times an acceleration that is independent of the angles q, shape (n,) [Nm].

    Args:
        robot: the arm.
        q: [rad], shape (m, n).
        acceleration: samples of it [rad/s2], shape (k, n).
    """
    place = np.linspace(0, len(q) - 1, 60).astype(int)
    M = np.asarray(Model(robot).mass_matrix(q[place]))
    covariance = np.cov(acceleration.T)
    power = np.einsum("mij,jk,mik->i", M, np.atleast_2d(covariance), M) / len(place)
    return np.asarray(np.sqrt(power))
