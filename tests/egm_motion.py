"""The motion and the follower that the tests of EGM share."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.planners.programs.egm import egm_messages as proto
from irb2400_ctrl.planners.programs.egm.egm_stream import (
    EgmFollower,
    EgmOptions,
)

Array = npt.NDArray[np.float64]
CYCLE = 0.004
START = np.radians([5.0, -10.0, 15.0, 30.0, 40.0, -60.0])
SWEEP = np.radians([30.0, 20.0, -15.0, 60.0, -25.0, 90.0])
AXIS_1 = np.radians([5.0, 0, 0, 0, 0, 0])
ROBOT = irb.load_robot("irb2400")


def planned(t: Array, duration: float = 1.0) -> tuple[Array, Array]:
    """Rest to rest along a quintic: q and qd at times t, held outside [0, duration]."""
    u = np.clip(np.asarray(t) / duration, 0.0, 1.0)[..., None]
    ease = u**3 * (10 - 15 * u + 6 * u**2)
    rate = 30 * u**2 * (1 - u) ** 2 / duration
    return START + ease * SWEEP, rate * SWEEP


def follower(options: EgmOptions | None = None, rate: float = 250.0) -> EgmFollower:
    time = np.linspace(0.0, 1.0, int(rate) + 1)
    return EgmFollower(ROBOT, time, *planned(time), options)


def message(
    sequence: int, q: Array, state: int = proto.MCI_RUNNING, time_ms: int | None = None
) -> proto.RobotMessage:
    clock = 4 * sequence if time_ms is None else time_ms
    return proto.RobotMessage(sequence, clock, tuple(np.degrees(q)), (), proto.MOTORS_ON, state)
