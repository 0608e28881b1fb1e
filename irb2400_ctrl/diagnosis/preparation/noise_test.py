"""Whether what a model leaves of a log is noise: held against what neighbouring samples disagree
about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.stats import norm

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.quick_rests import QuickRests, quick_rests
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.instants.time_base import with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import digit
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.torque_filter import TorqueFilter
from irb2400_ctrl.measurement.uniform import derivative_margin, derivatives, smoothed
from irb2400_ctrl.plausibility.cost_of_noise import torque_from_angle_noise, torque_of
from irb2400_ctrl.robot import Robot

TRIMMED = 0.02
"""share of the largest values that is left out: a joint that sticks at a reversal is no noise"""
MEAN_OVER = 0.2
"""[s]"""
MOST = 2.0
"""times the floor that noise may be"""
MOST_MEANS = 3.5
"""times what white noise of that floor gives that its means over `MEAN_OVER` may be: the noise of
a sound drive has some colour"""
FEWEST = 30
"""values below which nothing is said"""


@dataclass(frozen=True)
class NoiseTest:
    """What is left of a log on its own samples; arrays per joint, shape (n,).

    Args:
        floor: rms of the noise by sample-to-sample differences, by the digits of the torque, by the
            numbers that the log leaves open, and by what is not known of the motion: the noise of
            the angles, their departure from the motion that was used [Nm].
        left: rms of what is left [Nm]; means: of its means, over what white noise would give beside
            digits and open numbers, whose errors last.
        quick: what is quicker than laws are compared on.
    """

    floor: Array
    left: Array
    means: Array
    quick: QuickRests = field(default_factory=QuickRests)

    @property
    def beyond(self) -> tuple[int, ...]:
        """Joints (from 1) on which more than noise is left."""
        much = (self.left > MOST * self.floor) | (self.means > MOST_MEANS)
        return tuple(int(j) + 1 for j in np.flatnonzero(much))

    @property
    def by_means_alone(self) -> tuple[int, ...]:
        """Those of which the means alone say so, as they do of noise with more colour."""
        return tuple(j for j in self.beyond if self.left[j - 1] <= MOST * self.floor[j - 1])


def noise_test(
    robot: Robot,
    logs: Sequence[Log],
    motion: PreparedLog,
    predicted: Array,
    unsure: Array,
    effects: Sequence[Effect],
) -> NoiseTest:
    """Of a prediction along the motion of these logs (m, n) [Nm], on the samples as they were
    recorded; per joint on the log that fits worst.

    Args:
        unsure: standard error of the prediction, from numbers that the log leaves open, shape (n,)
            [Nm]; effects: that the prediction holds.
    """
    tests = [
        _on_log(robot, log, motion, part, predicted[part], unsure, recorder)
        for log, part, recorder in zip(logs, motion.parts, motion.recorders, strict=True)
    ]
    ratio = np.array([test.left / np.maximum(test.floor, 1e-12) for test in tests])
    worst = np.argmax(ratio, axis=0)
    joint = np.arange(motion.n)
    floor = np.array([test.floor for test in tests])[worst, joint]
    return NoiseTest(
        floor,
        np.array([test.left for test in tests])[worst, joint],
        np.max([test.means for test in tests], axis=0),
        quick_rests(motion, predicted, floor, effects),
    )


def _on_log(
    robot: Robot,
    log: Log,
    motion: PreparedLog,
    part: slice,
    predicted: Array,
    unsure: Array,
    recorder: TorqueFilter | None = None,
) -> NoiseTest:
    """On one log; `part`: its samples of the motion. Of torques that a recorder filtered only
    samples so far apart are neighbours that the filter does not make them alike."""
    even = with_time_base(log)
    # its ends were left out
    start = even.time[0] + derivative_margin(motion.step) * motion.step
    grid = start + motion.step * np.arange(len(predicted))
    inside = (even.time >= grid[0]) & (even.time <= grid[-1])
    period = float(np.median(np.diff(even.time[inside])))
    if recorder is not None:
        apart = max(1, round(0.5 / (recorder.highest * period)))
        inside = np.flatnonzero(inside)[::apart]
        period *= apart
    time = even.time[inside]
    nearest = np.clip(np.round((time - grid[0]) / motion.step), 0, len(grid) - 1)
    known = motion.known[part][nearest.astype(np.intp)]
    by_angles = _by_departure(robot, even, motion, part, grid)
    noise = None if motion.instrumented else torque_from_angle_noise(robot, log)
    by_angles = by_angles if noise is None else np.hypot(by_angles, noise)
    lasting = np.hypot(digit(log.tau) / np.sqrt(12.0), unsure)
    floor = np.zeros(log.n)
    left = np.zeros(log.n)
    means = np.zeros(log.n)
    for j in range(log.n):
        residual = even.tau[inside, j] - np.interp(time, grid, predicted[:, j])
        follows = known[1:, j] & known[:-1, j] & (np.diff(time) < 1.5 * period)
        steps = trimmed_rms(np.diff(residual)[follows]) / np.sqrt(2.0)
        white = np.hypot(steps, by_angles[j])
        floor[j] = np.hypot(white, lasting[j])
        left[j] = trimmed_rms(residual[known[:, j]])
        count = max(1, round(MEAN_OVER / period))
        usual = np.hypot(white / np.sqrt(count), lasting[j])
        means[j] = _means(residual, known[:, j], count) / max(float(usual), 1e-12)
    return NoiseTest(floor, left, means)


def _by_departure(robot: Robot, even: Log, motion: PreparedLog, part: slice, grid: Array) -> Array:
    """Torque of what the motion that was used lacks of the measured one, be it commanded or
    smoothed, shape (n,) [Nm]."""
    apart = CubicSpline(even.time, even.q)(grid) - motion.q[part]
    return torque_of(
        robot, motion.q[part], derivatives(smoothed(apart, motion.step), motion.step, 2)[2]
    )


def trimmed_rms(values: Array) -> float:
    """Standard deviation about zero without the largest values, unbiased for a normal variable;
    zero for too few values."""
    if len(values) < FEWEST:
        return 0.0
    kept = np.sort(np.abs(values))[: int(np.ceil((1.0 - TRIMMED) * len(values)))]
    edge = norm.ppf(1.0 - TRIMMED / 2.0)
    shrunk = 1.0 - 2.0 * edge * norm.pdf(edge) / (1.0 - TRIMMED)
    return float(np.sqrt(np.mean(kept**2) / shrunk))


def _means(residual: Array, known: Mask, count: int) -> float:
    """Size of the means over stretches of `count` samples [Nm]."""
    whole = len(residual) // count * count
    blocks = residual[:whole].reshape(-1, count)
    full = known[:whole].reshape(-1, count).all(axis=1)
    return trimmed_rms(blocks[full].mean(axis=1))
