"""What torque columns show of themselves: nothing recorded, stuck at one value, cut off."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import digit, neighbour_noise
from irb2400_ctrl.plausibility.columns.factors import quotients
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.columns.runs import held, runs
from irb2400_ctrl.plausibility.problem import LogProblem, named

FINE = 0.5
"""digit over noise of a column in which a value does not stay by chance"""
CLIPPED = 0.005
"""share of samples exactly at one end of the range"""
STUCK_TIME = 0.5
"""[s] of one torque"""
FEW = 10
"""rows whose noise cannot be told"""
TRAVEL = 0.05
"""[rad] that the joint moves meanwhile"""
SILENT = 0.75
"""share of the rows in motion whose torque is zero, in a channel that is hardly recorded"""
STEPS = 5.0
"""digits of the torques that are not rare: zero is no rounding of a channel that has so many"""
RARE = 0.02
"""share of the largest torques, those of contacts, which say nothing of the others"""
CREEP = 0.05
"""of a joint's fastest speed, from which it moves"""


def torque_problem(log: Log) -> LogProblem | None:
    """Torques that are constant while others, or the joint, move."""
    flat = np.ptp(log.tau, axis=0) == 0.0
    if not log.tau.any():
        return LogProblem("zero_torque", "all torques are zero: nothing was recorded")
    moving = np.ptp(log.q, axis=0) > MOVES
    dead = [j + 1 for j in range(log.n) if flat[j] and moving[j]]
    if dead:
        return LogProblem(
            "constant_torque",
            f"the torque of {named(dead)} has one value all the time while it moves",
            joints=tuple(dead),
        )
    return _unrecorded(log, moving) or _stuck(log, moving)


def _unrecorded(log: Log, moving: Mask) -> LogProblem | None:
    """Torques that are exactly zero in most of the rows in which their joint moves.

    A dead band of a drive, or currents of a motor that nobody calibrated: what is left of them is
    no torque, and no robot fits it.
    """
    speed = np.abs(quotients(log)[0])
    moves = (speed > CREEP * speed.max(axis=0)) & moving
    zero = log.tau[: len(speed)] == 0.0
    share = np.sum(zero & moves, axis=0) / np.maximum(moves.sum(axis=0), 1)
    many = np.quantile(np.abs(log.tau), 1.0 - RARE, axis=0) > STEPS * digit(log.tau)
    found = [int(j) + 1 for j in np.flatnonzero((share > SILENT) & many)]
    if not found:
        return None
    percents = [round(100.0 * float(share[j - 1])) for j in found]
    several = len(found) > 1
    return LogProblem(
        "zero_torque",
        f"the torque of {named(found)} is zero in {', '.join(map(str, percents))} % of the rows in "
        f"which {'they move' if several else 'it moves'}: hardly any of it was recorded. Record "
        "it, or make the joint fixed in the URDF (then `irb2400 robot import` again) and leave its "
        "columns out",
        {"zero_percent": percents},
        tuple(found),
    )


def _stuck(log: Log, moving: Mask) -> LogProblem | None:
    """A torque that keeps one value for long while its joint moves."""
    least = max(20, round(STUCK_TIME * log.rate))
    fine = _fine(log.tau, _noise_beside_runs(log.tau, least))
    for j in np.flatnonzero(moving & fine):
        ends = (log.tau[:, j].max(), log.tau[:, j].min())
        for start, stop in runs(log.tau[:, j], least):
            # a value at the end of the range is a limit that was met (`clipped`), if not all along
            limit = log.tau[start, j] in ends and stop - start < len(log.tau) // 2
            if not limit and np.ptp(log.q[start:stop, j]) > TRAVEL:
                return held("constant_torque", "torque", log, start, stop, int(j))
    return None


def _noise_beside_runs(tau: Array, least: int) -> Array:
    """`neighbour_noise` of the rows outside of long runs of one value, shape (n,).

    Its median is zero once a channel is stuck for more than half of the record. A channel of a
    single run and hardly anything else is stuck whatever its noise: it is infinite. One of coarse
    steps has several runs.
    """
    found = neighbour_noise(tau)
    for j in range(tau.shape[1]):
        free = np.ones(len(tau), dtype=bool)
        stays = list(runs(tau[:, j], least))
        for start, stop in stays:
            free[start:stop] = False
        alone = len(stays) == 1 and free.sum() < FEW
        found[j] = np.inf if alone else neighbour_noise(tau[free, j : j + 1])[0]
    return found


def clipped(log: Log) -> LogProblem | None:
    """Torques cut off at one value."""
    found = []
    levels = []
    for j in np.flatnonzero(_fine(log.tau, neighbour_noise(log.tau))):
        tau = log.tau[:, j]
        for end in (tau.max(), tau.min()):
            level, counts = np.unique(tau, return_counts=True)
            place = 0 if end == tau.min() else len(level) - 1
            near = counts[1:6] if place == 0 else counts[-6:-1]
            here = counts[place]
            if len(near) and end and here > max(CLIPPED * len(tau), 10, 8 * near.max()):
                found.append(int(j) + 1)
                levels.append(float(f"{abs(end):.4g}"))
                break
    if not found:
        return None
    return LogProblem(
        "saturation",
        f"the torque of {named(found)} is cut off at "
        f"{', '.join(f'{v:g}' for v in levels)} Nm: what the arm needed above that is not recorded",
        {"level_Nm": levels},
        tuple(found),
    )


def _fine(tau: Array, noise: Array) -> Mask:
    """Columns whose digit is so much finer than their noise that equal neighbours are rare."""
    return np.asarray(digit(tau) < FINE * noise)
