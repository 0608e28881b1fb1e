"""Angles and torques that jump as nothing moves: huge cells, values that stand for none, angles
that leave for a sample, a whole turn, rows that are missing or there twice."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.held_samples import released, thawed
from irb2400_ctrl.measurement.motion.lost_rows import lost_rows
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.plausibility.rows import SHORTEST

MOVES = 0.02
"""[rad] a joint that goes so far is not at rest"""
SPIKE = 30.0
"""a torque over the largest of all others"""
FILL = 5.0
"""one that is there again to the last digit, alike: no limit is so far from the rest"""
KINDS = 10
"""values at least that a channel has besides: one of few steps repeats them"""
SHARE = 0.05
"""of the rows at most that such values are"""
BRIEF = 3
"""samples at most for which an angle leaves and comes back"""
AT_ONCE = 3.0
"""[rad/s] at which it goes there at least, and"""
RARE = 0.01
"""share of the rows in which it does so at most"""
LEAP = 5.0
"""speed of one step over the fastest of the record, and over that of its neighbours"""
TURN = 2.0 * np.pi


def spikes(log: Log) -> LogProblem | None:
    """Cells that are no samples: huge torques, a value that stands for none, an angle that leaves
    for a sample or a few and comes back faster than any joint moves."""
    blank = _blank(log)
    if len(blank):
        first = int(blank[0])
        return LogProblem(
            "spike",
            f"angles and torques of all joints are zero in {len(blank)} rows, the first at "
            f"{log.time[first]:.3f} s (sample {first + 1}), and elsewhere beside them: nothing was "
            "recorded there; delete these rows",
            {"sample": first + 1, "rows": len(blank)},
            unusable=True,
        )
    fastest = _fastest(log)
    for j in range(log.n):
        far = _far(log.tau[:, j])
        if len(far):
            return _spike(log, j, far)
        left = _excursions(log, j, fastest)
        if len(left):
            return _left(log, j, left)
    return None


def _blank(log: Log) -> Integers:
    """Rows of zeros in every column, with an arm beside them that is not at zero."""
    zero = ~(log.q.any(axis=1) | log.tau.any(axis=1))
    edges = np.diff(zero.astype(np.int8)) != 0
    stands = np.abs(np.diff(log.q, axis=0)).max(axis=1) < MOVES
    return (
        np.flatnonzero(zero) if edges.any() and not stands[edges].any() else np.empty(0, np.int64)
    )


def _far(values: Array) -> Integers:
    """Rows of values beyond `SPIKE` times all others; of one value beyond `FILL` times them."""
    size = np.abs(values)
    order = np.sort(size)
    first = int(np.ceil((1.0 - SHARE) * len(order)))
    for factor in (SPIKE, FILL):
        below = order[first - 1 : -1]
        gap = np.flatnonzero(order[first:] > np.maximum(factor * below, 1.0))
        if not len(gap):
            continue
        found = np.flatnonzero(size >= order[first + gap[0]])
        others = np.delete(values, found)
        alone = len(found) == 1 and factor == SPIKE
        same = len(found) > 1 and np.ptp(values[found]) == 0.0
        if alone or (same and len(np.unique(others)) >= KINDS):
            return found
    return np.empty(0, dtype=np.int64)


def _spike(log: Log, j: int, rows: Integers) -> LogProblem:
    """Torques of joint j (from 0) in these rows that are none."""
    first = int(rows[0])
    what = f"tau{j + 1} is {log.tau[first, j]:.4g} "
    when = f"{log.time[first]:.3f} s (sample {first + 1})"
    says = f"at {when}, nothing else in the column comes near: delete that row"
    if len(rows) > 1:
        says = (
            f"in {len(rows)} rows, the first at {when}, nothing else in the column comes near: a "
            "value that stands for a missing sample; delete these rows"
        )
    fits = {"sample": first + 1, "rows": len(rows), "value": float(log.tau[first, j])}
    return LogProblem("spike", what + says, fits, (j + 1,), unusable=True)


def _left(log: Log, j: int, rows: Integers) -> LogProblem:
    """Angles of joint j (from 0) in these rows that are none."""
    first = int(rows[0])
    off = np.degrees(log.q[first, j] - log.q[first - 1, j])
    others = f", as in {len(rows) - 1} other rows" if len(rows) > 1 else ""
    return LogProblem(
        "spike",
        f"q{j + 1} is {np.degrees(log.q[first, j]):.4g} deg at {log.time[first]:.3f} s (sample "
        f"{first + 1}), {abs(off):.2g} deg from the samples beside it{others}, and no joint goes "
        f"there and back so fast: delete {'these rows' if others else 'that row'}",
        {"sample": first + 1, "rows": len(rows)},
        (j + 1,),
        unusable=True,
    )


def _excursions(log: Log, j: int, fastest: float) -> Integers:
    """Rows in which the angle of joint j (from 0) is away from where it was and will be.

    Args:
        log: the record; j: of the joint.
        fastest: of all joints in nearly all rows [rad/s].
    """
    q = log.q[:, j]
    period = float(np.median(np.diff(log.time)))
    least = max(AT_ONCE, fastest)
    away: Mask = np.zeros(len(q), dtype=bool)
    how_far = np.full(len(q), np.inf)
    for width in range(1, BRIEF + 1):
        back = np.abs(q[width + 1 :] - q[: -width - 1])
        middle = 0.5 * (q[width + 1 :] + q[: -width - 1])
        off = np.array([q[k : len(q) - width - 1 + k] - middle for k in range(1, width + 1)])
        size = np.abs(off).min(axis=0) - back
        size[np.abs(off.sum(axis=0)) < np.abs(off).sum(axis=0)] = 0.0  # there on both sides
        size[np.abs(np.abs(off).max(axis=0) - TURN) < 0.05 * TURN] = 0.0
        # a sample between two gaps may be anywhere
        size[log.time[width + 1 :] - log.time[: -width - 1] > 2.0 * (width + 1) * period] = 0.0
        for start in np.flatnonzero(size > np.maximum(MOVES, least * period)):
            rows = slice(start + 1, start + 1 + width)
            away[rows] = True
            how_far[rows] = np.minimum(how_far[rows], size[start])
    found = np.flatnonzero(away)
    if not len(found) or len(found) > max(1.0, RARE * len(q)):
        return np.empty(0, dtype=np.int64)
    beside = np.diff(np.delete(q, found)) / np.diff(np.delete(log.time, found))
    return np.asarray(found[how_far[found] > LEAP * np.abs(beside).max() * period])


def _fastest(log: Log) -> float:
    """Speed that hardly any step of any joint exceeds [rad/s]."""
    speed = np.abs(np.diff(log.q, axis=0)) / np.diff(log.time)[:, None]
    return float(np.quantile(speed, 1.0 - RARE, axis=0).max())


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


def uncounted(log: Log) -> LogProblem | None:
    """Rows that are missing, or there twice, under a clock that goes on evenly."""
    new = released(log)[0]
    found = lost_rows(new)
    if found is None or found.few:
        return None
    missing = len(found.missing) >= len(found.twice)
    places = found.missing if missing else found.twice
    # of a host that polls a recorded speed tells what the angles do not
    if log.qd is not None and log.duration > SHORTEST and prepare(log).by_speed:
        return None
    share = 100.0 * len(places) / found.asked
    first = float(new.time[places[0]])
    if missing:
        says = (
            f"rows are missing and the clock passes over them: at {len(places)} places "
            f"({share:.2g} % of those asked), the first at {first:.2f} s, all joints go two steps "
            "or more at once. Write the controller's own time, or a count of its samples, beside "
            "the angles; a time made of the number of the row is none"
        )
    else:
        says = (
            f"rows are there twice and the clock goes on: {len(places)} ({share:.2g} % of "
            f"those asked), the first at {first:.2f} s, repeat the angles of the row before while "
            "all joints move. Leave them out before a time is made of the number of the row, or "
            "write the controller's own time, or its speeds, beside the angles"
        )
    fits = {"places": len(places), "from_s": first}
    return LogProblem("rows_missing" if missing else "rows_twice", says, fits)


def bend_of(values: Array) -> Array:
    """Distance from the middle of the neighbours, zero at the ends, shape (m,)."""
    found = np.zeros_like(values)
    found[1:-1] = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    return found
