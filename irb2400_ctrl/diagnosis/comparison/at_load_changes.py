"""What the neighbours of a joint feel as its load changes sides: a link that has play falls across
the gap and bounces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.signal import butter, sosfiltfilt

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.uniform import widened
from irb2400_ctrl.model import Model

WRIST = 3
"""axes from the flange on that feel each other's links bounce; the larger ones have other noise"""
ABOVE_HZ = 12.0
"""a bounce is quicker than what the motion asks for"""
BEFORE = 0.012
"""[s] before the load changes sides; the moment comes from accelerations and is not sharp"""
AFTER = 0.07
"""[s] behind it"""
FADES = 0.035
"""[s]"""
STANDING = 0.02
"""[rad/s] at and near which friction of a joint is no witness of anything else"""
NEAR = 0.12
"""[s] from there"""
ACCELERATIONS = 2.0 ** np.arange(8)
"""[rad/s2] of the link that bounces"""
OF_ONE_MOMENT = 3.0
"""[nats] that one moment may say to one joint: it is no play that shows once"""
FEWEST = 10
"""samples that tell something of it, and ten times as many that tell of the noise"""
CORRELATED = 0.5
"""share of the filtered samples that say something of their own"""
LEAST = 8.0
"""[nats] from which on a joint has been seen to rattle; a swing of its own transmission is heard as
well, a flaw of another axis' one may be, other effects are not (benchmarks/load_changes.py)"""


@dataclass(frozen=True)
class _Bounces:
    """Where a link would bounce, for each sample.

    Args:
        torque: on every joint for an acceleration of 1 rad/s2 just behind the moment, faded (m, n)
            [Nm].
        moment: place of the moment among all of the joint (m,), -1 where there is none.
    """

    torque: Array
    moment: Array
    count: int


class AtLoadChanges:
    """A link with play accelerates on its own as its load changes sides, quicker than a base or a
    law of slow columns can follow, and its neighbours have to hold against that.

    So the neighbours' quick residual is larger at these moments than elsewhere, by the entry of the
    mass matrix that couples the two: which joint it is, is told by where and when it is felt.
    """

    def __init__(self, motion: PreparedLog, residual: Array, load: Array, model: Model) -> None:
        """Of one log.

        Args:
            motion: the log, prepared; residual: what the robot as given leaves of its torque.
            load: torque that the transmissions carry, both of shape (m, n) [Nm].
            model: of that robot.
        """
        self.motion = motion
        self.residual = residual
        self.load = load
        self.model = model

    @cached_property
    def seen(self) -> dict[int, float]:
        """Joint (from 1) -> log odds that its link rattles [nats]; the clearest alone, for its
        neighbours bounce with it, and none below `LEAST`."""
        m = self.motion
        if any(m.recorders) or m.step * ABOVE_HZ > 0.25:
            return {}  # what is quick has not been recorded
        nats = {j: self._nats(j) for j in range(max(m.n - WRIST, 0), m.n)}
        joint = max(nats, key=lambda j: nats[j])
        return {joint + 1: nats[joint]} if nats[joint] >= LEAST else {}

    def rattles(self, candidate: Candidate, chosen: Sequence[Candidate] = ()) -> float:
        """Log odds of an effect that makes a link rattle, of the joint that was seen to; zero for
        all others [nats], and beside a chosen flaw of another transmission: that shakes the whole
        wrist.
        """
        effects = candidate.effects
        if len(effects) != 1 or not effects[0].search.rattles or candidate.joint is None:
            return 0.0
        if any(candidate.devices & other.devices for other in chosen):
            return 0.0
        return self.seen.get(candidate.joint, 0.0)

    def told(self, alternative: Alternative, chosen: Sequence[Candidate] = ()) -> Alternative:
        """The alternative with what the neighbours say of it added to its evidence; arguments as
        of `rattles`."""
        nats = self.rattles(alternative.candidate, chosen)
        if not nats:
            return alternative
        return replace(alternative, evidence=alternative.evidence + nats, rattles=True)

    def _nats(self, joint: int) -> float:
        """Of the best acceleration, or of none."""
        bounces = self._bounces(joint)
        witnesses = [i for i in range(self.motion.n - WRIST, self.motion.n) if i != joint]
        return max(0.0, *(sum(self._said(i, bounces, a) for i in witnesses) for a in ACCELERATIONS))

    def _said(self, witness: int, bounces: _Bounces, acceleration: float) -> float:
        """What the quick residual of a neighbour says of one acceleration [nats]."""
        feels = bounces.torque[:, witness]
        calm = self._calm[:, witness]
        at = calm & (feels > 0)
        away = calm & (feels <= 0)
        if at.sum() < FEWEST or away.sum() < 10 * FEWEST:
            return 0.0
        noise = float(np.mean(self._quick[away, witness] ** 2))
        variance = noise + (acceleration * feels[at]) ** 2
        square = self._quick[at, witness] ** 2
        nats = 0.5 * (square / noise - square / variance - np.log(variance / noise))
        moments = np.bincount(bounces.moment[at], CORRELATED * nats, bounces.count)
        return float(np.minimum(moments, OF_ONE_MOMENT).sum())

    def _bounces(self, joint: int) -> _Bounces:
        """Where the load of a joint changes sides, and what its neighbours would feel."""
        m = self.motion
        torque = np.zeros((len(m.time), m.n))
        moment = np.full(len(m.time), -1)
        moments = [
            (k, part)
            for part in m.parts
            for k in part.start + 1 + np.flatnonzero(np.diff(np.sign(self.load[part, joint])))
        ]
        for place, (k, part) in enumerate(moments):
            first = max(k - round(BEFORE / m.step), part.start)
            rows = np.arange(first, min(k + round(AFTER / m.step), part.stop))
            fade = np.exp(-np.maximum(rows - k, 0) * m.step / FADES)
            torque[rows] = fade[:, None] * np.abs(self.model.mass_matrix(m.q[k])[:, joint])
            moment[rows] = place
        return _Bounces(torque, moment, len(moments))

    @cached_property
    def _quick(self) -> Array:
        """What of the residual is quicker than the motion, shape (m, n) [Nm]."""
        m = self.motion
        high = butter(2, ABOVE_HZ, "high", fs=1.0 / m.step, output="sos")
        return np.concatenate([sosfiltfilt(high, self.residual[part], axis=0) for part in m.parts])

    @cached_property
    def _calm(self) -> Mask:
        """Samples at which a joint is a witness: known, neither standing nor near that, shape
        (m, n)."""
        m = self.motion
        standing = np.abs(m.qd) < STANDING
        return np.asarray(m.known & ~widened(standing, round(NEAR / m.step)))
