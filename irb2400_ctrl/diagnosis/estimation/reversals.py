"""Rows near reversals: left out where a joint sticks in a way that the log does not resolve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.preparation.quick_turns import TAKEN, left_by_a_loop, quick_turns
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects.hysteresis import Hysteresis
from irb2400_ctrl.measurement.motion.standstill import turning
from irb2400_ctrl.measurement.partial_low_pass import PartialLowPass
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.uniform import widened

REVERSAL_TIME = 0.16
"""[s] rows nearer than this to a reversal have a variance of their own"""
NOISY_REVERSAL = 2.5
"""residual near reversals over that elsewhere, above which a joint sticks in a way that the log
does not resolve"""
BUILT_UP = 0.3
"""share of the squared residual near reversals below which a hysteresis explains them (joints that
really stick leave 0.6 to 1.0, a hysteresis on the independent plant 0.02 to 0.07)"""
STICKS = 0.5
"""share of the squared residual near noisy reversals from which on a hysteresis, beside all else
that is found, has followed how a joint sticks: three false ones left 0.56 to 1.13, of 13 true ones
twelve at most 0.28 and one 0.41"""
ONE_REVERSAL = 10
"""rows, of one or two reversals: too few to tell what builds up over an angle from what sticks"""
LEAST_CALM = 50
"""rows away from reversals, without which nothing is known of the joint's usual misfit"""


def reversal_rows(motion: PreparedLog) -> Mask:
    """Rows near a change of direction or a near stop, shape (rows, n)."""
    return motion.at_rows(near_reversals(motion.qd, motion.step).astype(float)) > 0.5


def near_reversals(qd: Array, step: float) -> Mask:
    """The same of samples, shape of qd [rad/s].

    Args:
        qd: speeds, shape (m, n); step: between two samples [s].
    """
    return widened(turning(qd), round(REVERSAL_TIME / step))


def noisy_reversals_masked(
    motion: PreparedLog,
    bases: Bases,
    fit: Fit,
    reversal: Mask,
    contacts: Contacts,
    left: Array,
) -> tuple[PreparedLog, Contacts]:
    """The motion without the rows near reversals of joints whose sticking no model of this kind
    follows, and the contacts with the joints whose friction turns over later.

    Friction that builds up over an angle shows nowhere else, so it is tried before: where it takes
    most of what is left at the reversals, they stay; where it takes most of what is left once the
    joint slides again behind quick ones, these stay without the samples before it does.

    Args:
        fit: of the base alone; reversal: rows near a change of direction, shape (rows, n).
        contacts: over which angle the friction of this arm turns over.
        left: torque that the robot as given leaves, shape (m, n) [Nm].
    """
    known = motion.row_known.copy()
    late: list[int] = []
    for j in range(motion.n):
        near = known[:, j] & reversal[:, j]
        calm = known[:, j] & ~reversal[:, j]
        if not near.any() or calm.sum() <= LEAST_CALM:
            continue
        residual = fit.residual[:, j]
        if not _noisy(residual, near, calm):
            continue
        if near.sum() > ONE_REVERSAL:
            rest = _without_hysteresis(motion, bases, j, residual, near, contacts)
            if np.sum(rest[near] ** 2) <= BUILT_UP * np.sum(residual[near] ** 2):
                continue
        if left_by_a_loop(bases, motion, left[:, j], j) <= TAKEN:
            late.append(j)
        else:
            known[:, j] = calm
    motion = replace(motion, row_known=known)
    if not late:
        return motion, contacts
    later = contacts.later.union(j + 1 for j in late)
    return _where_they_slide(motion, late), replace(contacts, later=later)


def sticks_beside(motion: PreparedLog, joint: int, left: Array, without: Array) -> bool:
    """Whether a joint sticks in a way that no model of this kind follows, a hysteresis of it
    neither.

    What else acts on the joint may hide that as long as it is not found.

    Args:
        motion: of the log; joint: from 0.
        left: what all leave, shape (rows, n) [Nm]; without: the same without the hysteresis.
    """
    reversal = reversal_rows(motion)[:, joint]
    near = motion.row_known[:, joint] & reversal
    calm = motion.row_known[:, joint] & ~reversal
    if near.sum() <= ONE_REVERSAL or calm.sum() <= LEAST_CALM:
        return False
    rest = left[:, joint]
    shares = np.sum(rest[near] ** 2), np.sum(without[near, joint] ** 2)
    return bool(shares[0] > STICKS * shares[1]) and _noisy(rest, near, calm)


def _where_they_slide(motion: PreparedLog, joints: Sequence[int]) -> PreparedLog:
    """The motion with rows about the quick turns of some joints (from 0) that are of samples alone
    in which these slide, and without rows near their other turns."""
    counts = np.ones(len(motion.time), dtype=bool)
    known = motion.row_known.copy()
    tau = motion.tau_smooth.copy()
    for j in joints:
        others = turning(motion.qd[:, j])
        for between in quick_turns(motion, j).between:
            counts[between] = False
            others[between] = False
        others = widened(others, round(REVERSAL_TIME / motion.step))
        known[:, j] &= ~motion.low_pass.instants(others)
        # smoothed, the torque of breaking away would reach to where the joint slides
        tau[:, j] = motion.tau[:, j]
    low_pass = PartialLowPass.of(motion.low_pass, counts)
    known &= low_pass.known[:, None]
    return replace(motion, low_pass=low_pass, row_known=known, tau_smooth=tau)


def _noisy(residual: Array, near: Mask, calm: Mask) -> bool:
    level = np.median(np.abs(np.diff(residual)[calm[1:]])) / 0.9539
    usual = max(level, float(np.sqrt(np.mean(residual[calm] ** 2))))
    return bool(np.sqrt(np.mean(residual[near] ** 2)) > NOISY_REVERSAL * usual)


def _without_hysteresis(
    motion: PreparedLog, bases: Bases, joint: int, residual: Array, near: Mask, contacts: Contacts
) -> Array:
    """What the best hysteresis of one joint (zero-based) leaves of a residual, shape (rows,).

    Args:
        residual: shape (rows,) [Nm]; near: rows near a change of direction, shape (rows,).
        contacts: as of `noisy_reversals_masked`.
    """
    at = joint + 1
    grid = [g for g in Hysteresis.grid(at) if contacts.are_narrower(Hysteresis, at, g)]
    known = motion.row_known[:, joint]
    best = residual
    for law in bases.columns("hysteresis", joint + 1, motion, grid):
        X = law.values[:, 0, :]
        b = np.linalg.lstsq(X[known], residual[known], rcond=None)[0]
        left = residual - X @ b
        if np.sum(left[near] ** 2) < np.sum(best[near] ** 2):
            best = left
    return best
