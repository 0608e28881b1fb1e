"""Effects that add a torque to a joint or a force to the tool; the laws themselves are in
`csrc/laws.c` and `csrc/tool_laws.c`."""

from __future__ import annotations

from typing import Any

import numpy as np

from .effect import Change, Draw, Effect


def gear_ripple(d: Draw) -> Effect:
    """s (sin(n q + p) + a sin(2 n q + p') + b sin(n q / 2 + p'')), growing with load and
    direction."""
    joint = d.joint()
    whole = d.uniform() < 0.7
    order = d.log_uniform(8, 60)
    order = float(round(order)) if whole else order
    second = d.maybe(0.5, 0.1, 0.5)
    load = d.uniform(0, 0.5)
    half = d.maybe(0.3, 0.1, 0.3)
    direction = d.uniform(-0.3, 0.3)
    phases = d.rng.uniform(0, 6.28, 3)
    usual = d.reach.rms[joint - 1]

    def changes(size: float, log: str) -> list[Change]:
        waves = (order, phases[0], second, phases[1], load, usual, half, direction, phases[2])
        return d.law(joint, size, *waves)

    def told(size: float) -> dict[str, Any]:
        return {
            "amplitude_Nm": size,
            "order_per_rev": order,
            "second_share": second,
            "half_order_share": half,
            "load_share": load,
            "direction_share": direction,
            "phases_rad": phases.tolist(),
        }

    most = 0.15 if joint > 3 else 0.08
    return Effect(d.kind, joint, changes, told, 0.01 * usual, 0.3 * usual, most=most)


def balancer(d: Draw) -> Effect:
    """s F(l) dl/dq between a crank on the joint and a pivot: F of a spring with preload, or of a
    gas (l0 / l)^n; its seal rubs."""
    joint = d.joint((2, 3))
    gas = int(d.rng.integers(2))
    crank = d.uniform(0.15, 0.35)
    pivot = d.uniform(0.4, 0.8)
    phase = d.uniform(-0.25, 0.25) if joint == 2 else -1.5708 + d.uniform(-0.35, 0.35)
    free = pivot if gas else (pivot - crank) * d.uniform(0.9, 1.0)
    preload = 1.0 if gas else d.uniform(0.0, 0.4)
    exponent = d.uniform(1.1, 1.4)
    seal = d.uniform(0, 0.06)

    def changes(size: float, log: str) -> list[Change]:
        slope = exponent if gas else 1.0
        return d.law(joint, size, gas, crank, pivot, phase, free, slope, preload, seal)

    def told(size: float) -> dict[str, Any]:
        return {
            "law": ("spring", "gas")[gas],
            "scale": size,
            "scale_unit": ("N/m", "N")[gas],
            "crank_m": crank,
            "pivot_m": pivot,
            "phase_rad": phase,
            "free_length_m": free,
            "preload_relative": preload,
            "gas_exponent": exponent,
            "seal_friction_share": seal,
        }

    return Effect(d.kind, joint, changes, told, 5, 2e4, balances=True)


def cable_spring(d: Draw) -> Effect:
    """s f(x), x the angle from rest over half the range, less what has crept: x + n x3, tanh(1.3 x)
    (1 + n |x|), or x + n x2 on one side."""
    joint = d.joint((4, 5, 6))
    low = d.reach.low[joint - 1]
    high = d.reach.high[joint - 1]
    rest = float((low + high) / 2 + d.uniform(-0.4, 0.4) * (high - low) / 2)
    law = int(d.rng.integers(3))
    bent = d.uniform(0.1, 0.5)
    time = d.uniform(1, 4)
    creep = d.maybe(0.5, 0.05, 0.3)
    scale = float((high - low) / 2)

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, size, rest, scale, law, bent, 0, time, creep)

    def told(size: float) -> dict[str, Any]:
        return {
            "torque_scale_Nm": size,
            "scale_angle_rad": scale,
            "rest_angle_rad": rest,
            "law": ("cubic", "saturating", "one_sided_quadratic")[law],
            "nonlinear_share": bent,
            "creep_share": creep,
            "creep_time_s": time,
        }

    return Effect(d.kind, joint, changes, told, 0.05, 40)


def wrist_coupling(d: Draw) -> Effect:
    """The joint before drives this one: s (w v / v0 + (1 - w) tanh(v / v1)) of its speed, or of
    the relative speed in a mesh, which pushes back."""
    joint = d.joint((5, 6))
    driver = joint - 1
    mesh = int(d.uniform() < 0.4)
    viscous = d.uniform(0.3, 1)
    ratio = d.sign() * d.uniform(0.25, 0.7)
    speed = float(d.reach.speed[driver - 1])
    dry = d.uniform(0.02, 0.06)
    sign = 1.0 if mesh else d.sign()

    def changes(size: float, log: str) -> list[Change]:
        return d.law(joint, sign * size, driver - 1, mesh, viscous, ratio, speed, dry)

    def told(size: float) -> dict[str, Any]:
        return {
            "driven_by_joint": driver,
            "law": ("one_way", "gear_mesh_relative_speed")[mesh],
            "torque_Nm": sign * size,
            "viscous_share": viscous,
            "mesh_ratio": ratio,
            "speed_scale_rad_s": speed,
            "coulomb_speed_rad_s": dry,
        }

    return Effect(d.kind, joint, changes, told, 0.1, 30)


def process_force(d: Draw) -> Effect:
    """s [N] on the tool's tip along a direction of base or tool: constant, in cuts or once; a
    part of the arms with chatter."""
    direction = d.rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    law = int(d.rng.choice([0, 1, 1, 2]))
    frame = int(d.rng.integers(2))
    period = d.uniform(2, 7)
    duty = d.uniform(0.3, 0.7)
    phase = d.uniform()
    ramp = d.log_uniform(0.02, 0.2)
    begin = d.uniform(3, 15)
    end = begin + d.uniform(5, 12)
    chatter = d.maybe(0.4, 0.05, 0.2)
    frequency = d.uniform(5, 20)

    def changes(size: float, log: str) -> list[Change]:
        window = (begin, end) if law == 2 else (period, duty)
        return d.law(1, size, law, frame, *direction, *window, phase, ramp, chatter, frequency)

    def told(size: float) -> dict[str, Any]:
        return {
            "force_N": size,
            "frame": ("base", "tool")[frame],
            "direction": direction.tolist(),
            "law": ("constant", "pulses", "burst")[law],
            "period_s": period,
            "duty": duty,
            "burst_s": [begin, end],
            "ramp_s": ramp,
            "chatter_share": chatter,
            "chatter_Hz": frequency,
        }

    return Effect(d.kind, None, changes, told, 5, 400)
