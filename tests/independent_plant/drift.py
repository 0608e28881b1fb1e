"""An arm whose friction and load grow while it works."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .case import Case
from .log import Log


def drifting(
    case: Case, joint: int, grown: float, loaded: float = 0.0, quiet: float = 60.0
) -> tuple[Log, np.ndarray]:
    """The second motion of a case while friction of a joint and a mass at the tool grow evenly.

    Between the arm as it was and as it is in the end the record is interpolated: both follow the
    same reference, and torques are linear in what grows.

    Args:
        joint: 1-6.
        grown: by which its dry and viscous friction grow, over their values.
        loaded: mass that the spindle has more in the end [kg].
        quiet: from the beginning of the record until something grows [s].

    Returns:
        The log, and the true numbers before and after: Coulomb friction of each joint [Nm],
        viscous friction of each [Nm s/rad], added mass [kg], shape (2, 13).
    """
    before = case.machine
    friction = before.friction.copy()
    friction[joint - 1, :3] *= 1.0 + grown
    payload = np.array([loaded, *before.arm.bodies[6][1:4], *[0.0] * 6]) if loaded else None
    after = replace(before, friction=friction, arm=replace(before.arm, payload=payload))
    move = case.motions[1]
    time, start = before.closed_loop((), move)
    end = after.closed_loop((), move)[1]
    record = start + grown_part(time, quiet)[:, None] * (end - start)
    rng = np.random.default_rng([case.seed, joint])
    log = Log(*case.sensors.read(rng, time, record, move.q[-len(time) :]))
    tables = ((before, 0.0), (after, loaded))
    return log, np.array([np.append(of.friction[:, [1, 2]].T, mass) for of, mass in tables])


def grown_part(time: np.ndarray, quiet: float) -> np.ndarray:
    """How much of it has grown at the times of a record [s], 0 to 1."""
    begin = time[0] + quiet
    return np.asarray(np.clip((time - begin) / (time[-1] - begin), 0.0, 1.0))
