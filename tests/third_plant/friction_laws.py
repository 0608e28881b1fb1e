"""Effects on the friction of a joint; the laws themselves are in `csrc/laws.c`."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arm import FRICTION, SPEEDS
from .effect import VALIDATION, Change, Draw, Effect


def coulomb_asymmetry(d: Draw) -> Effect:
    """Dry friction times 1 + s w in one direction, 1 - o s w in the other; w falls from 1 to a
    share of it as exp(-|qd| / v)."""
    joint = d.joint()
    kept = d.maybe(0.5, 0.5, 1, 1.0)
    fade = d.uniform(0.1, 0.5)
    other = d.maybe(0.5, 0.2, 0.9)
    direction = d.sign()

    def told(size: float) -> dict[str, Any]:
        return {
            "relative_in_stronger_direction": size,
            "stronger_direction": direction,
            "relative_in_other_direction": -other * size,
            "share_kept_at_speed": kept,
            "fade_speed_rad_s": fade,
        }

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, kept, fade, other, direction)

    return Effect(d.kind, joint, changes, told, 0.12, 0.9 if other else 1.5)


def coulomb_change(d: Draw) -> Effect:
    """Coulomb friction times 1 + s, break-away friction times 1 + r s."""
    joint = d.joint()
    sign = d.sign(0.6)
    ratio = d.uniform(0.5, 1.2)

    def told(size: float) -> dict[str, Any]:
        return {"relative_coulomb": sign * size, "relative_static": sign * size * ratio}

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, sign * size, ratio)

    return Effect(d.kind, joint, changes, told, 0.15, 1.5 if sign > 0 else 0.7)


def viscous_change(d: Draw) -> Effect:
    """s Fv qd (1 + b |qd| / v), v the speed limit."""
    joint = d.joint()
    sign = d.sign(0.6)
    shape = d.uniform(-0.15, 0.15)
    limit = float(SPEEDS[joint - 1])

    def told(size: float) -> dict[str, Any]:
        return {"relative_viscous": sign * size, "speed_shape": shape, "shape_speed_rad_s": limit}

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, sign * size, shape, limit)

    return Effect(d.kind, joint, changes, told, 0.15, 2.0 if sign > 0 else 0.7)


def viscous_warmup(d: Draw) -> Effect:
    """s Fv qd f: f falls exponentially within T, by the heat of friction, or as
    1 / (1 + (t / T)^n). The validation comes later."""
    joint = d.joint()
    j = joint - 1
    law = int(d.rng.integers(3))
    time = d.uniform(8, 35)
    age = d.uniform(0, 4)
    later = d.uniform(40, 250)
    speed = d.reach.speed[j]
    power = FRICTION[j, 1] * speed * 0.8 + FRICTION[j, 2] * speed**2
    thermal = d.uniform(1, 2.5)
    exponent = d.uniform(1, 2)
    warmth = d.uniform(0.4, 0.9)

    def changes(size: float, log: str) -> list[Change]:
        second = log == VALIDATION
        if law == 1:
            return d.law(joint, size, law, time, warmth if second else 0.0, power, thermal)
        return d.law(joint, size, law, time, age + later * second, exponent, thermal)

    def told(size: float) -> dict[str, Any]:
        return {
            "cold_relative_viscous": size,
            "law": ("exponential", "friction_power_heating", "rational")[law],
            "time_constant_s": time,
            "start_age_s": age,
            "validation_later_s": later,
            "thermal_exponent": thermal,
            "rational_exponent": exponent,
        }

    return Effect(d.kind, joint, changes, told, 0.1, 3.0)


def load_friction(d: Draw) -> Effect:
    """s r (soft(load) / r)^p sign(qd), another tenth or so where the load drives; r the joint's rms
    torque, soft(x) = sqrt(x2 + t2) - t."""
    joint = d.joint()
    usual = float(d.reach.rms[joint - 1])
    soft = d.uniform(0.05, 0.3) * usual
    exponent = d.uniform(0.8, 1.25)
    driving = d.maybe(0.6, -0.25, 0.25)

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, soft, exponent, usual, driving, 0.1 * usual)

    def told(size: float) -> dict[str, Any]:
        return {
            "coefficient": size,
            "soft_torque_Nm": soft,
            "exponent": exponent,
            "reference_torque_Nm": usual,
            "driving_minus_braking_share": driving,
        }

    return Effect(d.kind, joint, changes, told, 0.005, 0.25)


def hysteresis(d: Draw) -> Effect:
    """s times 4-6 Maxwell sliders, or Dahl's dF = (1 - sign(dq) F)^n dq / r; half of the arms have
    part of it in the place of dry friction."""
    joint = d.joint()
    reach = d.log_uniform(2e-3, 12e-3)
    sliders = int(d.rng.choice([0, 4, 5, 6]))
    replaced = d.maybe(0.5, 0.3, 0.8)
    exponent = d.uniform(0.7, 1.6)
    count = max(sliders, 1)
    weights = d.rng.dirichlet(np.full(count, 2.0))
    ranges = reach * np.sort(d.rng.uniform(0.1, 1, count))
    ranges[-1] = reach

    def changes(size: float, log: str) -> list[Change]:
        numbers = np.zeros(15)
        numbers[:2] = [size, sliders]
        if sliders:
            numbers[2 : 2 + sliders] = weights
            numbers[8 : 8 + sliders] = ranges
        else:
            numbers[8:10] = [reach, exponent]
        numbers[14] = replaced
        return d.law(joint, *numbers)

    def told(size: float) -> dict[str, Any]:
        return {
            "saturated_torque_Nm": size,
            "range_rad": reach,
            "law": f"maxwell_slip_{sliders}" if sliders else "dahl",
            "dahl_exponent": exponent,
            "weights": weights.tolist(),
            "ranges_rad": ranges.tolist(),
            "replaced_coulomb_share": replaced,
        }

    most = (0.8 / replaced if replaced else 1.5) * FRICTION[joint - 1, 1]
    return Effect(d.kind, joint, changes, told, 0.3, most)


def viscous_power(d: Draw) -> Effect:
    """s (|qd| / v)^p sign(qd), p = 1.5-2.5, v half the speed limit."""
    joint = d.joint()
    exponent = d.uniform(1.5, 2.5)
    speed = float(SPEEDS[joint - 1]) / 2

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, exponent, speed)

    def told(size: float) -> dict[str, Any]:
        return {
            "torque_at_reference_speed_Nm": size,
            "exponent": exponent,
            "reference_speed_rad_s": speed,
        }

    return Effect(d.kind, joint, changes, told, 0.1, 150)
