"""Angles and torques that jump as nothing moves: one huge cell, a whole turn, rows that are
missing."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.held_samples import thawed
from irb2400_ctrl.plausibility.problem import LogProblem, named

MOVES = 0.02
"""[rad] a joint that goes so far is not at rest"""
SPIKE = 30.0
"""a torque over the largest of all others"""
JUMP = 20.0
"""a single step of an angle over the largest of all others"""
LEAP = 5.0
"""speed of one step over the fastest of the record, and over that of its neighbours"""
TURN = 2.0 * np.pi


def spikes(log: Log) -> LogProblem | None:
    """One huge cell."""
    for j in range(log.n):
        for name, size, bar in (
            ("tau", np.abs(log.tau[:, j]), SPIKE),
            ("q", _peak(log.q[:, j]), JUMP),
        ):
            place = int(np.argmax(size))
            others = np.delete(size, slice(max(0, place - 2), place + 3))
            least = 0.5 if name == "q" else 1.0
            if len(others) and size[place] > max(bar * others.max(), least):
                value = log.tau[place, j] if name == "tau" else log.q[place, j]
                return LogProblem(
                    "spike",
                    f"{name}{j + 1} is {value:.3g} at {log.time[place]:.3f} s (sample "
                    f"{place + 1}), nothing else in the column comes near: delete that row",
                    {"sample": place + 1},
                    (j + 1,),
                    unusable=True,
                )
    return None


def wrapped(log: Log) -> LogProblem | None:
    """A whole turn between two samples."""
    found = []
    for j in range(log.n):
        steps = np.abs(np.diff(log.q[:, j]))
        turns = np.abs(steps - TURN) < 0.05 * TURN
        if turns.any() and steps[~turns].max(initial=0.0) < 1.0:
            found.append(j + 1)
    if not found:
        return None
    return LogProblem(
        "angle_wrapped",
        f"the angle of {named(found)} jumps by a whole turn: unwrap it, or state "
        "wrapped = true in a column map",
        {"period_deg": 360.0},
        tuple(found),
    )


def cut(log: Log) -> LogProblem | None:
    """A step that is no motion: rows are missing and their time with them, or an encoder caught
    up."""
    log = thawed(log)[0]  # frames that freeze are left out, and with them the way back
    steps = np.abs(np.diff(log.q, axis=0))
    passed = np.diff(log.time)
    # a packet that came late leaves its step hardly any time
    speed = steps / np.maximum(passed, np.median(passed))[:, None]
    beside = np.maximum(np.roll(speed, 1, axis=0), np.roll(speed, -1, axis=0))
    # of those in which a joint moves at all: it may rest most of the time, or be read seldom
    moving = [own[own > 0.0] for own in speed.T]
    usual = np.maximum([np.quantile(own, 0.99) if len(own) else 0.0 for own in moving], beside)
    jumps = (speed > LEAP * usual) & (steps > MOVES)
    if not jumps.any():
        return None
    k, j = (int(v) for v in np.unravel_index(np.argmax(np.where(jumps, steps, 0.0)), steps.shape))
    found = [int(joint) + 1 for joint in np.flatnonzero(jumps[k])]
    return LogProblem(
        "angle_jump",
        f"the angles jump at {log.time[k]:.2f} s: joint {j + 1} goes {np.degrees(steps[k, j]):.2g} "
        f"deg in {1e3 * (log.time[k + 1] - log.time[k]):.3g} ms. Rows are missing there and their "
        "time with them, or an encoder slipped: split the log there",
        {"time_s": float(log.time[k])},
        tuple(found),
    )


def bend_of(values: Array) -> Array:
    """Distance from the middle of the neighbours, zero at the ends, shape (m,)."""
    found = np.zeros_like(values)
    found[1:-1] = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    return found


def _peak(values: Array) -> Array:
    """The same where the neighbours agree with each other: one sample alone, not a step."""
    peak = bend_of(values)
    peak[1:-1] = np.maximum(peak[1:-1] - np.abs(values[2:] - values[:-2]), 0.0)
    return peak
