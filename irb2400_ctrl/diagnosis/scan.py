"""Every effect of the library and every generic law, scored against what is left of one log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from irb2400_ctrl.diagnosis.bases import Bases, Columns
from irb2400_ctrl.diagnosis.evidence import Problem, Score, departure_unit, g_prior_gain
from irb2400_ctrl.diagnosis.generic import Generic, generic_laws, vibrations
from irb2400_ctrl.diagnosis.motion import Motion
from irb2400_ctrl.effects import LIBRARY, Effect

Array = npt.NDArray[np.float64]

EVERYWHERE = ("rotor_inertia",)
"""effects that a maker leaves out of all joints alike"""
KEPT_GENERIC = 4
"""how many generic laws of each joint are judged"""
KEPT_GRID_POINTS = 2
"""how many of the best nonlinear parameters of a family are scored with departures"""


@dataclass(frozen=True)
class Candidate:
    """An explanation with its score.

    Args:
        kind, joint: of the effect (joint from 1, None for the whole arm), or `unexplained` with the joint.
        depends_on: signals of a generic law, empty for an effect.
        effects: as the scan estimates it (one per joint for an effect that sits on every joint); empty for a generic law.
        law, departures: filtered columns.
    """

    kind: str
    joint: int | None
    name: str
    depends_on: tuple[str, ...]
    effects: tuple[Effect, ...]
    law: Columns
    departures: Columns | None
    score: Score
    penalty: float = 0.0
    """log number of members of its family [nats]"""

    def torque(self, n: int) -> Array:
        """Filtered torque as scored, departures included, shape (rows, n)."""
        tau = self.law.torque(self.score.coefficients, n)
        if self.departures is not None and len(self.score.departures):
            tau += self.departures.torque(self.score.departures, n)
        return tau

    @property
    def departure_unit(self) -> Array:
        """One standard deviation of each departure coefficient, shape (d,)."""
        if self.departures is None:
            return np.zeros(0)
        return departure_unit(self.law, self.score.coefficients, self.departures)

    @property
    def known(self) -> bool:
        """Whether it is an effect of the library."""
        return bool(self.effects)


class Scan:
    """The columns of one log, computed once; `rank` scores them in any situation."""

    def __init__(self, bases: Bases, motion: Motion, load: Array) -> None:
        self.bases, self.motion, self.load = bases, motion, load

    @cached_property
    def families(self) -> list[tuple[str, int | None]]:
        """Effects that can act: joints that hardly move carry only what needs no motion of theirs."""
        n = self.motion.n
        return [
            (kind, joint)
            for kind, effect in LIBRARY.items()
            for joint in effect.joints(n)
            if joint is None or joint <= n
        ]

    @cached_property
    def laws(self) -> dict[tuple[str, int | None], tuple[list[dict[str, float]], list[Columns]]]:
        """Grid and filtered columns of each family."""
        found = {}
        for kind, joint in self.families:
            grid = LIBRARY[kind].grid(joint)
            found[kind, joint] = (grid, self.bases.columns(kind, joint, self.motion, grid))
        return found

    @cached_property
    def generics(self) -> dict[int, list[Generic]]:
        """Filtered columns of the generic laws, by joint."""
        return generic_laws(self.motion, self.load)

    def departures(self, kind: str, joint: int | None, nonlinear: dict[str, float]) -> Columns:
        """Filtered columns of an effect's departures."""
        return self.bases.columns(kind, joint, self.motion, [nonlinear], departures=True)[0]

    def rank(self, problem: Problem) -> list[Candidate]:
        """All plausible candidates, best first."""
        found = [c for kind, joint in self.families for c in self._library(problem, kind, joint)]
        found += [c for kind in EVERYWHERE if (c := self._everywhere(problem, kind)) is not None]
        found += [c for joint in range(self.motion.n) for c in self._generic(problem, joint)]
        found += [self._vibration(problem, joint) for joint in range(self.motion.n)]
        return sorted((c for c in found if c.score.gain > 0), key=lambda c: -c.score.gain)

    def scales(self, candidate: Candidate) -> Sequence[float]:
        """Plausible sizes of a candidate's coefficients, empty if not known."""
        return LIBRARY[candidate.kind].scales if candidate.known else ()

    def _library(self, problem: Problem, kind: str, joint: int | None) -> list[Candidate]:
        grid, laws = self.laws[kind, joint]
        if not laws[0].joints:
            return []  # no torque of this arm depends on it (zero of axis 1)
        best: Candidate | None = None
        for place in _promising(problem, laws):
            nonlinear, law = grid[place], laws[place]
            extra = self.departures(kind, joint, nonlinear)
            score = problem.score(law, extra, LIBRARY[kind].scales)
            # a family with many members must win by more
            penalty = float(np.log(len(grid)))
            score = replace(score, gain=score.gain - penalty)
            effect = plausible(kind, joint, score.coefficients, nonlinear)
            if effect is not None and (best is None or score.gain > best.score.gain):
                best = Candidate(kind, joint, kind, (), (effect,), law, extra, score, penalty)
        return [] if best is None else [best]

    def _everywhere(self, problem: Problem, kind: str) -> Candidate | None:
        """One effect on every joint at once, with a size for each."""
        n = self.motion.n
        law = everywhere([self.laws[kind, j + 1][1][0] for j in range(n)], n)
        score = problem.score(law)
        effects = [plausible(kind, j + 1, score.coefficients[j : j + 1], {}) for j in range(n)]
        # a joint that does not show it may come out slightly negative
        present = tuple(e for e in effects if e is not None)
        if len(present) < max(2, n - 2):
            return None
        return Candidate(kind, None, f"{kind} of every joint", (), present, law, None, score)

    def _generic(self, problem: Problem, joint: int) -> list[Candidate]:
        """The best generic laws of one joint (zero-based)."""
        laws = self.generics[joint]
        gains = problem.gains(joint, [law.columns for law in laws])
        found = []
        for place in np.argsort(-gains)[:KEPT_GENERIC]:
            law = laws[place]
            columns = Columns((joint,), law.columns[:, None, :])
            score = problem.score(columns)
            found.append(Candidate("unexplained", joint + 1, law.name, law.depends_on, (), columns, None, score))
        return found

    def _vibration(self, problem: Problem, joint: int) -> Candidate:
        frequency, values = vibrations(self.motion, joint)
        gram, right = problem.projected_many(joint, values)
        explained = np.einsum("gi,gi->g", right, np.linalg.solve(gram + 1e-9 * np.eye(2), right[..., None])[..., 0])
        place = int(np.argmax(explained))
        law = Columns((joint,), values[place][:, None, :])
        score, penalty = problem.score(law), float(np.log(len(frequency)))
        score = replace(score, gain=score.gain - penalty)
        name = f"vibration of {frequency[place]:.2f} Hz"
        return Candidate("unexplained", joint + 1, name, ("time",), (), law, None, score, penalty)


def _promising(problem: Problem, laws: Sequence[Columns]) -> list[int]:
    """Places in the grid worth a closer look."""
    if len(laws) == 1:
        return [0]
    if len(laws[0].joints) == 1:
        gram, right = problem.projected_many(laws[0].joints[0], np.stack([law.values[:, 0] for law in laws]))
        k = right.shape[1]
        size = np.sqrt(np.maximum(np.einsum("gii->gi", gram), 0)) + 1e-12
        normal = gram / (size[:, :, None] * size[:, None, :]) + 1e-8 * np.eye(k)
        explained = np.einsum("gi,gi->g", right / size, np.linalg.solve(normal, (right / size)[..., None])[..., 0])
        gains = g_prior_gain(explained, k)
    else:
        gains = np.array([problem.score(law).gain for law in laws])
    return [int(place) for place in np.argsort(-np.asarray(gains))[:KEPT_GRID_POINTS]]


def plausible(kind: str, joint: int | None, coefficients: Array, nonlinear: dict[str, float]) -> Effect | None:
    """The effect with these coefficients if its bounds allow them, else None."""
    try:
        return LIBRARY[kind].from_coefficients(joint, [float(c) for c in coefficients], nonlinear)
    except (ValidationError, ZeroDivisionError):
        return None


def everywhere(laws: Sequence[Columns], n: int) -> Columns:
    """One column per joint from the laws of one column on each joint."""
    values = np.zeros((len(laws[0].values), n, n))
    for j, law in enumerate(laws):
        values[:, j, j] = law.values[:, 0, 0]
    return Columns(tuple(range(n)), values)
