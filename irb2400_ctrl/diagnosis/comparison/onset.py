"""Effects that act only part of the time: one that begins in the middle of a record, a force that
comes and goes."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from itertools import chain, pairwise

import numpy as np

from irb2400_ctrl.arrays import true_stretches
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate, Point, plausible
from irb2400_ctrl.diagnosis.estimation.evidence import Problem, law_gain
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.base import OPEN_END_S, within

Windows = tuple[tuple[float, float], ...]

CLEARLY = 15.0
"""[nats] an effect that acts always is the simpler story"""
PER_EDGE = 5.0
"""[nats] for every further time of switching: about the log of the places where it could be"""
BLOCK = 0.5
"""[s] resolution of the first look at a force over time"""
STARTS = 16
FINER = 3
"""how many widths, each half of the last, an edge is moved by in one pass over the log"""
EDGE_DIGITS = 6
"""of the time of an edge [s]"""
BRIEF = 2.0
"""[s] that a push lasts in all"""
MORE = 0.15
"""share by which a moment beside a brief force must explain more than the force: a push that swells
is none that is constant, and what that leaves was worth 0 to 6 % to a moment (24 % once, on 24
knocks through the tool centre point), a lever of 0.25 m 30 % and more"""
TRIED = 6
"""how many effects are judged as acting part of the time, and as many again in the same times as
the best of them"""
JOINTS_OF = 3
"""how many of the best effects say on which joints to look"""


class Windowing:
    """Tries the effects of one scan as acting part of the time, under one problem."""

    def __init__(self, scan: Scan, problem: Problem) -> None:
        self.scan = scan
        self.problem = problem
        self.motion = scan.motion

    def candidates(self, joints: Collection[int | None]) -> list[Candidate]:
        """Effects of these joints and of the whole arm that clearly explain more when they act part
        of the time only.

        In the times of the best of them, whatever else could act on its joint is tried too.
        """
        looks = [
            look
            for joint in {*joints, None}
            for law in self.scan.points(self.problem, joint)
            if (look := self._look(law))
        ]
        looks = sorted(looks, key=lambda look: -look[2])[:TRIED]
        found = [
            part
            for law, windows, _ in looks
            if (part := self._acting(law, self._sharpened(law, windows)))
        ]
        if not found:
            return []
        best = max(found, key=lambda part: part.score.gain)
        windows = best.effects[0].windows_s
        tried = {(part.kind, part.joint) for part in found}
        laws = [
            law
            for joint in {best.joint, None}
            for law in self.scan.points(self.problem, joint, windows)
        ]
        laws = [law for law in laws if not law.device and (law.kind, law.joint) not in tried]
        same = [part for law in laws if (part := self._acting(law, windows))]
        return found + sorted(same, key=lambda part: -part.score.gain)[:TRIED]

    def _look(self, law: Point) -> tuple[Point, Windows, float] | None:
        """An effect with the times in which it explains clearly more than always, and what it gains
        then."""
        if law.device:
            # no transmission becomes soft within a record; a livelier motion would pass for it
            return None
        windows, gain, always = self._begun(law)
        if LIBRARY[law.kind].search.comes_and_goes:
            for comes_and_goes in self._on_and_off(law):
                pieces = self._in_pieces(law, chain(*comes_and_goes))
                worth = _worth_their_edges(comes_and_goes, pieces)
                if (there := pieces(worth)) > gain:
                    windows = worth
                    gain = there
        return (law, windows, gain) if gain > always + CLEARLY / 2 else None

    def _acting(self, law: Point, windows: Windows) -> Candidate | None:
        """An effect acting in these windows only, if it is plausible there; their choice is paid
        for."""
        columns = self._columns(law, windows)
        # how an effect with memory began is told by its window
        extra = None if LIBRARY[law.kind].states else self._columns(law, windows, discrepancy=True)
        score = self.problem.score(columns, extra, LIBRARY[law.kind].prior.coefficients)
        numbers = law.coefficients(score.coefficients)
        effect = plausible(law.kind, law.joint, numbers, law.nonlinear)
        if effect is None or not self._asks_for_its_form(law, windows, score.gain):
            return None
        edges = sum(edge < OPEN_END_S for window in windows for edge in window)
        chosen = self.scan.family_penalty(law.kind, law.joint, law.nonlinear)
        penalty = chosen + CLEARLY + PER_EDGE * (edges - 1)
        part = type(effect).model_validate({**effect.model_dump(), "windows_s": windows})
        score = replace(score, gain=score.gain - penalty)
        name = f"{law.kind}, part of the time"
        expected = LIBRARY[law.kind].prior.coefficients
        return Candidate(
            law.kind, law.joint, name, (), (part,), columns, extra, score, penalty, expected
        )

    def _asks_for_its_form(self, law: Point, windows: Windows, gain: float) -> bool:
        """Whether a form of a law gains clearly more in short windows than its simplest, whatever
        the nonlinear parameters of that: in few postures each looks like the other."""
        if law.form is None or _lasting(windows) > BRIEF:
            return True
        grid, laws = self.scan.laws[law.kind, law.joint]
        simplest = self.scan.forms(law.kind, laws[0])[0]
        if law.form.columns.shape == simplest.columns.shape:
            return True
        simpler = [replace(law, nonlinear=there, form=simplest) for there in grid]
        gains = [self.problem.score(self._columns(one, windows)).gain for one in simpler]
        return gain > (1.0 + MORE) * max(gains)

    def _columns(self, law: Point, windows: Windows, discrepancy: bool = False) -> RegressorColumns:
        whole = self.scan.samples(law, discrepancy)
        acting = within(windows, self.motion.time)[:, None, None]
        return RegressorColumns(whole.joints, self.motion.filtered(whole.values * acting))

    def _in_pieces(self, law: Point, edges: Iterable[float]) -> Callable[[Windows], float]:
        """What a law gains in windows between some of these edges [nats], from one pass over the
        log; the filter's reach across an edge is left out."""
        edges = np.unique(np.round([*edges, OPEN_END_S], EDGE_DIGITS))
        columns = self.scan.columns(law)
        place = np.searchsorted(edges, self.motion.row_time, side="right")
        gram, right = self.problem.projected_in_blocks(columns, place)
        k = columns.values.shape[2]
        count = len(right) // k
        # sums up to each edge: a window is the difference of two
        whole = np.zeros((count + 1, count + 1, k * k))
        blocks = gram.reshape(count, k, count, k).transpose(0, 2, 1, 3)
        inside = whole[1:, 1:]
        np.cumsum(blocks.reshape(count, count, -1), axis=0, out=inside)
        np.cumsum(inside, axis=1, out=inside)
        sums = np.zeros((count + 1, k))
        sums[1:] = right.reshape(count, k).cumsum(axis=0)
        expected = LIBRARY[law.kind].prior.coefficients

        def gain(windows: Windows) -> float:
            """From the sums over the pieces in these windows."""
            ends = np.searchsorted(edges, np.round(windows, EDGE_DIGITS).ravel(), side="right")
            ends = np.minimum(ends, count)
            sign = np.tile([-1.0, 1.0], len(windows))
            there = np.outer(sign, sign).ravel() @ whole[ends[:, None], ends].reshape(-1, k * k)
            return law_gain(there.reshape(k, k), sign @ sums[ends], expected)[0]

        return gain

    def _begun(self, law: Point) -> tuple[Windows, float, float]:
        """The best of a few times at which the effect may have begun, what that gains, and what it
        gains always."""
        start, *edges = np.linspace(self.motion.time[0], self.motion.time[-1], STARTS + 2)[:-1]
        gain = self._in_pieces(law, [start, *edges])
        begun = [((float(edge), OPEN_END_S),) for edge in edges]
        gains = [gain(windows) for windows in begun]
        best = int(np.argmax(gains))
        return begun[best], gains[best], gain(((float(start), OPEN_END_S),))

    def _on_and_off(self, law: Point) -> list[Windows]:
        """Times at which a force of constant direction is there, from its value in short blocks:
        one that is there for a tenth of the record and more, and a knock."""
        time = self.motion.time
        columns = self.scan.columns(law)
        place = ((self.motion.row_time - time[0]) / BLOCK).astype(np.intp)
        gram, right = self.problem.projected_in_blocks(columns, place)
        if not gram.any():
            return []  # a tool centre point on the axis of the only joint: no force moves that
        ridge = 0.03 * np.trace(gram) / len(gram)
        force = np.linalg.solve(gram + ridge * np.eye(len(gram)), right).reshape(
            -1, columns.values.shape[2]
        )
        direction = np.linalg.svd(force, full_matrices=False)[2][0]
        size = force @ direction
        size = size * np.sign(size[np.argmax(np.abs(size))])
        found = []
        for full in (np.quantile(size, 0.9), size.max()):
            found.append(
                tuple(
                    (float(time[0] + BLOCK * a), float(time[0] + BLOCK * b))
                    for a, b in true_stretches(size > 0.5 * full)
                )
            )
        return [windows for windows in found if windows]

    def _sharpened(self, law: Point, windows: Windows) -> Windows:
        """Every edge moved to where the evidence is largest, coarse to fine; without the windows
        that are not worth their two edges."""
        width = 0.5 * self.motion.duration / STARTS if len(windows) == 1 else 0.5 * BLOCK
        while width > self.motion.step:
            windows = self._moved(law, windows, width)
            width /= 2**FINER
        return windows

    def _moved(self, law: Point, windows: Windows, width: float) -> Windows:
        """Every edge moved by at most twice a width [s], which is halved `FINER` - 1 times."""
        widths = [width / 2**k for k in range(FINER)]
        steps = widths[-1] * np.arange(1 - 2**FINER, 2**FINER)
        within_reach = [e + s for e in chain(*windows) if e < OPEN_END_S for s in steps]
        gain = self._in_pieces(law, within_reach)
        best = [list(w) for w in windows]
        highest = gain(windows)
        for width in widths:
            for i in range(len(best)):
                for side in (0, 1):
                    if best[i][side] >= OPEN_END_S:
                        continue
                    for move in (-width, width):
                        trial = [list(w) for w in best]
                        trial[i][side] += move
                        if _ordered(trial) and (there := gain(_frozen(trial))) > highest:
                            best = trial
                            highest = there
        return _worth_their_edges(_frozen(best), gain)


def _lasting(windows: Windows) -> float:
    """[s] in all."""
    return sum(stop - start for start, stop in windows)


def _worth_their_edges(windows: Windows, gain: Callable[[Windows], float]) -> Windows:
    """Those of some windows that gain more than their choice costs, one at least."""
    while len(windows) > 1:
        without = [gain(windows[:k] + windows[k + 1 :]) for k in range(len(windows))]
        worth = gain(windows) - np.array(without)
        kept = (worth > 2 * PER_EDGE) | (worth == worth.max())
        if kept.all():
            break
        windows = tuple(w for w, stays in zip(windows, kept, strict=True) if stays)
    return windows


def _ordered(windows: Sequence[Sequence[float]]) -> bool:
    flat = [edge for window in windows for edge in window]
    return all(a < b for a, b in pairwise(flat))


def _frozen(windows: Sequence[Sequence[float]]) -> Windows:
    return tuple((float(a), float(b)) for a, b in windows)
