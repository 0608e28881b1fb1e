"""Channels that hold their last value between samples: torques of a slow source beside faster
angles, topics joined row by row, every sample written several times.

What is held comes late, by half of the time for which it is held in the mean, and no model knows
that: the rows are used in which it is new. Where angles and torques are new in different rows, the
angles are interpolated between their own, being the smoother of the two. Where all torques stand
still only now and then, rows are left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from irb2400_ctrl.arrays import Array, Integers, Mask, true_stretches
from irb2400_ctrl.measurement.log import Log

HELD = 0.3
"""share of the rows that repeat the row before, from which a channel is held"""
BY_CHANCE = 0.2
"""of that share at most may come of single columns that happen not to change"""
DIGITS = 3.0
"""digits by which a channel of coarse steps changes where it does, at most: it keeps its value all
the same"""
REST = 0.2
"""[s] for which a value is kept by an arm at rest"""
SLOWEST = 20.0
"""[Hz] of new samples, below which the torque of a moving arm is not resolved"""
FEWEST = 20
"""new samples"""
FROZEN = 3
"""rows one after another that repeat all torques to the last digit: no noise does that"""
BRIEF = 0.01
"""[s] below which they are those of a host that polls, and late by next to nothing"""
SEVERAL = 4
"""places at which angles that repeat tell by the step behind what they are"""
STEADY = 0.75
"""of the speed before, with which the arm comes to what is new: it moved on while the angles were
repeated; where a row is written twice it has half that speed"""
LASTS = 0.5
"""[s] above which it is the torque itself that stays the same"""
MOVING = 0.02
JITTER = 6.0
"""how far some joint has come meanwhile, at least: at that speed [rad/s], and in medians of the
second differences of its angle, which are those of its noise"""
NOISY = 0.5
"""second over first differences of a torque, from which its noise lets no row repeat another; of a
smooth one, as at constant speed in a simulation, they are a few per cent"""


def new_rows(values: Array, time: Array) -> Mask | None:
    """Rows in which a channel has a new value; None where it is not held.

    Args:
        values: of all joints, shape (m, n).
        time: shape (m,) [s].
    """
    change = np.abs(np.diff(values, axis=0))
    new = np.concatenate([[False], (change > 0.0).any(axis=1)])
    places = np.flatnonzero(new)
    if len(places) < FEWEST:
        return None
    rests = np.diff(time[places]) > REST
    rows = np.diff(places)[~rests]
    if len(rows) < FEWEST or 1.0 - len(rows) / rows.sum() < HELD:
        return None
    there = change[places - 1]
    digit = np.min(np.where(change > 0.0, change, np.inf), axis=0)
    if np.median((there / digit).max(axis=1)) <= DIGITS:
        return None
    if np.prod(np.mean(there == 0.0, axis=0)) > BY_CHANCE * HELD:
        return None
    # an arm at rest is seen as often as in motion
    usual = int(np.median(rows))
    for start, stop in zip(places[:-1][rests], places[1:][rests], strict=True):
        new[start:stop:usual] = True
    return new


def released(log: Log) -> tuple[Log, str]:
    """A log's rows in which its torques are new (its angles where only these are held), or without
    those of frames that froze, and what to say of that; the log itself and nothing where no channel
    is held, or what is new is too little."""
    torques = new_rows(log.tau, log.time)
    angles = new_rows(log.q, log.time)
    rows = angles if torques is None else torques
    if rows is None:
        fresh, said = without_repeated(log)
        fresh, more = thawed(fresh)
        return fresh, "; ".join(filter(None, [said, more]))
    kept = np.flatnonzero(rows)
    if angles is not None:
        ends = np.flatnonzero(angles)[[0, -1]]
        kept = kept[(kept >= ends[0]) & (kept <= ends[1])]
    if len(kept) < FEWEST or len(kept) < SLOWEST * log.duration:
        return log, ""
    fresh = _rows(log, kept)
    parts = [
        f"{name} are new in {100.0 * np.mean(new):.0f} % of the rows only"
        for name, new in (("torques", torques), ("angles", angles))
        if new is not None
    ]
    what = "torques" if torques is not None else "angles"
    mean = (len(kept) - 1) / fresh.duration
    return fresh, (
        f"{', '.join(parts)}, and held in the others: the rows with new {what} are used, "
        f"{mean:.4g} a second"
    )


def without_repeated(log: Log) -> tuple[Log, str]:
    """A log without the rows that repeat all angles of the row before under a time of their own, as
    where a state is published again before a new one has come, and what to say of that.

    The step behind them says so: it is also that of the rows that repeat. Behind a row that is
    written twice it is one of its own, and the time is wrong.
    """
    if len(log.time) < FEWEST:
        return log, ""
    steps = np.abs(np.diff(log.q, axis=0))
    last, stops = true_stretches((steps == 0.0).all(axis=1)).T
    behind = stops + 1  # the next row that is new: those between repeat the last
    inside = (last > 0) & (behind < len(log.time))
    last = last[inside]
    behind = behind[inside]
    digit = np.min(np.where(steps > 0.0, steps, np.inf), axis=0)
    before = steps[last - 1]
    then = steps[behind - 1]
    told = (before > DIGITS * digit) & (then > DIGITS * digit)
    moves = told.any(axis=1) & (log.time[behind] - log.time[last] <= REST)
    if moves.sum() < SEVERAL:
        return log, ""
    usual = np.where(told, before, 0.0).sum(axis=1) / (log.time[last] - log.time[last - 1])
    speed = np.where(told, then, 0.0).sum(axis=1) / (log.time[behind] - log.time[last])
    if np.median(speed[moves] / usual[moves]) < STEADY:
        return log, ""
    stale = np.zeros(len(log.time), dtype=bool)
    for start, stop in zip(last[moves], behind[moves], strict=True):
        stale[start + 1 : stop] = True
    return _rows(log, np.flatnonzero(~stale)), (
        f"{stale.sum()} rows, {100.0 * stale.mean():.2g} % of all, repeat the angles of the row "
        "before though the arm moves on meanwhile: they are left out"
    )


def thawed(log: Log) -> tuple[Log, str]:
    """A log without the rows in which all torques stand still now and then while the arm moves, as
    where a driver repeats its last frame, and what to say of that."""
    if len(log.time) < FEWEST:
        return log, ""
    unchanged = np.diff(log.tau, axis=0) == 0.0
    # the last rows that are new, and the last that repeat them
    starts, stops = true_stretches(unchanged.all(axis=1)).T
    passed = log.time[stops] - log.time[starts]
    moved = np.abs(log.q[np.minimum(stops + 1, len(log.q) - 1)] - log.q[starts])
    least = np.maximum(
        MOVING * passed[:, None], JITTER * np.median(np.abs(np.diff(log.q, 2, axis=0)), axis=0)
    )
    lasting = (stops - starts >= FROZEN) & (passed >= BRIEF) & (passed <= LASTS)
    frozen = lasting & (moved > least).any(axis=1)
    stale = np.zeros(len(log.tau), dtype=bool)
    for start, stop in zip(starts[frozen], stops[frozen], strict=True):
        stale[start + 1 : stop + 1] = True
    kept = ~stale
    share = stale.mean()
    if not frozen.any() or kept.sum() < FEWEST:
        return log, ""
    first, second = (np.median(np.abs(np.diff(log.tau[kept], k, axis=0)), axis=0) for k in (1, 2))
    by_chance = np.prod(unchanged[kept[1:]].mean(axis=0)) > BY_CHANCE * share
    if by_chance or not (second > NOISY * first).any():
        return log, ""
    return _rows(log, np.flatnonzero(kept)), (
        f"all torques stand still {frozen.sum()} times while the arm moves, for "
        f"{1e3 * passed[frozen].mean():.0f} ms in the mean: these rows, {100.0 * share:.2g} % of "
        "all, are left out"
    )


def _rows(log: Log, kept: Integers) -> Log:
    """Some rows of a log, in which its torques are new."""
    return replace(
        log,
        time=log.time[kept],
        q=_at(kept, log.q, log.time),
        tau=log.tau[kept],
        qd=None if log.qd is None else _at(kept, log.qd, log.time),
        q_ref=None if log.q_ref is None else _at(kept, log.q_ref, log.time),
        extra={name: np.asarray(column)[kept] for name, column in log.extra.items()},
    )


def _at(kept: Integers, values: Array, time: Array) -> Array:
    """A smooth channel in some rows, between its own new values where it is held.

    Args:
        kept: the rows; values: of the channel, shape (m, n).
        time: of all rows [s], shape (m,).
    """
    new = new_rows(values, time)
    if new is None:
        return np.asarray(values[kept])
    return np.asarray(CubicSpline(time[new], values[new])(time[kept]))
