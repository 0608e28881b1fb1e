"""What may explain a log: an effect with its numbers, or a flexible law; columns and score beside
it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.preparation.noise import rests
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.prior import Nested
from irb2400_ctrl.measurement.prepared_log import PreparedLog

EVERY_JOINT = "of every joint"
"""in the name of effects of one kind, one on each joint, with a size each"""
NON_PARAMETRIC_SHARE = 0.5
"""share of its torque that a flexible law may leave: what is left is more of the same unknown"""
SMALL_FAMILY = 20
"""members of a family that still is one law"""


@dataclass(frozen=True)
class Candidate:
    """An explanation with its score.

    Args:
        kind, joint: of the effect (joint from 1, None for the whole arm), or `unexplained` with the
            joint.
        depends_on: signals of a non-parametric law, empty for an effect.
        effects: as the scan estimates it (one per joint if it sits on every joint); empty for a
            non-parametric law.
        law, discrepancy: filtered columns.
        against_motion: whether a non-parametric law turns over with the direction.
        freer: kind of an effect that such a law holds with more freedom.
    """

    kind: str
    joint: int | None
    name: str
    depends_on: tuple[str, ...]
    effects: tuple[Effect, ...]
    law: RegressorColumns
    discrepancy: RegressorColumns | None
    score: Score
    penalty: float = 0.0
    """log number of members of its family [nats]"""
    expected: tuple[tuple[float, float], ...] = ()
    """usual value and spread of each coefficient; empty: no such knowledge"""
    spread: dict[str, float] = field(default_factory=dict)
    """standard errors of nonlinear parameters that a search has found, from the noise alone"""
    against_motion: bool = False
    freer: str = ""

    def torque(self, n: int) -> Array:
        """Filtered torque as scored, discrepancy included, shape (rows, n)."""
        tau = self.law.torque(self.score.coefficients, n)
        if self.discrepancy is not None and len(self.score.discrepancy):
            tau += self.discrepancy.torque(self.score.discrepancy, n)
        return tau

    def acts_on(self, n: int) -> Mask:
        """Joints that it gives a torque, shape (n,)."""
        return np.asarray(np.any(self.torque(n) != 0.0, axis=0))

    def only(self, members: Sequence[bool]) -> Candidate:
        """Of one effect on every joint, which has a column for each: with some of its effects."""
        kept = tuple(e for e, stays in zip(self.effects, members, strict=True) if stays)
        coefficients = np.zeros_like(self.score.coefficients)
        places = [e.index for e in kept]
        coefficients[places] = self.score.coefficients[places]
        return replace(self, effects=kept, score=replace(self.score, coefficients=coefficients))

    @property
    def discrepancy_share(self) -> float:
        """Share of its torque that it may leave for others to explain."""
        return max((e.prior.discrepancy_share for e in self.effects), default=NON_PARAMETRIC_SHARE)

    @property
    def devices(self) -> frozenset[str]:
        """Parts of joints that its effects are flaws of."""
        return frozenset(e.search.device for e in self.effects if e.search.device)

    @property
    def begins(self) -> tuple[float, ...]:
        """Times at which its effects begin [s]; empty for what acts always."""
        return tuple(e.windows_s[0][0] for e in self.effects if e.windows_s)

    @property
    def everywhere(self) -> bool:
        """Whether it is one effect on every joint."""
        return self.joint is None and any(e.joint is not None for e in self.effects)

    @property
    def rattles(self) -> bool:
        """Whether most of it is quicker than what is compared."""
        return any(e.search.rattles for e in self.effects)

    @property
    def has_own_shape(self) -> bool:
        """Whether numbers shape its law, not a choice alone as that of the axes of a force."""
        return any(
            not isinstance(getattr(e, name), bool) for e in self.effects for name in e.nonlinear
        )

    @property
    def known(self) -> bool:
        """Whether it is an effect of the library."""
        return bool(self.effects)


@dataclass(frozen=True)
class Point:
    """One effect of the library with its nonlinear parameters fixed, in a simpler form or as it
    is."""

    kind: str
    joint: int | None
    nonlinear: dict[str, float]
    form: Nested | None = None

    def in_form(self, law: RegressorColumns) -> RegressorColumns:
        """Its columns, of those of its law."""
        if self.form is None:
            return law
        return RegressorColumns(law.joints, law.values @ self.form.columns)

    def coefficients(self, numbers: Array) -> Array:
        """Those of its law, of the numbers of its form."""
        return numbers if self.form is None else np.asarray(self.form.columns @ numbers)

    @property
    def device(self) -> str:
        """`Search.device`."""
        return LIBRARY[self.kind].search.device


def most_of(motion: PreparedLog) -> int:
    """So many joints at least (half of those that move) have what is one effect on every joint."""
    moving = int(np.sum(~rests(motion.row_known)))
    return max(2, (moving + 1) // 2)


def plausible(
    kind: str, joint: int | None, coefficients: Array, nonlinear: dict[str, float]
) -> Effect | None:
    """The effect with these coefficients if its bounds allow them and it is large enough to be
    named, else None.

    Args:
        kind: of the effect.
        joint: counted from 1; None of the whole arm.
        coefficients: of its basis.
        nonlinear: its other parameters by name.
    """
    try:
        effect = LIBRARY[kind].from_coefficients(joint, [float(c) for c in coefficients], nonlinear)
    except (ValueError, ZeroDivisionError):
        return None
    return None if effect.unlikely else effect


def simple(candidate: Candidate) -> bool:
    """Whether an effect's family is one law."""
    return bool(candidate.penalty < np.log(SMALL_FAMILY))
