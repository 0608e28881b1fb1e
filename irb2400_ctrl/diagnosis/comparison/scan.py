"""Every effect of the library and every non-parametric law, scored against what is left of one
log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Mask, rms
from irb2400_ctrl.diagnosis.comparison.grid import KEPT, promising_places, step_at
from irb2400_ctrl.diagnosis.comparison.log_columns import LogColumns
from irb2400_ctrl.diagnosis.comparison.non_parametric import NonParametricLaw
from irb2400_ctrl.diagnosis.estimation.candidate import (
    EVERY_JOINT,
    Candidate,
    Point,
    most_of,
    plausible,
)
from irb2400_ctrl.diagnosis.estimation.evidence import (
    Expected,
    Problem,
    Score,
    discrepancy_shares,
    law_gains,
)
from irb2400_ctrl.diagnosis.preparation.noise import rests
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.base import within
from irb2400_ctrl.effects.gear_ripple import GearRipple
from irb2400_ctrl.effects.prior import Nested

EVERYWHERE_PENALTY = 15.0
"""[nats]"""
EITHER = float(np.log(2.0))
"""[nats] for one of two forms that are as probable"""
KEPT_NON_PARAMETRIC = 4
"""how many non-parametric laws of each joint are judged"""
OF_ONE_MOTOR = 0.5
"""of the sum of a coupling's torques, number by number without their signs, that their sum has at
least"""
ONE_SIDED = 0.2
"""rms torque on one joint over that on another, below which the other alone feels it"""


class Scan(LogColumns):
    """The columns of one log, scored against what is left of it in any situation."""

    def rank(
        self, problem: Problem, chosen: Sequence[Candidate] = (), on: Mask | None = None
    ) -> list[Candidate]:
        """All plausible candidates, best first.

        Args:
            problem: what is to be explained.
            chosen: explanations that do not come twice (but for `Search.repeats`).
            on: joints of which a candidate acts on one at least; default all, shape (n,).
        """
        n = self.motion.n
        on = np.ones(n, dtype=bool) if on is None else on
        there = [e for c in chosen for e in c.effects]
        taken = {(e.kind, e.joint) for e in there if not e.search.repeats}
        devices = {(e.search.device, e.joint) for e in there if e.search.device}
        beside = {"", *(e.kind for e in there)}
        families = [
            f
            for f in self.families
            if f not in taken
            and (LIBRARY[f[0]].search.device, f[1]) not in devices
            and on[list(self.acts_on(*f))].any()
        ]
        known = [c for kind, joint in families for c in self._library(problem, kind, joint)]
        # a shaft through two axes drags both: what one feels alone is none where no gears are
        found = [c for c in known if LIBRARY[c.kind].search.beside in beside or self._drags_both(c)]
        rest = [
            kind
            for kind, effect in LIBRARY.items()
            if effect.search.on_every_joint and kind not in {e.kind for e in there}
        ]
        found += [c for kind in rest if (c := self._everywhere(problem, kind)) is not None]
        found += [
            c for joint in range(n) if on[joint] for c in self._non_parametric(problem, joint)
        ]
        found += [
            self._flexible(problem, self.ripple_over_angle(e.index, e.order))
            for c in known
            for e in c.effects
            if isinstance(e, GearRipple) and c.score.gain > 0
        ]
        found += [self._vibration(problem, joint) for joint in range(n) if on[joint]]
        return sorted((c for c in found if c.score.gain > 0), key=lambda c: -c.score.gain)

    def _drags_both(self, candidate: Candidate) -> bool:
        """Whether both axes of a coupling feel it, and all its numbers are of one motor: it turns
        c times as fast by the other axis, and c stands in each of them."""
        size = rms(candidate.torque(self.motion.n))[list(candidate.law.joints)]
        columns = np.sqrt(np.mean(candidate.law.values**2, axis=(0, 1)))
        worth = columns * candidate.score.coefficients
        of_one = abs(np.sum(worth)) > OF_ONE_MOTOR * np.sum(np.abs(worth))
        return bool(of_one and size.min() > ONE_SIDED * size.max())

    def points(
        self, problem: Problem, joint: int | None, windows: Sequence[tuple[float, float]] = ()
    ) -> list[Point]:
        """Promising members of every effect that could act in these windows on a joint (None: on
        the whole arm)."""
        found = []
        acting = within(windows, self.motion.row_time)[:, None, None]
        for kind, at in self.families:
            if at != joint or not self.acts_on(kind, at):
                continue
            grid, always = self.laws[kind, at]
            # the filter's reach across the edges of the windows hardly matters for a first look
            laws = (
                [RegressorColumns(law.joints, law.values * acting) for law in always]
                if windows
                else always
            )
            # what comes and goes is looked for in each of its forms
            apart = LIBRARY[kind].search.comes_and_goes
            forms = self.forms(kind, always[0]) if apart else (None,)
            found += [
                Point(kind, at, grid[place], form)
                for place in self.promising(problem, kind, at, laws)[:KEPT]
                for form in forms
            ]
        return found

    def _library(self, problem: Problem, kind: str, joint: int | None) -> list[Candidate]:
        grid, laws = self.laws[kind, joint]
        best: Candidate | None = None
        for looked, place in enumerate(self.promising(problem, kind, joint, laws)):
            if looked >= KEPT and best is not None and not LIBRARY[kind].search.device:
                break
            nonlinear = grid[place]
            forms = self.forms(kind, self.member(kind, joint, nonlinear)[0])
            # what acts always would take the place of a load, and of more, in its whole form
            forms = forms[:1] if LIBRARY[kind].search.comes_and_goes else forms
            # a family with many members must win by more
            chosen = self.family_penalty(kind, joint, nonlinear)
            penalty = chosen + float(np.log(len(forms)))
            for form in forms:
                tried = self.in_form(problem, (kind, joint), nonlinear, form, penalty)
                anew = LIBRARY[kind].about(form, tried.score.coefficients)
                if anew is not None:
                    tried = self.in_form(problem, (kind, joint), nonlinear, anew, penalty)
                if tried.effects and (best is None or tried.score.gain > best.score.gain):
                    best = tried
        return [] if best is None else [best]

    def in_form(
        self,
        problem: Problem,
        family: tuple[str, int | None],
        nonlinear: dict[str, float],
        form: Nested,
        penalty: float,
    ) -> Candidate:
        """A member of a family in one of its forms; without an effect where its numbers are not
        plausible.

        Args:
            problem: to score it on.
            family: kind and joint; nonlinear: its numbers beside the law's coefficients.
            form: of the law; penalty: for the choice among members [nats].
        """
        kind, joint = family
        law, departures = self.member(kind, joint, nonlinear)
        extra: RegressorColumns | None = departures
        columns = RegressorColumns(law.joints, law.values @ form.columns)
        score = self._score(problem, kind, columns, departures, form.coefficients)
        if LIBRARY[kind].ambiguity.change_of:
            # it may as well be another number of the base, which follows that law
            exact = problem.score(columns, expected=form.coefficients)
            penalty += EITHER
            if exact.gain > score.gain:
                score = exact
                extra = None
        score = replace(score, gain=score.gain - penalty)
        effect = plausible(kind, joint, form.columns @ score.coefficients, nonlinear)
        effects = () if effect is None else (effect,)
        expected = form.coefficients
        return Candidate(kind, joint, kind, (), effects, columns, extra, score, penalty, expected)

    def between(self, problem: Problem, candidate: Candidate) -> Candidate:
        """The candidate with its nonlinear parameters searched between the neighbours in the grid,
        one after the other; those of an effect of the file stay."""
        if not candidate.known or not LIBRARY[candidate.kind].search.between_grid:
            return candidate
        family = (candidate.kind, candidate.joint)
        if candidate.effects[0].nonlinear in self.stated_points(*family):
            return candidate
        grid, _ = self.laws[family]
        best = candidate
        start = best.effects[0]
        moving = [key for key in grid[0] if key not in start.prior.fixed]
        widths = {key: 0.5 * step_at(grid, key, start.nonlinear[key]) for key in moving}
        for _ in range(3):
            for key, width in widths.items():
                there = best.effects[0].nonlinear
                for side in (-1, 1):
                    trial = self.moved(problem, best, {**there, key: there[key] + side * width})
                    if trial is not None and trial.score.gain > best.score.gain:
                        best = trial
                widths[key] = width / 2
        return best

    def moved(
        self, problem: Problem, candidate: Candidate, nonlinear: dict[str, float]
    ) -> Candidate | None:
        """The candidate with other nonlinear parameters; None where no such thing is.

        Args:
            problem: what it is to explain.
            candidate: as it is.
            nonlinear: its parameters by name.
        """
        kind = candidate.kind
        joint = candidate.joint
        law, extra = self.member(kind, joint, nonlinear)
        score = self._score(problem, kind, law, extra, candidate.expected)
        score = replace(score, gain=score.gain - candidate.penalty)
        effect = plausible(kind, joint, score.coefficients, nonlinear)
        return (
            None
            if effect is None
            else replace(candidate, effects=(effect,), law=law, discrepancy=extra, score=score)
        )

    def _score(
        self,
        problem: Problem,
        kind: str,
        law: RegressorColumns,
        extra: RegressorColumns,
        expected: Expected,
    ) -> Score:
        return problem.score(
            law,
            extra,
            expected,
            discrepancy_shares(kind, extra.values.shape[2]),
        )

    def promising(
        self, problem: Problem, kind: str, joint: int | None, laws: list[RegressorColumns]
    ) -> list[int]:
        """Places in the grid worth a closer look.

        Args:
            problem: to score them on.
            kind, joint: the family; laws: columns of the whole grid.
        """
        if len(laws) == 1:
            return [0]
        if LIBRARY[kind].states:
            # on the joint itself, law and beginning as free columns
            (own,) = laws[0].joints
            both = zip(laws, self.remembering[kind, joint], strict=True)
            blocks = [np.hstack([law.values[:, 0], extra.values[:, 0]]) for law, extra in both]
            gains = problem.gains(own, blocks)
        elif len(laws[0].joints) == 1:
            gram, right = problem.projected_many(
                laws[0].joints[0], np.stack([law.values[:, 0] for law in laws])
            )
            gains = law_gains(gram, right)
        else:
            gains = np.array([problem.score(law).gain for law in laws])
        return promising_places(gains)

    def _everywhere(self, problem: Problem, kind: str) -> Candidate | None:
        """One effect on every joint at once, with a size for each that moves."""
        n = self.motion.n
        law = everywhere([self.laws[kind, j + 1][1][0] for j in range(n)], n)
        score = problem.score(law)
        effects = [
            plausible(kind, j + 1, score.coefficients[j : j + 1], {}) if moves else None
            for j, moves in enumerate(~rests(self.motion.row_known))
        ]
        # a joint that does not show it may come out slightly negative
        present = tuple(e for e in effects if e is not None)
        if len(present) < most_of(self.motion):
            return None
        # one joint alone is the simpler story unless several clearly show it
        score = replace(score, gain=score.gain - EVERYWHERE_PENALTY)
        return Candidate(
            kind, None, f"{kind} {EVERY_JOINT}", (), present, law, None, score, EVERYWHERE_PENALTY
        )

    def _non_parametric(self, problem: Problem, joint: int) -> list[Candidate]:
        """The best non-parametric laws of one joint (zero-based)."""
        laws = self.non_parametric[joint]
        gains = problem.gains(joint, [law.columns for law in laws])
        found = []
        for place in np.argsort(-gains)[:KEPT_NON_PARAMETRIC]:
            found.append(self._flexible(problem, laws[place]))
        return found

    def _flexible(self, problem: Problem, law: NonParametricLaw) -> Candidate:
        """A flexible law as a candidate."""
        columns = RegressorColumns((law.joint,), law.columns[:, None, :])
        return Candidate(
            "unexplained",
            law.joint + 1,
            law.name,
            law.depends_on,
            (),
            columns,
            None,
            problem.score(columns),
            against_motion=law.against_motion,
            freer=law.freer,
        )

    def _vibration(self, problem: Problem, joint: int) -> Candidate:
        frequency, values = self.vibrations
        gram, right = problem.projected_many(joint, values)
        explained = np.einsum(
            "gi,gi->g", right, np.linalg.solve(gram + 1e-9 * np.eye(2), right[..., None])[..., 0]
        )
        place = int(np.argmax(explained))
        law = RegressorColumns((joint,), values[place][:, None, :])
        score = problem.score(law)
        penalty = float(np.log(len(frequency)))
        score = replace(score, gain=score.gain - penalty)
        name = f"vibration of {frequency[place]:.2f} Hz"
        return Candidate("unexplained", joint + 1, name, ("time",), (), law, None, score, penalty)


def everywhere(laws: Sequence[RegressorColumns], n: int) -> RegressorColumns:
    """One column per joint from the laws of one column on each joint."""
    values = np.zeros((len(laws[0].values), n, n))
    for j, law in enumerate(laws):
        values[:, j, j] = law.values[:, 0, 0]
    return RegressorColumns(tuple(range(n)), values)
