"""What a step of the selection compares, and what it settles on: rivals, what is left, the accepted step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.diagnosis.noise import Noise
from irb2400_ctrl.diagnosis.scan import Candidate

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Rival:
    """A candidate with its own noise model.

    Args:
        evidence: log evidence under the noise that the candidate leaves [nats].
        by_law: what it gains without departures from its law [nats].
    """

    candidate: Candidate
    evidence: float
    by_law: float


@dataclass(frozen=True)
class Left:
    """What the explanations so far leave, per joint.

    Args:
        energy: mean square away from reversals [Nm2]; noise: of it.
    """

    energy: Array
    noise: Sequence[Noise]

    def by_joint(self, gain: float, torque: Array) -> Array:
        """The gain [nats] of a whole arm's effect, shared among the joints as its torque (rows, n) stands out there."""
        seen = np.array([np.sum(one.whiten(torque[:, j]) ** 2) for j, one in enumerate(self.noise)])
        return np.asarray(max(gain, 0.0) * seen / max(seen.sum(), 1e-12))


@dataclass(frozen=True)
class Step:
    """One accepted explanation.

    Args:
        candidate: accepted; gain: log evidence over the model without it; rivals: others, best first.
    """

    candidate: Candidate
    gain: float
    rivals: tuple[Rival, ...]

    @property
    def margin(self) -> float:
        """Evidence over the best other effect of the library [nats]; the gain itself where there is none.

        For a generic law: over the best effect. A flexible function of the same signals is no rival of a law.
        """
        best = next(r.evidence for r in self.rivals if r.candidate is self.candidate)
        others = [r.evidence for r in self.rivals if r.candidate.known and not _same(r.candidate, self.candidate)]
        return float(min(best - max(others, default=-np.inf), self.gain))


def _same(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates say the same, one of them perhaps for every joint."""
    return one.kind == other.kind and (one.joint == other.joint or None in (one.joint, other.joint))
