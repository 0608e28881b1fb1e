"""What digits, noise and jitter of the angles cost in torque."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import neighbour_noise
from irb2400_ctrl.measurement.time_base import with_time_base
from irb2400_ctrl.measurement.uniform import (
    LowPass,
    derivative_margin,
    derivatives,
    resample,
    smoothed,
)
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

CUTOFF = 10.0
"""[Hz] below which torques are compared"""


def torque_from_angle_noise(robot: Robot, log: Log) -> Array | None:
    """rms below 10 Hz of M(q) times the acceleration that the angles' own noise makes, shape (n,).

    The noise is white on the samples, of the size that neighbours disagree by (`neighbour_noise`);
    it goes through the spline, the smoothing and the differences that the angles go through.

    Returns:
        [Nm]; None for a log too short to be resampled.
    """
    if log.duration < 2.0:
        return None
    even = with_time_base(log)
    rng = np.random.default_rng(0)
    white = rng.standard_normal(log.q.shape) * neighbour_noise(even.q)
    noise = resample(Log(even.time, white, np.zeros_like(white)))
    second = derivatives(smoothed(noise.q, noise.step), noise.step)[2]
    low_pass = LowPass(CUTOFF, noise.step)
    margin = derivative_margin(noise.step)
    if len(second) < 2 * (margin + low_pass.half) + 1:
        return None
    return torque_of(robot, log.q, low_pass(second[margin:-margin]))


def torque_of(robot: Robot, q: Array, acceleration: Array) -> Array:
    """rms of M(q) times an acceleration that is independent of the angles q, shape (n,) [Nm]."""
    place = np.linspace(0, len(q) - 1, 60).astype(int)
    M = np.asarray(Model(robot).mass_matrix(q[place]))
    covariance = np.cov(acceleration.T)
    power = np.einsum("mij,jk,mik->i", M, np.atleast_2d(covariance), M) / len(place)
    return np.asarray(np.sqrt(power))
