"""What the moments at which a joint turns say of two effects that are the same while it moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.special import logsumexp

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.preparation.contacts import turns
from irb2400_ctrl.measurement.prepared_log import PreparedLog

BUILDS_UP = 2.5e-3
"""[rad] behind the turn, within which a contact that slid one way begins to slide the other"""
SLIDES = 5e-3
"""[rad] from the turn, from where on it does"""
REACH = 1e-2
"""[rad] that is looked at on both sides"""
LONGEST = 0.4
"""[s] for either side: what lasts longer was a stop"""
FEWEST_TURNS = 3
"""of either direction"""
FEWEST_SAMPLES = 3
"""behind a turn, and 2 on either side of that"""
SHARES = np.linspace(0.05, 1.0, 96)
"""of a torque that a dip seen in the samples may be"""
IMPERFECT = 0.05
"""share of it that other things may be that are even at turns of both directions"""
TOO_QUICK = 0.4
"""probability that the contact turns over in less than the samples show"""
MOST = 10.0
"""[nats] that the turns may say: a dip that passes for friction's would be wrong every time"""


@dataclass(frozen=True)
class Dip:
    """How much less torque a joint takes right behind its turns than well before and after them,
    beside what changes sign with the direction [Nm]."""

    depth: float
    error: float


class AtReversals:
    """Friction passes through nothing where a joint turns, also where it is larger in one direction
    than in the other; an offset of the torque does not.

    What friction as such does there is odd: at turns from backwards to forwards the opposite of
    that at the others. It falls out of the mean of both, whatever its law; what is smooth in the
    angle (gravity, inertia) falls out of the difference to both sides.
    """

    def __init__(self, motion: PreparedLog, residual: Array) -> None:
        """`residual`: torque that the robot as given leaves, shape (m, n) [Nm]."""
        self.motion = motion
        self.residual = residual
        self.dip = cache(self._dip)

    def told(self, alternative: Alternative) -> Alternative:
        """The alternative with what the turns say of it added to its evidence."""
        nats = self.nats(alternative.candidate)
        return replace(alternative, evidence=alternative.evidence + nats) if nats else alternative

    def nats(self, candidate: Candidate) -> float:
        """Log odds of an effect that passes through nothing at the turns over a constant one; zero
        for all others, and where the log does not show it [nats]."""
        effects = candidate.effects
        if len(effects) != 1 or not effects[0].search.nothing_at_turns or candidate.joint is None:
            return 0.0
        dip = self.dip(candidate.joint - 1)
        return 0.0 if dip is None else log_odds(dip, float(effects[0].coefficients()[0]))

    def _dip(self, joint: int) -> Dip | None:
        """Of one joint (from 0); None where too few turns show it."""
        if any(self.motion.recorders):
            return None  # the filter has smeared what happened there
        up, down = self._contrasts(joint)
        if min(len(up), len(down)) < FEWEST_TURNS:
            return None
        freedom = len(up) + len(down) - 2
        scatter = (np.var(up) * len(up) + np.var(down) * len(down)) / freedom
        # few turns: as wide as Student's distribution
        wide = freedom / (freedom - 2)
        error = 0.5 * np.sqrt(wide * scatter * (1 / len(up) + 1 / len(down)))
        return Dip(-0.5 * float(up.mean() + down.mean()), float(error))

    def _contrasts(self, joint: int) -> tuple[Array, Array]:
        """Torque right behind each turn less the mean of both sides, of turns to forwards and of
        those to backwards [Nm]."""
        m = self.motion
        q = m.q[:, joint]
        left = self.residual[:, joint]
        found: dict[bool, list[float]] = {True: [], False: []}
        crossings, slower = turns(m.qd[:, joint])
        longest = int(LONGEST / m.step)
        for turn in slower.tolist():
            rows = _one_turn(q, turn, longest)
            if rows is None:
                continue
            others = np.sum((crossings >= rows[0]) & (crossings < rows[-1])) > 1
            if others or any(rows[0] < start <= rows[-1] for start in m.starts):
                continue
            away = np.abs(q[rows] - q[turn])
            before = left[rows[rows < turn]]
            behind = left[rows[(rows >= turn) & (away < BUILDS_UP)]]
            after = left[rows[(rows > turn) & (away > SLIDES)]]
            if len(behind) >= FEWEST_SAMPLES and min(len(before), len(after)) >= 2:
                contrast = behind.mean() - 0.5 * (before.mean() + after.mean())
                found[bool(q[rows[-1]] > q[turn])].append(float(contrast))
        return np.array(found[True]), np.array(found[False])


def _one_turn(q: Array, turn: int, longest: int) -> npt.NDArray[np.intp] | None:
    """Samples about a turn from where the joint came within reach to where it left it; None where
    it comes or goes slower.

    Args:
        q: angles of the joint (m,) [rad]; turn: its place; longest: samples of either side.
    """
    first = max(turn - longest, 0)
    far = np.abs(q[first : turn + longest + 1] - q[turn]) > REACH
    before = np.flatnonzero(far[: turn - first])
    after = np.flatnonzero(far[turn - first :])
    if not len(before) or not len(after):
        return None
    return np.arange(first + int(before[-1]) + 1, turn + int(after[0]))


def log_odds(dip: Dip, size: float) -> float:
    """That a torque of this size [Nm] passes through nothing at the turns, over that it does not:
    a dip of any share of it that samples can show, or none that they do [nats]."""
    width = max(float(np.hypot(dip.error, IMPERFECT * size)), 1e-12)
    exponents = 0.5 * (dip.depth**2 - (dip.depth - SHARES * size) ** 2) / width**2
    seen = np.log1p(-TOO_QUICK) + logsumexp(exponents) - np.log(len(SHARES))
    return float(min(np.logaddexp(np.log(TOO_QUICK), seen), MOST))
