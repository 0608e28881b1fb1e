"""Torques of a log that were recorded later than its angles, all by one delay.

A recorder that filters or stores its torques tells them a few samples late. Nothing of an arm is
like that, yet bodies, rotors and viscous friction take it up, each with a small error of its own.
To first order

    tau(t) = a(t) theta - delay d tau/dt,

so the delay is one more column of plain least squares over all joints. The torques are taken as
that much later and the fit is made again, until it settles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects.time_delay import TimeDelay
from irb2400_ctrl.identification.fitting.baseline import shortest_inverse
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.given import given_torque
from irb2400_ctrl.identification.fitting.moments import Recording, moments, predicted
from irb2400_ctrl.identification.fitting.motion_source import Source, motion_of
from irb2400_ctrl.identification.fitting.noise import correlation_factor
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.standstill import STICKING_SPEED
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

CLEAR = 3.0
"""standard errors beyond what may look like a delay at which torques are late"""
MOST = 0.1
"""[s] what is later than that is no delay of a recorder"""
SAMPLES = 4000
"""of a log that are looked at"""
FEWEST = 200
"""samples of a joint that tells"""
SHORTEST = 8.0
"""[s] of a log: the error of the delay is from how its seconds disagree"""
SETTLED = 5e-5
"""[s] change at which a delay is done, or"""
OF_ERROR = 0.05
"""of its standard error: what few seconds tell goes to and fro by more"""
ROUNDS = 30


@dataclass(frozen=True)
class Late:
    """A log whose torques are late, by `delay` (below zero: early) with standard error `error` [s].

    Args:
        name: of the log.
    """

    name: str
    delay: float
    error: float

    def says(self) -> str:
        """A line for the reader."""
        which = "later" if self.delay > 0.0 else "earlier"
        return (
            f"{self.name}: the torques were recorded {1e3 * abs(self.delay):.1f} ± "
            f"{1e3 * 1.96 * self.error:.1f} ms {which} than the angles; they are taken as of the "
            "time of the angles (irb2400 diagnose LOG names it: time_delay)"
        )

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        return {"name": self.name, "delay_s": self.delay, "standard_error_s": self.error}


def late_torques(model: Model, part: Recording) -> Late | None:
    """The delay of all torques of one recording; None where it is not clear.

    Args:
        model: of the arm without effects.
        part: the recording, with the torque that the file knows beside the fit.
    """
    fit = _DelayFit.of(model, part)
    if fit is None:
        return None
    delay = 0.0
    for _ in range(ROUNDS):
        more, error = fit.step(delay)
        delay += more
        if abs(delay) > MOST or not _clear(delay, error):
            return None
        if abs(more) < max(SETTLED, OF_ERROR * error):
            return Late(part.motion.name, delay, error)
    return None


def delays(model: Model, kept: Robot, logs: Sequence[Log]) -> list[Late | None]:
    """Of each log, how late its torques are.

    Args:
        model: of the arm without effects; kept: the file with those that the fit leaves alone.
        logs: of the arm.
    """
    motions = [motion_of(log, "angle") for log in logs]
    return [late_torques(model, part) for part in given_torque(kept, motions)]


def prepared(logs: Sequence[Log], source: Source, late: Sequence[Late | None]) -> list[PreparedLog]:
    """The logs with late torques at their time.

    Args:
        logs: as recorded; source: of their speeds.
        late: of each, how late its torques are.
    """
    motions = [motion_of(log, source) for log in logs]
    pairs = zip(motions, late, strict=True)
    return [motion if one is None else in_time(motion, one.delay) for motion, one in pairs]


def in_robot(robot: Robot, late: Sequence[Late | None]) -> Robot:
    """The robot whose torques are recorded as late as those of all logs: it predicts them as
    recorded. The same robot where the logs differ, or one is in time.
    """
    some = [one for one in late if one is not None]
    if len(some) < max(len(late), 1):
        return robot
    weight = np.array([one.error**-2 for one in some])
    delays = np.array([one.delay for one in some])
    mean = float(weight @ delays / weight.sum())
    if any(abs(one.delay - mean) > CLEAR * one.error for one in some):
        return robot
    return robot.with_effects(TimeDelay(delay_s=mean, source="identified"))


def in_time(motion: PreparedLog, delay: float) -> PreparedLog:
    """The log with torques that were recorded so much later than the angles [s] at the time of
    these; what is then not recorded is not known."""
    when = motion.time + delay
    first, last = motion.time[[0, -1]]
    place = np.clip(np.searchsorted(motion.time, when), 0, len(when) - 1)
    # a gap of the record lies earlier in its torques
    recorded = motion.known[place].any(axis=1) & (when >= first) & (when <= last)
    when = np.clip(when, first, last)
    tau, smooth = (
        np.asarray(CubicSpline(motion.time, signal)(when))
        for signal in (motion.tau, motion.tau_smooth)
    )
    return replace(motion, tau=tau, tau_smooth=smooth, known=motion.known & recorded[:, None])


def open_by_delay(
    model: Model, found: Fit, parts: Sequence[Recording], late: Sequence[Late | None]
) -> Array:
    """Covariance of the numbers by that of the delays, s_d^2 J J^T, shape (p, p):

        J = d theta / d delay = A^-1 sum_j a_j^T (d tau_j / dt) / (sigma_j^2 f_j).

    Args:
        model: of the arm without effects; found: the fit to torques at their time.
        parts: the recordings that it is to.
        late: of each, how late its torques were.
    """
    layout = found.layout
    weight = 1.0 / (found.numbers.sigma**2 * found.samples)
    data = np.einsum("n,npq->pq", weight, found.sums.summed().H[0])
    inverse = scaled_inverse(data + found.prior.precision(found.numbers.kappa))
    covariance = np.zeros_like(inverse)
    for part, one in zip(parts, late, strict=True):
        if one is None:
            continue
        rate = part.given + _rate(model, layout, part, found.theta)
        as_torque = replace(part, motion=replace(part.motion, tau=rate))
        slope = inverse @ (weight @ moments(model, layout, [as_torque]).summed().g[0])
        covariance += one.error**2 * np.outer(slope, slope)
    return covariance


def _rate(model: Model, layout: ColumnLayout, part: Recording, theta: Array) -> Array:
    """d tau / dt along a recording without the steps of dry friction, (m, n) [Nm/s]."""
    smooth = theta.copy()
    smooth[layout.drive("coulomb")] = 0.0
    torque = predicted(model, layout, part, smooth)
    return np.asarray(np.gradient(torque, part.motion.step, axis=0))


def _clear(delay: float, error: float) -> bool:
    """Whether a delay is clearly more than what stamps, held torques and reversals look like."""
    sure = abs(delay) - CLEAR * error
    return sure > 0.0 and not TimeDelay(delay_s=float(np.copysign(sure, delay))).unlikely


@dataclass(frozen=True)
class _DelayFit:
    """Plain least squares of one recording, thinned.

    Args:
        model, part: as of `late_torques`; layout: of columns without extras.
        every: of so many samples one is looked at; rows: their columns, (k, n, p);
        known: which count, (k, n); squares: rows^T rows of each joint, (n, p, p).
    """

    model: Model
    part: Recording
    layout: ColumnLayout
    every: slice
    rows: Array
    known: Mask
    squares: Array

    @staticmethod
    def of(model: Model, part: Recording) -> _DelayFit | None:
        """None where the recording is too short."""
        m = part.motion
        if m.duration < SHORTEST:
            return None
        layout = ColumnLayout(m.n)
        every = slice(None, None, -(-len(m.time) // SAMPLES))
        rows = columns(model, layout, m.q[every], m.qd[every], m.qdd[every])
        time = m.time[every]
        inside = (time > m.time[0] + MOST) & (time < m.time[-1] - MOST)
        # the step of dry friction has no rate
        known = m.known[every] & inside[:, None] & (np.abs(m.qd[every]) > STICKING_SPEED)
        known &= known.sum(axis=0) > FEWEST
        held = [rows[known[:, j], j] for j in range(m.n)]
        squares = np.array([some.T @ some for some in held])
        return _DelayFit(model, part, layout, every, rows, known, squares)

    def step(self, delay: float) -> tuple[float, float]:
        """(what the delay is more than this, its standard error) [s]; the error is infinite where
        no joint tells.

        The error is from how seconds disagree, no less than what correlated noise makes, and larger
        where the joints disagree: channels with gains
        of their own, or another arm's bodies, look late on one joint and early on the next.
        """
        m = self.part.motion
        tau = np.asarray(CubicSpline(m.time, m.tau)(m.time[self.every] + delay))
        tau -= self.part.given[self.every]
        theta, inverse, weight = self._plain(tau)
        rate = _rate(self.model, self.layout, self.part, theta)
        late = np.where(self.known, -rate[self.every], 0.0)
        left = np.where(self.known, tau - self.rows @ theta, 0.0)
        own = inverse @ np.einsum("n,np->p", weight, self._products(late))
        alone = np.where(self.known, late - self.rows @ own, 0.0)
        told = weight * (alone**2).sum(axis=0)
        if not told.sum() > 0.0:
            return 0.0, np.inf
        more = float((weight * alone * left).sum() / told.sum())
        rest = left - more * alone
        scores = self._by_second(weight * alone * rest)
        like = correlation_factor(rest, self.known)
        # seconds are few beside the columns, which take up part of how they disagree
        variance = max(float((scores.sum(axis=1) ** 2).sum()), float((like * told).sum()))
        error = np.sqrt(variance) / float(told.sum())
        return more, error * self._disagreement(scores, told)

    def _plain(self, tau: Array) -> tuple[Array, Array, Array]:
        """Numbers (p,), inverse of the normal equations (p, p), weights of the joints (n,)."""
        count = np.maximum(self.known.sum(axis=0), 1)
        products = self._products(tau)
        left = np.where(self.known, tau, 0.0)
        for _ in range(3):
            variance = (left**2).sum(axis=0) / count
            weight = np.where(variance > 0.0, 1.0 / np.maximum(variance, 1e-18), 0.0)
            A = np.einsum("n,npq->pq", weight, self.squares)
            inverse = shortest_inverse(A)
            theta = inverse @ (weight @ products)
            left = np.where(self.known, tau - self.rows @ theta, 0.0)
        return theta, inverse, weight

    def _products(self, signal: Array) -> Array:
        """rows^T signal of each joint, (n, p)."""
        joints = range(self.part.motion.n)
        seen: Sequence[Mask] = [self.known[:, j] for j in joints]
        return np.array([self.rows[seen[j], j].T @ signal[seen[j], j] for j in joints])

    def _by_second(self, values: Array) -> Array:
        """Sums over each second, (seconds, n)."""
        time = self.part.motion.time[self.every]
        second = (time - time[0]).astype(np.int64)
        found = np.zeros((second[-1] + 1, values.shape[1]))
        np.add.at(found, second, values)
        return found

    @staticmethod
    def _disagreement(scores: Array, told: Array) -> float:
        """How much more the joints' own delays scatter than their errors say, one at least.

        Args:
            scores: of each second and joint at the common delay, (seconds, n).
            told: what each joint knows of it, (n,).
        """
        some = told > 0.0
        variance = (scores[:, some] ** 2).sum(axis=0)
        squares = scores[:, some].sum(axis=0) ** 2 / np.maximum(variance, 1e-300)
        return float(np.sqrt(max(1.0, squares.sum() / max(int(some.sum()) - 1, 1))))
