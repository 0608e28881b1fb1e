"""Rows that are missing, or there twice, though the clock is even: a time that was counted (row
times period) passes over both.

Where a row is missing all joints that move take two of their steps at once (k + 1 of k rows),
where one is written again none. What a step should be is what a cubic says of its two neighbours on
each side, whether samples were even or when they are stamped: where scattered stamps are right, a
long step beside short ones is no missing row. Only steps well above the digits and the noise of the
angles are asked, and only where two joints at least move.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.measurement.log import Log

DIGITS = 12.0
"""digits of its angle that a joint must go in a step, and"""
NOISE = 10.0
"""times what its steps usually are off, to say anything"""
CALM = 0.25
"""quantile of the latter: nearly half of the steps may stand beside a row that is missing"""
OF_NORMAL = 0.319
"""that quantile of the size of a normal variable of one"""
CLOSE = 0.2
"""of a step, by which each joint's may be off a whole number of them"""
EVEN = 0.25
"""of a period, by which the clock may step otherwise"""
AGREE = 0.5
"""of a step, by which the two steps beside it may differ"""
BY_CLOCK = 1.5
"""of a step, that are taken at once where the stamps count"""
FEWEST = 50
"""steps that can be asked"""
LEAST = 6
"""samples that make a step and its neighbours"""
SEVERAL = 4
"""places from which on the recorder is to be asked, and"""
SHARE = 0.002
"""of the steps that can be asked; fewer are set right"""


@dataclass(frozen=True)
class LostRows:
    """Where rows are missing or there twice.

    Args:
        missing: rows behind which some are missing.
        at_once: steps that are taken there.
        twice: rows that are there again in the next.
        asked: number of steps that could be asked.
    """

    missing: Integers
    at_once: Integers
    twice: Integers
    asked: int

    @property
    def few(self) -> bool:
        """Whether so few are missing, or there twice, that each can be set right."""
        places = max(len(self.missing), len(self.twice))
        return places < max(SEVERAL, SHARE * self.asked)


def lost_rows(log: Log) -> LostRows | None:
    """Rows of a log that its clock does not know to be missing or doubled; None where too few of
    its steps tell."""
    if len(log.time) < LEAST:
        return None
    steps = np.diff(log.q, axis=0)
    passed = np.diff(log.time)
    even = _even(passed)
    here = steps[2:-2]
    expected = _between(steps)
    size = np.abs(expected)
    told = size > _least(log.q, np.abs(here - expected))
    told &= np.abs(steps[1:-3] - steps[3:-1]) < AGREE * size
    # an arm that comes to rest stays there: it moves before and behind
    told &= (steps[1:-3] * expected > 0.0) & (steps[3:-1] * expected > 0.0)
    asked = even & (told.sum(axis=1) > 1)
    if asked.sum() < FEWEST:
        return None
    ratio = np.where(told, here / np.where(told, expected, 1.0), np.nan)[asked]
    whole = np.round(np.nanmedian(ratio, axis=1))
    together = np.nanmax(np.abs(ratio - whole[:, None]), axis=1) < CLOSE
    place = np.flatnonzero(asked) + 2
    missing = together & (whole > 1.0)
    missing &= _at_once(steps, passed, told)[asked] > BY_CLOCK
    # one that is written again is so to the last digit; a motion of few samples may nearly stop
    again = ((here == 0.0) | ~told)[asked].all(axis=1)
    return LostRows(
        missing=place[missing],
        at_once=whole[missing].astype(np.int64),
        twice=place[again],
        asked=len(place),
    )


def with_rows_counted(log: Log) -> tuple[Log, str]:
    """A log whose clock knows of a row that is missing or there twice, and what to say of that; the
    log itself and nothing where there is none, or where they are not few.

    All joints that move take two of their steps at once there, or none: no arm does.
    """
    found = lost_rows(log)
    if found is None or not found.few or not len(found.missing) + len(found.twice):
        return log, ""
    period = float(np.median(np.diff(log.time)))
    late = np.zeros(len(log.time))
    for place, steps in zip(found.missing, found.at_once, strict=True):
        late[place + 1 :] += (steps - 1) * period
    for place in found.twice:
        late[place + 1 :] -= period
    said = []
    for places, what in ((found.missing, "are missing"), (found.twice, "are there twice")):
        if len(places):
            at = ", ".join(f"{log.time[place]:.2f}" for place in places[:SEVERAL])
            more = f" and {len(places) - SEVERAL} times more" * (len(places) > SEVERAL)
            said.append(
                f"rows {what} at {at} s{more}: the clock passes over them, as all joints that move "
                "tell; set right"
            )
    kept = np.delete(np.arange(len(late)), found.twice + 1)
    counted = replace(
        log,
        time=(log.time + late)[kept],
        q=log.q[kept],
        tau=log.tau[kept],
        qd=None if log.qd is None else log.qd[kept],
        q_ref=None if log.q_ref is None else log.q_ref[kept],
        extra={name: np.asarray(column)[kept] for name, column in log.extra.items()},
    )
    return counted, "; ".join(said)


def _between(steps: Array) -> Array:
    """What a cubic says of a step by its two neighbours on each side, (m - 5, n)."""
    return np.asarray((4.0 * (steps[1:-3] + steps[3:-1]) - steps[:-4] - steps[4:]) / 6.0)


def _at_once(steps: Array, passed: Array, told: Mask) -> Array:
    """Steps that the joints take at once if samples were taken when they are stamped, (m - 5,).

    Args:
        steps: of the angles, shape (m - 1, n) [rad].
        passed: by the clock meanwhile, shape (m - 1,) [s].
        told: steps that tell, shape (m - 5, n).
    """
    speed = steps / np.where(passed > 0.0, passed, np.inf)[:, None]
    expected = _between(speed)
    told = told & (expected != 0.0)
    ratio = np.where(told, speed[2:-2] / np.where(told, expected, 1.0), np.nan)
    found = np.zeros(len(told))
    some = told.any(axis=1)
    found[some] = np.nanmedian(ratio[some], axis=1)
    return found


def _even(passed: Array) -> Mask:
    """Steps that the clock, as its two neighbours on each side, passes evenly, (m - 5,)."""
    even = np.abs(passed / np.median(passed) - 1.0) < EVEN
    return np.asarray(even[:-4] & even[1:-3] & even[2:-2] & even[3:-1] & even[4:])


def _least(q: Array, off: Array) -> Array:
    """Steps of each joint that tell [rad], shape (n,).

    Args:
        q: shape (m, n) [rad].
        off: by which steps are not what their neighbours say, shape (m - 5, n) [rad].
    """
    change = np.abs(np.diff(q, axis=0))
    digit = np.min(np.where(change > 0.0, change, np.inf), axis=0)
    noise = np.quantile(off, CALM, axis=0) / OF_NORMAL
    return np.asarray(np.maximum(DIGITS * digit, NOISE * noise))
