"""Logs that are not of one arm with one load: fitted together, each leaves far more than alone.

Friction changes from log to log as an arm warms up, the zero of a torque channel where it is set
anew: where logs agree once each has such numbers of its own, that is said, and nothing of another
arm or load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.identification.fitting.baseline import (
    plain_least_squares,
    shortest_inverse,
)
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments, Recording

TWICE = 2.0
"""rms of a joint in a fit to several logs, over what it is in a fit to its log alone, beyond which
the logs disagree"""
AGREEING = 1.5
"""the same up to which the others agree once one is left out"""
ALIKE = "with one load, in one mounting"
"""what logs have to share"""
OF_THEIR_OWN = (
    (
        ("coulomb", "viscous"),
        "the friction of the logs is not the same",
        "with friction of its own for each log they agree. Was the arm as warm in all of them?",
    ),
    (
        ("offset",),
        "the zeros of the torques are not the same in all logs",
        "with offsets of its own for each log they agree. Was a channel set to zero anew?",
    ),
)
"""terms of the drives that may differ between logs of one arm; what is said where they do"""
CLEAR = 5.0
"""standard errors of the mass that one log has more at the last link than the others"""
WORSE = 1.1
"""what frictions or offsets of the logs' own leave at least over what a load of one log leaves"""
FEWEST = 100
"""samples of a joint that counts"""
LITTLE = 1e-3
"""of a joint's rms torque: what a simulation leaves is no disagreement"""


def odd_logs(found: Fit, parts: Sequence[Recording]) -> list[str]:
    """What the reader should know of logs that disagree, by plain least squares on their sums, with
    the columns of what the arm has.

    Alone, every other second of a log is left by a fit to the seconds between: a short log, which
    alone fits anything, so accuses nobody.
    """
    if len(parts) < 2:
        return []
    layout = found.layout
    sums = found.sums
    blocks = [np.unique(part.block) for part in parts]
    each = [_rms(sums, own, _alone(sums, own)) for own in blocks]
    every = range(len(parts))
    worst = _ratios(sums, blocks, each, every)
    loaded = _loaded(found, parts, sums, blocks, each)
    if not worst.max() > TWICE:
        return loaded
    place, joint = (int(k) for k in np.unravel_index(int(np.argmax(worst)), worst.shape))
    told = _told(parts, each, place, joint, float(worst[place, joint]))
    for terms, differ, agree in OF_THEIR_OWN:
        if not _ratios_with_own(sums, blocks, each, _own_columns(layout, terms)).max() > TWICE:
            return loaded or [f"{differ}: {told}; {agree} What is written lies between"]
    if len(parts) == 2:
        names = " and ".join(part.motion.name for part in parts)
        return [f"{names} disagree: {told}; are both of this arm, {ALIKE}?"]
    left = {k: _without(sums, blocks, each, k) for k in every}
    odd = min(left, key=lambda k: left[k])
    if left[odd] > AGREEING:
        return [f"the logs disagree: {told}; are all of this arm, {ALIKE}?"]
    return [
        f"{parts[odd].motion.name} does not belong to the other logs: {told}; without it the "
        "others agree. Of another arm, load or mounting? Identify it apart"
    ]


def _loaded(
    found: Fit,
    parts: Sequence[Recording],
    sums: Moments,
    blocks: Sequence[Integers],
    each: Sequence[Array],
) -> list[str]:
    """What is said of a log with another load than the rest; nothing where that is not clear, or
    where frictions or offsets of all logs' own leave hardly more.

    Args:
        found: the fit to all logs; parts: the logs.
        sums: with its columns.
        blocks: of each log.
        each: what is left of each alone, (n,).
    """
    p = sums.g.shape[-1]
    last = 10 * (found.layout.n - 1)
    told = []
    for log in range(len(blocks)):
        every = _with_own(sums, blocks, last + np.arange(4), [log])
        theta = plain_least_squares(every)
        data = every.summed()
        mean = data.squared_error(theta)[0] / np.maximum(data.count[0], 1.0)
        weight = 1.0 / (_counted(data.c[0], data.count[0], mean) ** 2 + 1e-18) / found.samples
        inverse = shortest_inverse(np.einsum("n,npq->pq", weight * (mean > 0.0), data.H[0]))
        error = float(np.sqrt(np.maximum(inverse[p, p], 1e-18)))
        left = float(_left_of(every, each, theta).max())
        told.append((abs(float(theta[p])) / error, log, float(theta[p]), error, left))
    clear, odd, mass, error, left = max(told)
    others = (_own_columns(found.layout, terms) for terms, _, _ in OF_THEIR_OWN)
    if clear < CLEAR or left > AGREEING:
        return []
    if any(_ratios_with_own(sums, blocks, each, own).max() <= WORSE * left for own in others):
        return []
    return [
        f"the load of the logs is not the same: {parts[odd].motion.name} has {mass:+.2g} ± "
        f"{1.96 * error:.1g} kg at the last link beside the others; identify it apart, or state "
        "its load. What is written lies between"
    ]


def _own_columns(layout: ColumnLayout, terms: Sequence[str]) -> Integers:
    """Columns of some terms of the drives."""
    return np.concatenate([np.arange(layout.count)[layout.drive(term)] for term in terms])


def _told(
    parts: Sequence[Recording], each: Sequence[Array], place: int, joint: int, ratio: float
) -> str:
    """The joint on which they disagree most."""
    alone = float(each[place][joint])
    return (
        f"joint {joint + 1} of {parts[place].motion.name} leaves {ratio * alone:.3g} Nm in a fit "
        f"to all of them, {alone:.3g} Nm in one to it alone"
    )


def _ratios(
    sums: Moments, blocks: Sequence[Integers], each: Sequence[Array], some: Sequence[int]
) -> Array:
    """What a fit to some logs leaves of each over what it leaves alone, (logs, n); zero of joints
    that do not count.

    Args:
        sums: of all logs; blocks: of each.
        each: what is left of each alone, (n,).
        some: the logs that are fitted together.
    """
    theta = plain_least_squares(sums.taken(np.concatenate([blocks[k] for k in some])))
    return np.array([_rms(sums, blocks[k], theta) / np.maximum(each[k], 1e-300) for k in some])


def _ratios_with_own(
    sums: Moments, blocks: Sequence[Integers], each: Sequence[Array], own: Integers
) -> Array:
    """`_ratios` of all logs, each with numbers of its own in some columns, (logs, n)."""
    every = _with_own(sums, blocks, own, range(len(blocks)))
    return _left_of(every, each, plain_least_squares(every))


def _left_of(every: Moments, each: Sequence[Array], theta: Array) -> Array:
    """What numbers leave of logs, of which each is one block, over what is left of it alone."""
    left = every.squared_error(theta) / np.maximum(every.count, 1.0)
    return np.array([_counted(*row) for row in zip(every.c, every.count, left, strict=True)]) / (
        np.maximum(each, 1e-300)
    )


def _with_own(
    sums: Moments, blocks: Sequence[Integers], own: Integers, of: Sequence[int]
) -> Moments:
    """The sums of logs, one block each, with what some logs have beside the common numbers.

    Args:
        sums: of all logs; blocks: of each.
        own: columns of which these have numbers of their own; of: those logs.
    """
    p = sums.g.shape[-1]
    found = []
    for log, some in enumerate(blocks):
        data = sums.taken(some).summed()
        # the log's own difference from the common numbers stands behind these
        spread = np.zeros((p, p + len(own) * len(of)))
        spread[:, :p] = np.eye(p)
        if log in of:
            spread[own, p + len(own) * list(of).index(log) + np.arange(len(own))] = 1.0
        found.append(replace(data, H=spread.T @ data.H @ spread, g=data.g @ spread))
    return Moments(
        *(
            np.concatenate([getattr(one, name) for one in found])
            for name in ("H", "g", "c", "count")
        )
    )


def _without(sums: Moments, blocks: Sequence[Integers], each: Sequence[Array], odd: int) -> float:
    """The worst ratio of the others."""
    others = [k for k in range(len(blocks)) if k != odd]
    return float(_ratios(sums, blocks, each, others).max())


def _alone(sums: Moments, own: Integers) -> tuple[Array, Array]:
    """Numbers of a fit to the even blocks of a log, and to the odd."""
    even, odd = (plain_least_squares(sums.taken(own[first::2])) for first in (0, 1))
    return even, odd


def _rms(sums: Moments, own: Integers, theta: Array | tuple[Array, Array]) -> Array:
    """Rms torque left of a log per joint, (n,) [Nm].

    Args:
        sums: of all logs; own: blocks of this one.
        theta: numbers, (p,); of two, each leaves the blocks that it has not seen.
    """
    data = sums.taken(own)
    if isinstance(theta, tuple):
        left = data.squared_error(theta[1])
        left[1::2] = data.squared_error(theta[0])[1::2]
    else:
        left = data.squared_error(theta)
    count = data.count.sum(axis=0)
    mean = left.sum(axis=0) / np.maximum(count, 1.0)
    return _counted(data.c.sum(axis=0), count, mean)


def _counted(squares: Array, count: Array, left: Array) -> Array:
    """Rms torque of a log that counts, of each joint, shape (n,) [Nm]."""
    floor = LITTLE * np.sqrt(squares / np.maximum(count, 1.0))
    return np.where(count >= FEWEST, np.maximum(np.sqrt(left), floor), 0.0)
