"""Effects that no library is expected to know."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arm import FRICTION
from .effect import IDENTIFICATION, VALIDATION, Change, Draw, Effect
from .sensors import Drift, Hold, Saturation


def brake_drag(d: Draw) -> Effect:
    """Dry friction s [Nm] for 4-11 s, fading as the brake heats, in half of the arms by the
    angle; in a third not in the validation."""
    joint = d.joint()
    begin = d.uniform(4, 15)
    lasts = d.uniform(4, 11)
    rise = d.uniform(0.1, 1)
    fall = d.uniform(0.2, 2)
    fade = d.uniform(0, 0.5)
    by_angle = int(d.uniform() < 0.5)
    times = float(d.rng.integers(1, 4))
    phase = d.uniform(0, 6.28)
    second = d.uniform(2, 20)
    once = d.uniform() < 0.3

    def changes(size: float, log: str) -> list[Change]:
        start = second if log == VALIDATION else begin
        if once and log == VALIDATION:
            return d.law(joint, 0.0, 0, 1, 0.1, 0.1, 0, 0, 1, 0)
        ramps = (rise, fall, fade)
        return d.law(joint, size, start, start + lasts, *ramps, by_angle, times, phase)

    def told(size: float) -> dict[str, Any]:
        return {
            "drag_torque_Nm": size,
            "from_s": begin,
            "to_s": begin + lasts,
            "validation_from_s": None if once else second,
            "hot_fade": fade,
            "once_per_rev": bool(by_angle),
        }

    return Effect(d.kind, joint, changes, told, 0.2, 3 * FRICTION[joint - 1, 1])


def motor_saturation(d: Draw) -> Effect:
    """tau (1 + s y^p) beyond a knee: the current grows more than the torque."""
    joint = d.joint()
    knee = d.uniform(0.25, 0.5)
    exponent = d.uniform(1.3, 2.2)
    knee = float(knee * d.reach.peak[joint - 1])
    return Effect(
        d.kind,
        joint,
        lambda size, log: [Saturation(joint - 1, size, knee, exponent)],
        lambda size: {"extra_reading_at_peak": size, "knee_Nm": knee, "exponent": exponent},
        0.02,
        0.6,
    )


def friction_zone(d: Draw) -> Effect:
    """Dry friction s [Nm], and some viscous, about an angle: a bell, a plateau, or all beyond."""
    joint = d.joint()
    low = d.reach.low[joint - 1]
    high = d.reach.high[joint - 1]
    centre = float(low + d.uniform(0.3, 0.7) * (high - low))
    width = float(d.uniform(0.08, 0.22) * (high - low) / 2)
    law = int(d.rng.integers(3))
    width = width * d.sign() if law == 2 else width
    viscous = d.uniform(0, 0.4)

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, centre, width, law, viscous)

    def told(size: float) -> dict[str, Any]:
        return {
            "extra_dry_torque_Nm": size,
            "centre_rad": centre,
            "width_rad": width,
            "law": ("gauss", "flat_top", "beyond")[law],
            "viscous_share_s_rad": viscous,
        }

    return Effect(d.kind, joint, changes, told, 0.2, 4 * FRICTION[joint - 1, 1])


def soft_stop(d: Draw) -> Effect:
    """s log(1 + exp(y))^p [Nm] before an end of the range, y the depth over a softness, with
    loss."""
    joint = d.joint((1, 2, 3, 4, 5))
    low = d.reach.low[joint - 1]
    high = d.reach.high[joint - 1]
    direction = d.sign()
    inset = d.uniform(0.15, 0.3) * (high - low)
    begin = float(high - inset if direction > 0 else low + inset)
    softness = d.uniform(0.03, 0.1)
    exponent = d.uniform(1, 1.5)
    loss = d.uniform(0, 0.3)

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, begin, softness, exponent, direction, loss)

    def told(size: float) -> dict[str, Any]:
        return {
            "torque_at_softness_Nm": size,
            "starts_at_rad": begin,
            "direction": direction,
            "softness_rad": softness,
            "exponent": exponent,
            "loss_share": loss,
        }

    return Effect(d.kind, joint, changes, told, 0.002, 300)


def sloshing_tool(d: Draw) -> Effect:
    """A mass s [kg] on a spring of 1.3-3.5 Hz in the tool."""
    omega = 2 * np.pi * d.uniform(1.3, 3.5)
    ratio = d.uniform(0.03, 0.1)
    point = [d.uniform(0.05, 0.2), d.uniform(-0.05, 0.05), d.uniform(0.1, 0.25)]

    def told(size: float) -> dict[str, Any]:
        return {
            "mass_kg": size,
            "frequency_Hz": omega / 2 / np.pi,
            "damping_ratio": ratio,
            "point_frame6_m": point,
        }

    def changes(size: float, log: str) -> list[Change]:
        return d.law(1, size, omega, ratio, *point)

    return Effect(d.kind, None, changes, told, 0.5, 6)


def parallelogram_friction(d: Draw) -> Effect:
    """Friction s [Nm] of the rod's bearing by q3d - q2d: bristles, Stribeck, some viscous; on axis
    3, and against axis 2."""
    static = d.uniform(0, 0.5)
    stribeck = d.uniform(0.01, 0.03)
    bristle = d.log_uniform(1e-4, 6e-4)
    viscous = d.uniform(0, 0.5)

    def told(size: float) -> dict[str, Any]:
        return {
            "dry_torque_Nm": size,
            "static_extra": static,
            "stribeck_rad_s": stribeck,
            "bristle_rad": bristle,
            "viscous_share_s_rad": viscous,
            "acts_on": "q3 - q2",
        }

    def changes(size: float, log: str) -> list[Change]:
        return d.law(3, size, static, stribeck, bristle, viscous)

    return Effect(d.kind, 3, changes, told, 1, 60)


def spindle_gyro(d: Draw) -> Effect:
    """w x H of a spindle that spins up during the log, H = s [Nms] along x of frame 6."""
    begin = d.uniform(3, 12)
    rise = d.uniform(2, 6)
    before = float(d.rng.choice([1.0, 0.2, 0.0]))
    sign = d.sign()

    def changes(size: float, log: str) -> list[Change]:
        return d.law(1, size, begin if log == IDENTIFICATION else -9.0, rise, sign, before)

    def told(size: float) -> dict[str, Any]:
        return {
            "angular_momentum_Nms": size,
            "sign": sign,
            "share_before_spin_up": before,
            "spin_up_from_s": begin,
            "spin_up_time_s": rise,
        }

    return Effect(d.kind, None, changes, told, 0.2, 8)


def spindle_unbalance(d: Draw) -> Effect:
    """A force s [N] on the spindle that turns at 9-28 Hz, not quite evenly."""
    frequency = d.uniform(9, 28)
    phase = d.uniform(0, 6.28)
    wobble = d.uniform(0, 3)
    return Effect(
        d.kind,
        None,
        lambda size, log: d.law(1, size, frequency, phase, wobble),
        lambda size: {"force_N": size, "frequency_Hz": frequency, "wobble_rad": wobble},
        1,
        150,
    )


def torque_drift(d: Draw) -> Effect:
    """tau + s (a slow wave + a ramp) [Nm], another one in the validation."""
    joint = d.joint()
    weights = d.rng.normal(size=(2, 8)) / np.arange(1, 9) ** 1.3
    ramps = d.rng.normal(0, 1, 2)

    def changes(size: float, log: str) -> list[Change]:
        which = int(log == VALIDATION)
        return [Drift(joint - 1, size, weights[which], float(ramps[which]))]

    def told(size: float) -> dict[str, Any]:
        cosines = weights[0].tolist()
        return {"scale_Nm": size, "cosine_weights": cosines, "ramp_weight": float(ramps[0])}

    return Effect(d.kind, joint, changes, told, 0.01, 100)


def sample_hold(d: Draw) -> Effect:
    """All torques stand still now and then, for s [s] on average."""
    rate = d.uniform(0.8, 2.5)
    seed = int(d.rng.integers(1 << 30))
    return Effect(
        d.kind,
        None,
        lambda size, log: [Hold(-1, size, rate, seed + (log == VALIDATION))],
        lambda size: {"mean_hold_s": size, "holds_per_s": rate},
        0.015,
        0.25,
    )
