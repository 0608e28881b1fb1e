"""Effects in the measuring chain."""

from __future__ import annotations

import numpy as np

from .effect import Draw, Effect
from .sensors import Gain, Offset, PositionDelay, TorqueDelay, Zero


def torque_gain(d: Draw) -> Effect:
    """tau (1 + s), 5-15 %."""
    joint = d.joint()
    sign = d.sign()
    return Effect(
        d.kind,
        joint,
        lambda size, log: [Gain(joint - 1, sign * size)],
        lambda size: {"relative_gain_error": sign * size},
        0.05,
        0.15,
        d.log_uniform(0.05, 0.15),
        kept=True,
    )


def torque_offset(d: Draw) -> Effect:
    """tau + s [Nm]."""
    joint = d.joint()
    sign = d.sign()
    return Effect(
        d.kind,
        joint,
        lambda size, log: [Offset(joint - 1, sign * size)],
        lambda size: {"offset_Nm": sign * size},
        0.01,
        200,
    )


def time_delay(d: Draw) -> Effect:
    """tau(t - s) or q(t - s), 4-16 ms."""
    joint = d.joint()
    channel = "torque" if d.uniform() < 0.5 else "position"
    law = TorqueDelay if channel == "torque" else PositionDelay
    return Effect(
        d.kind,
        joint,
        lambda size, log: [law(joint - 1, size)],
        lambda size: {"channel": channel, "delay_s": size},
        0.004,
        0.016,
        d.log_uniform(0.004, 0.016),
        kept=True,
    )


def encoder_zero(d: Draw) -> Effect:
    """q + s, 0.3-1.5 deg."""
    joint = d.joint((2, 3, 4, 5))
    sign = d.sign()
    return Effect(
        d.kind,
        joint,
        lambda size, log: [Zero(joint - 1, sign * np.radians(size))],
        lambda size: {"offset_deg": sign * size},
        0.3,
        1.5,
        d.log_uniform(0.3, 1.5),
        kept=True,
    )
