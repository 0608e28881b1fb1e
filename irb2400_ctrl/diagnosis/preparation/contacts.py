"""Over which angle the dry friction of this arm turns over: a number of the arm, measured at the
turns of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import lsq_linear

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog

USUAL_CONTACT = 3.5e-4
"""[rad] where the log does not tell"""
BEYOND = 13.0
"""times as wide a hysteresis is: the same curve, and every joint has it"""
LEAST = 1.3e-4
MOST = 7e-4
WIDTHS = np.geomspace(5e-5, 2.56e-2, 10)
"""[rad] of the Dahl models whose sum each joint's friction may be; the widest takes what is slow"""
OF_CONTACTS = 5e-3
"""[rad] what is wider may be anything slow"""
SHARE = 0.9
"""of a joint's friction has turned over within its width"""
LATER = 4.0
"""times the arm's width, beyond which a joint turns over later than the others"""
LATER_SHARE = 0.05
"""of its friction: 0.08 to 0.8 on eight arms with a hysteresis of 0.7 to 4 mrad, nothing on two
that passed for one"""
ABOUT = 0.4
"""[s] on both sides of a turn that are looked at"""
REACH = 0.03
"""[rad] the same"""
USUAL_STRIBECK = 0.02
"""[rad/s] where the file does not say it"""
FEWEST_TURNS = 3
FEWEST_JOINTS = 3
FEWEST_ROWS = 8
"""of a turn"""


@dataclass(frozen=True)
class Contacts:
    """Angle behind a turn within which dry friction turns over.

    Args:
        width: of the arm [rad]; a usual one where fewer than three joints turn over in sight.
        later: joints (from 1) that show friction which turns over much later.
    """

    width: float = USUAL_CONTACT
    later: frozenset[int] = frozenset()

    def at(self, joint: int | None) -> float:
        """That of a joint (from 1), if its own turns show nothing later at least a usual one
        [rad]."""
        return self.width if joint in self.later else max(self.width, USUAL_CONTACT)

    def are_narrower(
        self, effect: type[Effect], joint: int | None, point: dict[str, float]
    ) -> bool:
        """Whether what an effect does behind a turn is told from what contacts do there.

        Args:
            effect: of the library; joint: that it acts on, from 1; point: of its grid.
        """
        name = effect.search.turns_over_in
        return not name or point[name] > BEYOND * self.at(joint)


def contacts_of(bases: Bases, motion: PreparedLog, load: Array) -> Contacts:
    """The median of what the joints show, which a flaw of one does not move, and which of them
    differ from it.

    Args:
        bases: of the robot; motion: the log, prepared.
        load: torque of the arm without friction, shape (m, n) [Nm].
    """
    if any(motion.recorders):
        return Contacts()  # the filter has smeared what happened there
    left = motion.tau - load
    found = {
        j + 1: amplitudes
        for j in range(motion.n)
        if (amplitudes := built_up(bases, motion, left[:, j], j)) is not None
    }
    if len(found) < FEWEST_JOINTS:
        return Contacts()
    width = float(np.clip(np.median([width_of(one) for one in found.values()]), LEAST, MOST))
    late = (LATER * width < WIDTHS) & (WIDTHS[-1] > WIDTHS)
    later = {j for j, one in found.items() if one[late].sum() > LATER_SHARE * one.sum()}
    return Contacts(width, frozenset(later))


def width_of(amplitudes: Array) -> float:
    """Angle within which `SHARE` of what contacts hold has turned over [rad]; `amplitudes` of
    `built_up`."""
    of_contacts = WIDTHS < OF_CONTACTS
    turned = np.cumsum(amplitudes[of_contacts])
    return float(np.interp(SHARE, turned / turned[-1], WIDTHS[of_contacts]))


def built_up(bases: Bases, motion: PreparedLog, left: Array, joint: int) -> Array | None:
    """How much of the friction of a joint (from 0) builds up over each of `WIDTHS` behind its
    turns [Nm]; None where it hardly turns.

    left ~ sum_k A_k z_k + S z_narrow exp(-|qd| / v_S) + F_v qd, A >= 0, beside a line of its own
    about each turn, which takes up all that is smooth there.

    Args:
        bases: of the robot; motion: the log, prepared; joint: from 0.
        left: torque of that joint beside `load` of `contacts_of`, shape (m,) [Nm].
    """
    speed = motion.qd[:, joint]
    rows, turn = near_turns(motion, joint)
    if not len(rows) or turn[-1] + 1 < FEWEST_TURNS:
        return None
    grid = [{"width_rad": float(width)} for width in WIDTHS]
    laws = bases.columns("hysteresis", joint + 1, motion, grid, filtered=False)
    Z = np.column_stack([law.values[rows, 0, 0] for law in laws])
    stribeck = bases.robot.joints[joint].friction.stribeck_rad_s or USUAL_STRIBECK
    peak = Z[:, 2] * np.exp(-np.abs(speed[rows]) / stribeck)
    X = np.column_stack([Z, peak, speed[rows], left[rows]])
    for k in range(turn[-1] + 1):
        here = turn == k
        q = motion.q[rows[here], joint]
        line = np.column_stack([np.ones(len(q)), q - q.mean()])
        X[here] -= line @ np.linalg.lstsq(line, X[here], rcond=None)[0]
    least = np.concatenate([np.zeros(len(WIDTHS)), [-np.inf, -np.inf]])
    found = lsq_linear(X[:, :-1], X[:, -1], (least, np.inf)).x[: len(WIDTHS)]
    return found if found[WIDTHS < OF_CONTACTS].sum() > 0.0 else None


def turns(speed: Array) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Changes of direction of a joint's speed (m,): the samples before them, and of the two about
    each the slower one."""
    before = np.flatnonzero(np.diff(np.sign(speed)) != 0)
    return before, before + (np.abs(speed[before]) >= np.abs(speed[before + 1]))


def near_turns(
    motion: PreparedLog, joint: int
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Samples about the turns of a joint, and the number of the turn of each, both (k,)."""
    q = motion.q[:, joint]
    speed = motion.qd[:, joint]
    reach = int(ABOUT / motion.step)
    rows: list[npt.NDArray[np.intp]] = []
    turn: list[npt.NDArray[np.intp]] = []
    for at in turns(speed)[1].tolist():
        part = next(one for one in motion.parts if at < one.stop)
        near = np.arange(max(at - reach, part.start), min(at + reach + 1, part.stop))
        # a gap leaves nothing known of any joint
        near = near[(np.abs(q[near] - q[at]) < REACH) & motion.known[near].any(axis=1)]
        if len(near) >= FEWEST_ROWS:
            turn.append(np.full(len(near), len(rows)))
            rows.append(near)
    if not rows:
        nothing = np.zeros(0, dtype=np.intp)
        return nothing, nothing
    return np.concatenate(rows), np.concatenate(turn)
