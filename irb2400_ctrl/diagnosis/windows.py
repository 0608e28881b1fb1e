"""Effects that act only part of the time: one that begins in the middle of a record, a force that comes and goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.diagnosis.bases import Columns
from irb2400_ctrl.diagnosis.evidence import Problem, law_gain
from irb2400_ctrl.diagnosis.scan import Candidate, Scan
from irb2400_ctrl.effects.base import OPEN_END_S

Array = npt.NDArray[np.float64]
Windows = tuple[tuple[float, float], ...]

CLEARLY = 15.0
"""[nats] an effect that acts always is the simpler story"""
PER_EDGE = 5.0
"""[nats] for every further time of switching: about the log of the places where it could be"""
BLOCK = 0.5
"""[s] resolution of the first look at a force over time"""
STARTS = 16


def windowed(scan: Scan, problem: Problem, candidate: Candidate) -> Candidate | None:
    """The candidate acting only part of the time, if that explains the log clearly better."""
    if not candidate.known or len(candidate.effects) != 1 or candidate.effects[0].windows_s:
        return None
    effect = candidate.effects[0]
    always = problem.score(candidate.law, scales=scan.scales(candidate))
    best, gain = _begun(scan, problem, candidate)
    if effect.kind == "process_force":
        comes_and_goes = _on_and_off(scan, problem, candidate)
        if comes_and_goes and _gain(scan, problem, candidate, comes_and_goes) > gain:
            best, gain = comes_and_goes, _gain(scan, problem, candidate, comes_and_goes)
    if gain < always.gain + CLEARLY / 2:
        return None
    best = _sharpened(scan, problem, candidate, best)
    part = acting(scan, problem, candidate, best)
    return part if part.score.gain > always.gain - candidate.penalty else None


def acting(scan: Scan, problem: Problem, candidate: Candidate, windows: Windows) -> Candidate:
    """The candidate acting in these windows only; their choice is paid for."""
    effect = candidate.effects[0]
    edges = sum(edge < OPEN_END_S for window in windows for edge in window)
    penalty = candidate.penalty + CLEARLY + PER_EDGE * (edges - 1)
    law = _law(scan, candidate, windows)
    score = problem.score(law, scales=scan.scales(candidate))
    moved = type(effect).model_validate({**effect.model_dump(), "windows_s": windows})
    return replace(
        candidate,
        name=f"{candidate.name}, part of the time",
        effects=(moved,),
        law=law,
        departures=None,
        score=replace(score, gain=score.gain - penalty),
        penalty=penalty,
    )


def _law(scan: Scan, candidate: Candidate, windows: Windows) -> Columns:
    effect = candidate.effects[0]
    return scan.bases.columns(effect.kind, effect.joint, scan.motion, [effect.nonlinear], windows=windows)[0]


def _gain(scan: Scan, problem: Problem, candidate: Candidate, windows: Windows) -> float:
    return problem.score(_law(scan, candidate, windows), scales=scan.scales(candidate)).gain


def _begun(scan: Scan, problem: Problem, candidate: Candidate) -> tuple[Windows, float]:
    """The best of a few times at which the effect may have begun, and what that gains."""
    edges = np.linspace(scan.motion.time[0], scan.motion.time[-1], STARTS + 2)[1:-1]
    gram, right, k = _in_blocks(scan, problem, candidate, np.searchsorted(edges, scan.motion.time, side="right"))
    gains = []
    for start in range(1, STARTS + 1):
        # a sum of blocks is the effect from there on
        later = gram[start * k :, start * k :].reshape(STARTS + 1 - start, k, STARTS + 1 - start, k).sum(axis=(0, 2))
        gains.append(law_gain(later, right[start * k :].reshape(-1, k).sum(axis=0), scan.scales(candidate))[0])
    best = int(np.argmax(gains))
    return ((float(edges[best]), OPEN_END_S),), gains[best]


def _in_blocks(
    scan: Scan, problem: Problem, candidate: Candidate, place: npt.NDArray[np.intp]
) -> tuple[Array, Array, int]:
    """Gram matrix and right side of the k columns of a law, acting in one block of time after another."""
    effect, motion = candidate.effects[0], scan.motion
    (whole,) = scan.bases.columns(effect.kind, effect.joint, motion, [effect.nonlinear], filtered=False)
    blocks = [motion.filtered(whole.values * (place == i)[:, None, None]) for i in range(int(place.max()) + 1)]
    gram, right = problem.projected(Columns(whole.joints, np.concatenate(blocks, axis=2)))
    return gram, right, whole.values.shape[2]


def _on_and_off(scan: Scan, problem: Problem, candidate: Candidate) -> Windows:
    """Times at which a force of constant direction is there, from its value in short blocks."""
    motion = scan.motion
    gram, right, k = _in_blocks(scan, problem, candidate, ((motion.time - motion.time[0]) / BLOCK).astype(np.intp))
    ridge = 0.03 * np.trace(gram) / len(gram)
    force = np.linalg.solve(gram + ridge * np.eye(len(gram)), right).reshape(-1, k)
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
                if best[i][side] >= OPEN_END_S:
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
