"""Friction that builds up over an angle behind turns at which the joint itself sticks unseen.

Where static friction is much larger than Coulomb's a joint stops and breaks away within a few
samples, and no smoothed speed follows that. A loop that is wider than its contacts shows behind it
all the same: once the joint moves again, where it turned so quickly that little of the angle has
passed by then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.measurement.prepared_log import PreparedLog

SLIDES = 0.1
"""[rad/s] above this a joint does, and its smoothed speed is its speed"""
QUICK = 0.057
"""[s] that a quick turn is slower than that at most"""
REACH = 0.025
"""[rad] that is looked at on both sides"""
FEWEST_SAMPLES = 4
"""on either side"""
FEWEST_TURNS = 5
"""the swing of a soft joint passes for a loop at three or four"""
NARROW = (4e-4, 8e-4)
"""[rad] as wide as contacts may be"""
WIDTHS = np.geomspace(1.6e-3, 8e-3, 6)
"""[rad] of the loops that are looked for"""
FADES = 0.03
"""[rad/s] over which what is left of static friction does"""
SINGULAR = 1e-9
LEAST_SEEN = 1e-6
"""mean square of a loop of one beside the rest"""
AS_NOISE = 2.5
"""times the noise, as samples show it, that the loop may leave: 1.1 to 1.5 on five wrists that have
one, 5.3 on a joint that swings on its spring"""
MEDIAN_OF_NORMAL = 0.6745
SECOND_DIFFERENCE = float(np.sqrt(6.0))
TAKEN = 0.55
"""of what is left there, above which a loop does not explain it: 0.20 to 0.47 on five wrists of the
third plant that have one, 0.65 and more on joints without (`benchmarks/quick_turns.py`); wide play
passes for one (0.12), and keeps its name"""


@dataclass(frozen=True)
class QuickTurns:
    """Turns of one joint that pass quickly.

    Args:
        rows: samples about them at which it slides, (k,); turn: the number of the turn of each.
        between: samples of each turn at which it does not.
    """

    rows: npt.NDArray[np.intp]
    turn: npt.NDArray[np.intp]
    between: tuple[slice, ...]


def quick_turns(motion: PreparedLog, joint: int) -> QuickTurns:
    """Of a joint (from 0)."""
    q = motion.q[:, joint]
    speed = motion.qd[:, joint]
    seams = np.array([*motion.starts, len(q)])
    crossings = np.flatnonzero(np.diff(speed > 0.0))
    edges = [-1, *crossings.tolist(), len(q) - 1]
    rows = [np.zeros(0, dtype=np.intp)]
    between: list[slice] = []
    for earlier, at, next_one in zip(edges, edges[1:], edges[2:], strict=False):
        log = int(np.searchsorted(seams, at, side="right"))
        near = np.arange(max(earlier + 1, seams[log - 1]), min(next_one + 1, seams[log]))
        near = near[(np.abs(speed[near]) > SLIDES) & (np.abs(q[near] - q[at]) < REACH)]
        sides = near[near <= at], near[near > at]
        if min(map(len, sides)) < FEWEST_SAMPLES:
            continue
        stands = slice(int(sides[0][-1]) + 1, int(sides[1][0]))
        if (stands.stop - stands.start) * motion.step <= QUICK:
            between.append(stands)
            rows.append(near)
    turn = np.repeat(np.arange(len(rows)) - 1, [len(one) for one in rows])
    return QuickTurns(np.concatenate(rows), turn, tuple(between))


def left_by_a_loop(bases: Bases, motion: PreparedLog, left: Array, joint: int) -> float:
    """Share of the squared torque about quick turns that the best loop leaves, one where there are
    too few turns, none has its sign, more than noise is left, or a filter of the recorder has
    smeared what happened there.

    left ~ A (z_w - sgn qd), A > 0, beside a step c sgn qd, what contacts and static friction may
    have left, B (z_narrow - sgn qd) and D sgn qd exp(-|qd| / v), and a + b q + d qd of each turn.

    Args:
        bases: of the robot; motion: the log, prepared; joint: from 0.
        left: torque of that joint beside a prediction, shape (m,) [Nm].
    """
    found = quick_turns(motion, joint)
    if len(found.between) < FEWEST_TURNS or any(motion.recorders):
        return 1.0
    rows = found.rows
    speed = motion.qd[rows, joint]
    sign = np.sign(speed)
    grid = [{"width_rad": float(width)} for width in (*NARROW, *WIDTHS)]
    laws = bases.columns("hysteresis", joint + 1, motion, grid, filtered=False)
    loops = np.column_stack([law.values[rows, 0, 0] for law in laws]) - sign[:, None]
    X = np.column_stack([sign, sign * np.exp(-np.abs(speed) / FADES), loops, left[rows]])
    for k in range(len(found.between)):
        here = found.turn == k
        q = motion.q[rows[here], joint]
        X[here] = _beside(np.column_stack([np.ones(len(q)), q - q.mean(), speed[here]]), X[here])
    beside = 2 + len(NARROW)
    X = _beside(X[:, :beside], X[:, beside:])
    y = X[:, -1]
    along = np.maximum(X[:, :-1].T @ y, 0.0)
    power = np.sum(X[:, :-1] ** 2, axis=0)
    taken = along**2 / np.maximum(power, LEAST_SEEN * len(y))
    rest = float(y @ y - np.max(taken))
    second = np.abs(np.diff(left, 2))
    noise = float(np.median(second)) / (MEDIAN_OF_NORMAL * SECOND_DIFFERENCE)
    # a joint that swings on its spring is not explained by what looks like its swing
    return rest / float(y @ y) if rest <= (AS_NOISE * noise) ** 2 * len(y) else 1.0


def _beside(columns: Array, of: Array) -> Array:
    """What `columns` (k, a) leave of others (k, b)."""
    return np.asarray(of - columns @ np.linalg.lstsq(columns, of, rcond=SINGULAR)[0])
