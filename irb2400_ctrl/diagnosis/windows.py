"""Effects that act only part of the time: one that begins in the middle of a record, a force that comes and goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.diagnosis.bases import Columns
from irb2400_ctrl.diagnosis.evidence import Problem
from irb2400_ctrl.diagnosis.scan import Candidate, Scan

Array = npt.NDArray[np.float64]
Windows = tuple[tuple[float, float], ...]

FOREVER = 1e9
"""[s] end of a window that the record does not show"""
CLEARLY = 15.0
"""[nats] an effect that acts always is the simpler story"""
PER_EDGE = 5.0
"""[nats] for every further time of switching: about the log of the places where it could be"""
BLOCK = 0.5
"""[s] resolution of the first look at a force over time"""
STARTS = 16


def windowed(scan: Scan, problem: Problem, candidate: Candidate) -> Candidate | None:
    """The candidate acting only part of the time, if that explains the log clearly better."""
    if not candidate.known or len(candidate.effects) != 1 or candidate.effects[0].states:
        return None
    effect = candidate.effects[0]
    if effect.acts != "force" or effect.windows_s:
        return None
    always = problem.score(candidate.law)
    first, last = float(scan.motion.time[0]), float(scan.motion.time[-1])
    trials: list[Windows] = [((float(t), FOREVER),) for t in np.linspace(first, last, STARTS + 2)[1:-1]]
    gains = [_gain(scan, problem, candidate, windows) for windows in trials]
    best = trials[int(np.argmax(gains))]
    if effect.kind == "process_force":
        comes_and_goes = _on_and_off(scan, problem, candidate)
        if comes_and_goes and _gain(scan, problem, candidate, comes_and_goes) > max(gains):
            best = comes_and_goes
    if _gain(scan, problem, candidate, best) < always.gain + CLEARLY / 2:
        return None
    best = _sharpened(scan, problem, candidate, best)
    edges = sum(edge < FOREVER for window in best for edge in window)
    switching = CLEARLY + PER_EDGE * (edges - 1)
    penalty = switching + candidate.penalty
    if _gain(scan, problem, candidate, best) < always.gain + switching:
        return None
    law = _law(scan, candidate, best)
    fresh = problem.score(law, scales=scan.scales(candidate))
    fields = {**effect.model_dump(), "windows_s": best}
    moved = type(effect).model_validate(fields)
    return replace(
        candidate,
        name=f"{candidate.name}, part of the time",
        effects=(moved,),
        law=law,
        departures=None,
        score=replace(fresh, gain=fresh.gain - penalty),
        penalty=penalty,
    )


def _law(scan: Scan, candidate: Candidate, windows: Windows) -> Columns:
    effect = candidate.effects[0]
    nonlinear = {key: float(getattr(effect, key)) for key in type(effect).nonlinear_names(effect.joint)}
    return scan.bases.columns(effect.kind, effect.joint, scan.motion, [nonlinear], windows=windows)[0]


def _gain(scan: Scan, problem: Problem, candidate: Candidate, windows: Windows) -> float:
    return problem.score(_law(scan, candidate, windows)).gain


def _on_and_off(scan: Scan, problem: Problem, candidate: Candidate) -> Windows:
    """Times at which a force of constant direction is there, from its value in short blocks."""
    motion, effect = scan.motion, candidate.effects[0]
    whole = scan.bases.columns(effect.kind, effect.joint, motion, filtered=False)[0]
    place = ((motion.time - motion.time[0]) / BLOCK).astype(int)
    count, k = int(place.max()) + 1, whole.values.shape[2]
    blocks = [motion.filtered(whole.values * (place == i)[:, None, None]) for i in range(count)]
    gram, right = problem.projected(Columns(whole.joints, np.concatenate(blocks, axis=2)))
    ridge = 0.03 * np.trace(gram) / len(gram)
    force = np.linalg.solve(gram + ridge * np.eye(len(gram)), right).reshape(count, k)
    direction = np.linalg.svd(force, full_matrices=False)[2][0]
    size = force @ direction
    size = size * np.sign(size[np.argmax(np.abs(size))])
    on = size > 0.5 * np.quantile(size, 0.9)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(int)))
    start = motion.time[0]
    return tuple(
        (float(start + BLOCK * a), float(start + BLOCK * b)) for a, b in zip(edges[::2], edges[1::2], strict=True)
    )


def _sharpened(scan: Scan, problem: Problem, candidate: Candidate, windows: Windows) -> Windows:
    """Every edge moved to where the evidence is largest, coarse to fine."""
    best, gain = [list(w) for w in windows], _gain(scan, problem, candidate, windows)
    width = 0.5 * (scan.motion.time[-1] - scan.motion.time[0]) / STARTS if len(windows) == 1 else 0.5 * BLOCK
    for _ in range(3):
        for i in range(len(best)):
            for side in (0, 1):
                if best[i][side] >= FOREVER:
                    continue
                for move in (-width, width):
                    trial = [list(w) for w in best]
                    trial[i][side] += move
                    if not _ordered(trial):
                        continue
                    there = _gain(scan, problem, candidate, _frozen(trial))
                    if there > gain:
                        best, gain = trial, there
        width /= 2
    return _frozen(best)


def _ordered(windows: Sequence[Sequence[float]]) -> bool:
    flat = [edge for window in windows for edge in window]
    return all(a < b for a, b in pairwise(flat))


def _frozen(windows: Sequence[Sequence[float]]) -> Windows:
    return tuple((float(a), float(b)) for a, b in windows)
