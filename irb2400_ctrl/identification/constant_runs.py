"""Runs of one joint at constant speed, and the friction that they show (eqs. 70-73).

A joint that moves alone at constant speed asks for friction and gravity only (eq. 70). Past the
same angles in both directions gravity is the same, and half the difference of the torques is the
friction at that speed (eq. 73), half the sum is gravity with the offset of the torque channel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, true_stretches
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.instants.time_base import with_time_base
from irb2400_ctrl.measurement.uniform import UniformLog, resample

WINDOW = 0.2
"""[s] over which a speed is taken"""
SHORTEST = 0.4
"""[s] of a run"""
BEND = 0.1
"""change of the speed within a window, over the speed, up to which it is constant"""
UNSTEADY = 0.12
"""scatter of the speed over 40 ms, over the speed, from which a joint sticks and slips"""
JUMPY = 1.6
"""scatter of the torque from sample to sample, over that of the fast runs, up to which a run is
steady"""
GLIMPSE = 0.040
"""[s] over which that scatter is taken"""
REST = 0.02
"""[rad/s] speed of the other joints up to which they rest: drives hunt a little"""
SAME_SPEED = 0.1
"""relative difference of two runs of one speed"""
SAME_POSE = np.radians(0.5)
"""[rad] difference of the resting joints of two runs of one posture"""
BINS = 20
"""parts of the common angles, at most"""
A_BIN = 15
"""samples in each, at least"""
LEAST_BINS = 3


@dataclass(frozen=True)
class Run:
    """One stretch of one joint, from 1, at constant speed.

    Args:
        log: its name; time [s], angle [rad], torque [Nm] of the joint, shape (m,).
        speed: mean, with its sign [rad/s]; pose: mean angles of all joints [rad], (n,).
        steady: whether the speed is constant from moment to moment: no stick-slip.
    """

    joint: int
    log: str
    time: Array
    angle: Array
    torque: Array
    speed: float
    pose: Array
    steady: bool


@dataclass(frozen=True)
class FrictionPoint:
    """Friction of one joint at one speed (eq. 73), from a run in each direction.

    Args:
        speed: [rad/s], positive; torque: friction, and its standard error [Nm];
        level: half the sum: gravity and offset [Nm].
        forth, back: the runs.
    """

    speed: float
    torque: float
    error: float
    level: float
    forth: Run
    back: Run


def runs_of(log: Log) -> list[Run]:
    """Stretches of a log in which one joint moves at constant speed and the others rest."""
    motion = resample(with_time_base(log))
    width = max(3, round(WINDOW / motion.step))
    if len(motion.time) < 4 * width:
        return []
    # the middle of it: a drive that hunts for a while is no noise
    noise = np.median(np.abs(np.diff(motion.q, 2, axis=0)), axis=0) / (0.6745 * np.sqrt(6.0))
    speed = _speed(motion.q, width, motion.step)
    least = 5.0 * noise / WINDOW + 1e-6
    ahead = np.roll(speed, -(width // 2), axis=0)
    behind = np.roll(speed, width // 2, axis=0)
    found = []
    for j in range(log.n):
        own = np.abs(speed[:, j])
        others = np.delete(np.abs(speed), j, axis=1)
        even = np.abs(ahead[:, j] - behind[:, j]) < BEND * own
        runs = even & (own > least[j]) & (others < REST).all(axis=1) & motion.valid
        own_runs = _stretches(log.name, motion, j, runs & (speed[:, j] > 0), float(noise[j]))
        own_runs += _stretches(log.name, motion, j, runs & (speed[:, j] < 0), float(noise[j]))
        found += _judged(sorted(own_runs, key=lambda run: float(run.time[0])))
    return found


def _judged(runs: Sequence[Run]) -> list[Run]:
    """Runs of one joint in the order of time; those are not steady whose torque jumps from sample
    to sample more than on fast runs, or that a slip has cut in two."""
    if not runs:
        return []
    jumps = np.array([np.std(np.diff(run.torque, 2)) for run in runs])
    speed = np.array([run.speed for run in runs])
    calm = np.median(jumps[np.abs(speed) >= np.median(np.abs(speed))])
    same = np.abs(np.diff(speed)) < SAME_SPEED * np.abs(speed[:-1])
    cut = np.concatenate([[False], same]) | np.concatenate([same, [False]])
    steady = (jumps <= JUMPY * calm) & ~cut
    return [
        replace(run, steady=run.steady and bool(calmly))
        for run, calmly in zip(runs, steady, strict=True)
    ]


def _speed(q: Array, width: int, step: float) -> Array:
    """Slope of a straight line through each window, shape (m, n) [rad/s]."""
    place = np.arange(width) - 0.5 * (width - 1)
    weights = place[::-1] / (place**2).sum() / step
    return np.column_stack([np.convolve(column, weights, "same") for column in q.T])


def _stretches(name: str, motion: UniformLog, j: int, inside: Mask, noise: float) -> list[Run]:
    """The runs of a zero-based joint."""
    found = []
    for start, stop in true_stretches(inside):
        part = slice(start, stop)
        if (stop - start) * motion.step < SHORTEST:
            continue
        if np.ptp(np.delete(motion.q[part], j, axis=1), axis=0).max(initial=0.0) > SAME_POSE:
            continue
        time = motion.time[part]
        angle = motion.q[part, j]
        speed = float(np.polyfit(time - time[0], angle, 1)[0])
        found.append(
            Run(
                joint=j + 1,
                log=name,
                time=time,
                angle=angle,
                torque=motion.tau[part, j],
                speed=speed,
                pose=motion.q[part].mean(axis=0),
                steady=_unsteadiness(angle, motion.step, noise, speed) < UNSTEADY,
            )
        )
    return found


def _unsteadiness(angle: Array, step: float, noise: float, speed: float) -> float:
    """Scatter of the speed from moment to moment beyond noise, over the speed [-]."""
    k = max(1, round(GLIMPSE / step))
    seconds = k * step
    scatter = float(np.var((angle[k:] - angle[:-k]) / seconds))
    return math.sqrt(max(scatter - 2.0 * (noise / seconds) ** 2, 0.0)) / abs(speed)


def friction_points(runs: Sequence[Run]) -> list[FrictionPoint]:
    """Friction at the speeds of all steady runs that passed the same angles in both directions,
    in the same posture."""
    steady = [run for run in runs if run.steady]
    back = [run for run in steady if run.speed < 0]
    found = []
    for forth in (run for run in steady if run.speed > 0):
        pairs = [p for p in (_point(forth, other) for other in back) if p is not None]
        if not pairs:
            continue
        best = min(pairs, key=lambda p: p.error)
        found.append(best)
        back = [run for run in back if run is not best.back]
    return sorted(found, key=lambda p: (p.forth.joint, p.speed))


def _point(forth: Run, back: Run) -> FrictionPoint | None:
    """Eq. 73 of two runs; None where they are no pair."""
    if forth.joint != back.joint or abs(forth.speed + back.speed) > SAME_SPEED * forth.speed:
        return None
    others = np.delete(forth.pose - back.pose, forth.joint - 1)
    if np.abs(others).max(initial=0.0) > SAME_POSE:
        return None
    low = max(forth.angle.min(), back.angle.min())
    high = min(forth.angle.max(), back.angle.max())
    inside = [(run.angle >= low) & (run.angle <= high) for run in (forth, back)]
    bins = min(BINS, min(int(mask.sum()) for mask in inside) // A_BIN)
    if bins < LEAST_BINS:
        return None
    edges = np.linspace(low, high, bins + 1)[1:-1]
    means = [
        _means(np.digitize(run.angle[mask], edges), run.torque[mask], bins)
        for run, mask in zip((forth, back), inside, strict=True)
    ]
    half = 0.5 * (means[0] - means[1])
    half = half[np.isfinite(half)]
    if len(half) < LEAST_BINS:
        return None
    return FrictionPoint(
        speed=0.5 * (forth.speed - back.speed),
        torque=float(half.mean()),
        error=float(half.std(ddof=1) / np.sqrt(len(half))),
        level=float(np.nanmean(0.5 * (means[0] + means[1]))),
        forth=forth,
        back=back,
    )


def _means(place: Array, torque: Array, bins: int) -> Array:
    count = np.bincount(place, minlength=bins)
    total = np.bincount(place, torque, minlength=bins)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))
