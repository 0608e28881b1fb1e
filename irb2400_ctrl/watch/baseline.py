"""`Baseline`: what is usual on an arm, learned from a stretch of its log that is taken as sound.

The robot's numbers are fitted to the stretch within their prior (a data sheet's, or the covariance
of an identification), the noise of each joint is an autoregressive model. What is then left of a
torque is white with the variance 1 + z^T C z: noise, and what the numbers' covariance C leaves
open. How large it really is on motion that was not fitted is seen by leaving parts out in turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, one_thread
from irb2400_ctrl.diagnosis.diagnose import prior_of
from irb2400_ctrl.diagnosis.estimation.fit import Fitter
from irb2400_ctrl.diagnosis.estimation.reversals import reversal_rows
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior
from irb2400_ctrl.diagnosis.preparation.noise import Noise, complete_rows
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log, PreparedLog, prepare
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

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
class White:
    """One joint of a record with its noise made white and of unit size, row by row.

    Args:
        time: of the rows [s], shape (r,).
        left: torque less what the robot file predicts, shape (r,) [-].
        columns: of the robot's numbers as unit normals, shape (r, k) [-].
        drifts: of what drifts: the joint's Coulomb and viscous friction, a mass at the tool, in
            natural units, shape (r, 3) [1/(Nm), 1/(Nm s/rad), 1/kg].
    """

    time: Array
    left: Array
    columns: Array
    drifts: Array

    def block(self, time: float) -> White:
        """The rows of the block of which this is the middle [s]."""
        rows = slice(
            *np.searchsorted(block_of(self.time), block_of(np.array([time, time + BLOCK])))
        )
        return White(self.time[rows], self.left[rows], self.columns[rows], self.drifts[rows])


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
    prior: AnyPrior
    numbers: Numbers
    learned: Blocks

    @classmethod
    @typed
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
            seen = _Seen.of(bases, prior, motion)
            place = np.minimum(FOLDS * np.arange(motion.rows) // motion.rows, FOLDS - 1)
            folds = []
            for fold in range(FOLDS):
                others = seen.without(place == fold)
                numbers = _fitted(robot, bases, others)
                folds.append(_judged(robot, bases, seen.without(place != fold), numbers)[0])
            whole = _fitted(robot, bases, seen)
        return cls(robot, bases, prior, whole, _joined(folds))

    def judged(self, log: Log) -> tuple[Blocks, list[White]]:
        """Of a record of at least two seconds; its first and last moments are not complete."""
        with one_thread():
            motion = _prepared(log)
            seen = _Seen.of(self.bases, self.prior, motion)
            return _judged(self.robot, self.bases, seen, self.numbers)


@dataclass(frozen=True)
class _Seen:
    """A record with the columns of the numbers. Near a reversal or a stop a joint says nothing: how
    it sticks there and breaks away differs from time to time, on a sound arm too."""

    motion: PreparedLog
    Z: Array
    drifts: Array
    """of each joint's own Coulomb and viscous friction and of a mass at the tool, (rows, n, 3)"""

    @classmethod
    def of(cls, bases: Bases, prior: AnyPrior, motion: PreparedLog) -> _Seen:
        Z = motion.filtered(prior.columns(bases.model, motion))
        known = motion.row_known & ~reversal_rows(motion)
        return cls(replace(motion, row_known=known), Z, _drifts(bases, motion))

    def without(self, rows: Mask) -> _Seen:
        known = self.motion.row_known & ~rows[:, None]
        return replace(self, motion=replace(self.motion, row_known=known))


def _drifts(bases: Bases, motion: PreparedLog) -> Array:
    """Filtered torque per Nm, Nm s/rad and kg, shape (rows, n, 3)."""
    robot = bases.robot
    load = LIBRARY["payload"].of(None, mass_kg=1.0, com_m=_tool_place(robot))
    coulomb, viscous, _ = FrictionLaw.of(robot).regressor(motion.qd)
    friction = motion.filtered(np.stack([coulomb, viscous], axis=2))
    (basis,) = bases.columns("payload", None, motion)
    mass = basis.torque(np.array(load.coefficients()), motion.n)
    return np.concatenate([friction, mass[:, :, None]], axis=2)


def _tool_place(robot: Robot) -> tuple[float, ...]:
    """Where the tool's mass is, in the flange frame [m]; that of the last link where the file has
    the tool in it."""
    if robot.tool is not None and robot.tool.body.mass_kg > 0.0:
        return robot.tool.body.com_m
    centre = np.append(robot.links[-1].body.com_m, 1.0)
    x, y, z = np.linalg.solve(robot.flange.matrix(), centre)[:3]
    return float(x), float(y), float(z)


def _prepared(log: Log) -> PreparedLog:
    """On its measured angles: how the servo follows is not learned from three seconds."""
    return prepare(replace(log, q_ref=None, qd=None, extra={}))


def _fitted(robot: Robot, bases: Bases, seen: _Seen) -> Numbers:
    calm = np.zeros_like(seen.motion.row_known)
    fit = Fitter(robot, bases, seen.motion, seen.Z, calm).fit([])
    # a joint that stood all along has no rows
    noise = tuple(
        (one.a, float(1.0 / np.median(one.weight)) if one.weight.size else np.nan)
        for one in fit.noise
    )
    return Numbers(fit.z, fit.z_covariance, noise)


def _whitened(
    robot: Robot, bases: Bases, seen: _Seen, numbers: Numbers
) -> Iterator[tuple[White, Array]]:
    """Each joint, and its rows before whitening: what the fitted numbers leave [Nm], shape (r,)."""
    motion = seen.motion
    y = motion.filtered_reading(motion.tau_smooth - predicted_torque(robot, motion, bases))
    left = y - seen.Z @ numbers.z
    for j, (a, sigma) in enumerate(numbers.noise):
        kept = complete_rows(motion.row_known[:, j], len(a) - 1)
        noise = Noise(a, np.full(len(kept), 1.0 / sigma), kept)
        parts = (noise.whiten(part[:, j]) for part in (y, seen.Z, seen.drifts))
        yield White(motion.row_time[kept], *parts), left[kept, j]


def _judged(
    robot: Robot, bases: Bases, seen: _Seen, numbers: Numbers
) -> tuple[Blocks, list[White]]:
    first, last = (block_of(time) for time in seen.motion.row_time[[0, -1]])
    count = int(last - first) + 1
    energies = []
    torques = []
    joints = []
    for white, left in _whitened(robot, bases, seen, numbers):
        X = white.columns
        e = white.left - X @ numbers.z
        variance = 1.0 + np.sum((X @ numbers.covariance) * X, axis=1)
        place = (block_of(white.time) - first).astype(int)
        rows = np.bincount(place, minlength=count)
        known = np.where(rows >= LEAST_ROWS, rows, np.nan)
        energies.append(np.bincount(place, e**2 / variance, minlength=count) / known)
        torques.append(np.bincount(place, left, minlength=count) / known)
        joints.append(white)
    time = BLOCK * (first + np.arange(count) + 0.5)
    return Blocks(time, np.column_stack(energies), np.column_stack(torques)), joints


def block_of(time: Array) -> Array:
    """Number of the block that each time [s] lies in."""
    return np.asarray(np.floor(time / BLOCK + 1e-9))


def _joined(folds: list[Blocks]) -> Blocks:
    """One entry a block: each was judged in one fold, or partly in two, which leaves it out."""
    energy = np.array([fold.energy for fold in folds])
    once = np.isfinite(energy).sum(axis=0) == 1
    torque = np.array([fold.torque for fold in folds])

    def only(values: Array) -> Array:
        return np.where(once, np.nansum(values, axis=0), np.nan)

    return Blocks(folds[0].time, only(energy), only(torque))
