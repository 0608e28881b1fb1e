"""Zeros of joints that are not the file's: the joints behind one that stands elsewhere are turned
with it, and no bodies make up for that.

    tau = Y(q + c, qd, qdd) phi + D beta

The torques do not change with the angle of an upright first joint, and a body on the last one may
as well be turned: of these nothing is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, rms
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import FOLDS, unseen_rms
from irb2400_ctrl.identification.fitting.estimate import FitProblem
from irb2400_ctrl.identification.fitting.fit import ASIDE, scale_of
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Recording, moments
from irb2400_ctrl.identification.fitting.noise import NOTHING
from irb2400_ctrl.identification.fitting.prior import prior_of
from irb2400_ctrl.model import Model

PERHAPS = 2.0
"""standard errors from the file's zero, from which it is looked for, and"""
CLEAR = 5.0
"""beside what is left with it"""
LEAST = np.radians(1.0)
"""[rad] by which a zero is off, to be said"""
LESS = 0.8
"""of what joints leave on unseen stretches, one times the other, with the zeros that are said"""
LONGEST = np.radians(20.0)
"""[rad] of one step: what a joint behind feels is no straight line"""
SETTLED = np.radians(0.1)
"""[rad] of a step that is none"""
ROUNDS = 10


@dataclass(frozen=True)
class Zero:
    """A joint (from 1) that stands elsewhere than its angle says.

    Args:
        off: what its angles lack [rad]; error: standard error of it.
        most: the joint (from 1) that is predicted so much better with it; left: on unseen
            stretches, over what is left without [-].
    """

    joint: int
    off: float
    error: float
    most: int
    left: float

    def says(self) -> str:
        """In words."""
        return (
            f"the zero of joint {self.joint} is not the file's: with {np.degrees(self.off):+.1f} ± "
            f"{np.degrees(1.96 * self.error):.1f} deg on its angles joint {self.most} leaves "
            f"{100 * self.left:.0f} % of what it leaves without, on stretches that no fit has "
            "seen. Where is its zero by the log, and where by the robot file? What is written "
            "here holds for the angles as they are: set it right, and identify again"
        )


def other_zeros(model: Model, found: Fit, parts: Sequence[Recording]) -> list[Zero]:
    """Joints whose zero is clearly another: beside bodies of which the file says hardly anything,
    and joints are predicted better with it on stretches that were not fitted.

    Args:
        model: of the arm; found: its fit; parts: what it was fitted to.
    """
    n = found.layout.n
    if len(found.sums.gathered(FOLDS).count) < FOLDS:
        return []
    asked = np.arange(1, n - 1)
    bodies = found.free.theta[: 10 * n]
    step, errors, bodies = _step(model, found, parts, bodies, asked)
    # a zero that is off is noise to the fit without it
    asked = asked[np.abs(step[asked]) > np.maximum(LEAST, PERHAPS * errors[asked])]
    off = np.zeros(n)
    for _ in range(ROUNDS):
        if not len(asked):
            return []
        step, errors, bodies = _step(model, found, _moved(parts, off), bodies, asked)
        off[asked] += np.clip(step[asked], -LONGEST, LONGEST)
        if np.abs(step).max() < SETTLED:
            clear = np.abs(off[asked]) > np.maximum(LEAST, CLEAR * errors[asked])
            if clear.all():
                break
            asked = asked[clear]
            off[np.setdiff1d(np.arange(n), asked)] = 0.0
    else:
        return []
    with_them, without = (_unseen(model, found, some) for some in (_moved(parts, off), parts))
    better = np.log(np.maximum(with_them, NOTHING) / np.maximum(without, NOTHING))
    if not better.sum() < np.log(LESS):
        return []
    most = int(np.argmin(better))
    left = float(np.exp(better[most]))
    return [Zero(int(j) + 1, float(off[j]), float(errors[j]), most + 1, left) for j in asked]


def _moved(parts: Sequence[Recording], off: Array) -> list[Recording]:
    """The recordings with something on their angles, (n,) [rad]."""
    return [replace(part, motion=replace(part.motion, q=part.motion.q + off)) for part in parts]


def _problem(
    model: Model, found: Fit, parts: Sequence[Recording], layout: ColumnLayout
) -> FitProblem:
    """Of these recordings with these columns, in stretches."""
    sums = moments(model, layout, parts).gathered(FOLDS)
    prior = prior_of(model.robot, layout, scale_of(parts))
    return FitProblem(sums, prior, found.correlation, layout.positive())


def _step(
    model: Model, found: Fit, parts: Sequence[Recording], bodies: Array, asked: Integers
) -> tuple[Array, Array, Array]:
    """What the angles still lack, its standard errors, (n,) [rad], and the bodies beside it.

    Args:
        model: of the arm.
        found: its fit.
        parts: recordings, moved as far as is known.
        bodies: with which the torque changes with the angle, (10 n,).
        asked: joints (from 0) whose zero is free.
    """
    n = found.layout.n
    zeros = tuple(Extra("zero", int(joint) + 1) for joint in asked)
    extras = (*found.layout.extras, *zeros)
    layout = replace(found.layout, extras=extras, pressing=tuple(bodies.tolist()))
    problem = _problem(model, found, parts, layout)
    whole = replace(problem, sums=problem.sums.summed())
    free = whole.estimate(consistent=False, kappa=np.full(n, ASIDE))
    step = np.zeros(n)
    errors = np.full(n, np.inf)
    for zero in zeros:
        (place,) = range(layout.count)[layout.extra(zero)]
        step[zero.joint - 1] = free.theta[place]
        errors[zero.joint - 1] = np.sqrt(free.covariance[place, place])
    return step, errors, free.theta[: 10 * n]


def _unseen(model: Model, found: Fit, parts: Sequence[Recording]) -> Array:
    """Rms torque left on unseen stretches by bodies of which the file says hardly anything, (n,)
    [Nm]."""
    problem = _problem(model, found, parts, found.layout)
    like = replace(found.free, kappa=np.full(found.layout.n, ASIDE))
    return rms(unseen_rms(problem, like))
