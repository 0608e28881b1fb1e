"""`Baseline`: what is usual on an arm, learned from a stretch of its log that is taken as sound.

The robot's numbers are fitted to the stretch within their prior (a data sheet's, or the covariance
of an identification), the noise of each joint is an autoregressive model. What is then left of a
torque is white with the variance 1 + z^T C z: noise, and what the numbers' covariance C leaves
open. How large it really is on motion that was not fitted is seen by leaving parts out in turn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, one_thread
from irb2400_ctrl.diagnosis.comparison.selection import reversal_rows
from irb2400_ctrl.diagnosis.diagnose import prior_of
from irb2400_ctrl.diagnosis.estimation.fit import Fitter
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.identified_prior import IdentifiedPrior
from irb2400_ctrl.diagnosis.preparation.noise import Noise, complete_rows
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.measurement import Log, PreparedLog, prepare
from irb2400_ctrl.robot import Robot

BLOCK = 1.0
"""[s] of motion that are judged together"""
LEAST_ROWS = 8
"""complete rows of a joint in a block, of about 25, below which it says nothing"""
FOLDS = 5
"""parts that are left out in turn"""


@dataclass(frozen=True)
class Blocks:
    """What is left of the torques, block by block; NaN where a joint stands or the log has a gap.

    Args:
        time: middle of each block [s], shape (b,).
        energy: mean square of what is left over what its variance should be, shape (b, n) [-].
        torque: mean of what is left: an external torque, in Nm of the joint, shape (b, n).
    """

    time: Array
    energy: Array
    torque: Array


@dataclass(frozen=True)
class Numbers:
    """The robot's numbers as unit normals, mean and covariance, and the noise, as fitted."""

    z: Array
    covariance: Array
    noise: tuple[tuple[Array, float], ...]
    """of each joint: prediction-error filter, and the deviation of what it leaves [Nm]"""


@dataclass(frozen=True)
class Baseline:
    """What a robot's torque is compared with.

    Args:
        robot: as given.
        bases: evaluator of its effects.
        prior: how its numbers are scaled.
        numbers: fitted to the learned stretch.
        learned: the blocks of that stretch, each judged by numbers that did not see it.
    """

    robot: Robot
    bases: Bases
    prior: BasePrior | IdentifiedPrior
    numbers: Numbers
    learned: Blocks

    @classmethod
    def of(cls, robot: Robot, log: Log) -> Baseline:
        """From a sound stretch.

        Raises:
            InputError: it is too short, or does not fit the robot.
        """
        # the matrices are small: threads would only wait for each other
        with one_thread():
            motion = _prepared(log)
            bases = Bases(robot.bare())
            prior = prior_of(robot, robot.uncertainty, motion)
            Z = motion.filtered(prior.columns(bases.model, motion))
            seen = _Seen.of(motion, Z)
            place = np.minimum(FOLDS * np.arange(motion.rows) // motion.rows, FOLDS - 1)
            folds = []
            for fold in range(FOLDS):
                others = seen.without(place == fold)
                numbers = _fitted(robot, bases, others)
                folds.append(_blocks(robot, bases, seen.without(place != fold), numbers))
            whole = _fitted(robot, bases, seen)
        return cls(robot, bases, prior, whole, _joined(folds))

    def blocks(self, log: Log) -> Blocks:
        """Of a record of at least two seconds; its first and last moments are not complete."""
        with one_thread():
            motion = _prepared(log)
            Z = motion.filtered(self.prior.columns(self.bases.model, motion))
            seen = _Seen.of(motion, Z)
            return _blocks(self.robot, self.bases, seen, self.numbers)


@dataclass(frozen=True)
class _Seen:
    """A record with the columns of the numbers. Near a reversal or a stop a joint says nothing: how
    it sticks there and breaks away differs from time to time, on a sound arm too."""

    motion: PreparedLog
    Z: Array

    @classmethod
    def of(cls, motion: PreparedLog, Z: Array) -> _Seen:
        known = motion.row_known & ~reversal_rows(motion)
        return cls(replace(motion, row_known=known), Z)

    def without(self, rows: Mask) -> _Seen:
        known = self.motion.row_known & ~rows[:, None]
        return replace(self, motion=replace(self.motion, row_known=known))


def _prepared(log: Log) -> PreparedLog:
    """On its measured angles: how the servo follows is not learned from three seconds."""
    return prepare(replace(log, q_ref=None, qd=None, extra={}))


def _fitted(robot: Robot, bases: Bases, seen: _Seen) -> Numbers:
    calm = np.zeros_like(seen.motion.row_known)
    fit = Fitter(robot, bases, seen.motion, seen.Z, calm).fit([])
    noise = tuple((one.a, float(1.0 / np.median(one.weight))) for one in fit.noise)
    return Numbers(fit.z, fit.z_covariance, noise)


def _blocks(robot: Robot, bases: Bases, seen: _Seen, numbers: Numbers) -> Blocks:
    motion = seen.motion
    y = motion.filtered(motion.tau_smooth - predicted_torque(robot, motion, bases))
    left = y - seen.Z @ numbers.z
    number = np.floor(motion.row_time / BLOCK + 1e-9).astype(int)
    count = number[-1] - number[0] + 1
    energy = np.full((count, motion.n), np.nan)
    torque = np.full((count, motion.n), np.nan)
    for j, (a, sigma) in enumerate(numbers.noise):
        kept = complete_rows(motion.row_known[:, j], len(a) - 1)
        noise = Noise(a, np.full(len(kept), 1.0 / sigma), kept)
        e = noise.whiten(left[:, j])
        X = noise.whiten(seen.Z[:, j])
        variance = 1.0 + np.sum((X @ numbers.covariance) * X, axis=1)
        place = number[kept] - number[0]
        rows = np.bincount(place, minlength=count)
        enough = rows >= LEAST_ROWS
        sums = np.bincount(place, e**2 / variance, minlength=count)
        energy[enough, j] = sums[enough] / rows[enough]
        sums = np.bincount(place, left[kept, j], minlength=count)
        torque[enough, j] = sums[enough] / rows[enough]
    return Blocks(BLOCK * (number[0] + np.arange(count) + 0.5), energy, torque)


def _joined(folds: list[Blocks]) -> Blocks:
    """One entry a block: each was judged in one fold, or partly in two, which leaves it out."""
    energy = np.array([fold.energy for fold in folds])
    once = np.isfinite(energy).sum(axis=0) == 1
    torque = np.array([fold.torque for fold in folds])

    def only(values: Array) -> Array:
        return np.where(once, np.nansum(values, axis=0), np.nan)

    return Blocks(folds[0].time, only(energy), only(torque))
