"""Effects that change bodies, inertia or transmission."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .arm import GRAVITY, Arm, Body, Transmission
from .effect import Change, Draw, Effect

TOOL = 7
"""as a link"""


def payload(d: Draw) -> Effect:
    """A body of 2-8 kg at the flange: inertia m diag(ky2 + kz2, kx2 + kz2, kx2 + ky2)."""
    centre = np.array([d.rng.normal(0, 0.06), d.rng.normal(0, 0.06), d.uniform(0.02, 0.2)])
    gyration = d.rng.uniform(0.03, 0.1, 3)
    x2, y2, z2 = gyration**2

    def changes(mass: float, log: str) -> list[Change]:
        body = Body(mass, centre, mass * np.diag([y2 + z2, x2 + z2, x2 + y2]))
        return [lambda arm: replace(arm, flange=(*arm.flange, body))]

    def told(mass: float) -> dict[str, Any]:
        gyrations = gyration.tolist()
        return {"mass_kg": mass, "com_flange_m": centre.tolist(), "gyration_m": gyrations}

    return Effect(d.kind, None, changes, told, 2, 8, d.log_uniform(2, 8), kept=True)


def rotor_inertia(d: Draw) -> Effect:
    """J qdd on one joint, or on all, each with its own [kg m2]."""
    if d.wanted is None and d.uniform() < 0.5:
        weights = d.reach.inertia * np.exp(d.rng.normal(0, 0.4, 6))
        joint = None
        low = 0.02
        high = 1.5
    else:
        joint = d.joint()
        weights = np.eye(6)[joint - 1]
        low = 0.02 * d.reach.inertia[joint - 1]
        high = 1.5 * d.reach.inertia[joint - 1]

    def changes(size: float, log: str) -> list[Change]:
        return [lambda arm: replace(arm, rotor=arm.rotor + size * weights)]

    def told(size: float) -> dict[str, Any]:
        inertia = size if joint else (size * weights).tolist()
        return {"reflected_inertia_kgm2": inertia}

    return Effect(d.kind, joint, changes, told, low, high)


def base_tilt(d: Draw) -> Effect:
    """Gravity tilted by 0.5-3 deg towards a direction drawn."""
    azimuth = d.uniform(0, 6.28)

    def changes(tilt: float, log: str) -> list[Change]:
        angle = np.radians(tilt)
        level = np.array([np.cos(azimuth) * np.sin(angle), np.sin(azimuth) * np.sin(angle)])
        gravity = GRAVITY * np.array([*level, -np.cos(angle)])
        return [lambda arm: replace(arm, gravity=gravity)]

    def told(tilt: float) -> dict[str, Any]:
        return {"tilt_deg": tilt, "direction_deg": float(np.degrees(azimuth))}

    return Effect(d.kind, None, changes, told, 0.5, 3, d.log_uniform(0.5, 3), kept=True)


def _with_link(arm: Arm, link: int, factors: tuple[float, float, float]) -> Arm:
    if link == TOOL:
        return replace(arm, flange=(arm.flange[0].scaled(*factors), *arm.flange[1:]))
    links = list(arm.links)
    links[link - 1] = links[link - 1].scaled(*factors)
    return replace(arm, links=tuple(links))


def link_inertia(d: Draw) -> Effect:
    """Mass, centre and inertia of link 2-4 or the tool times 1 + s, 1 + s fc, 1 + s fi."""
    link = int(d.rng.choice([2, 3, 4, 4, TOOL]))
    sign = d.sign(0.65)
    inertia = d.uniform(0.5, 1.3)
    centre = d.rng.normal(0, 0.06)

    def changes(size: float, log: str) -> list[Change]:
        moved = sign * size
        factors = (1 + moved, 1 + moved * centre, 1 + moved * inertia)
        return [lambda arm: _with_link(arm, link, factors)]

    def told(size: float) -> dict[str, Any]:
        return {
            "link": "tool" if link == TOOL else link,
            "relative_mass": sign * size,
            "relative_inertia": sign * size * inertia,
            "relative_com": sign * size * centre,
        }

    return Effect(d.kind, None, changes, told, 0.12, 0.9 if sign > 0 else 0.5)


def elastic_joint(d: Draw) -> Effect:
    """A spring between motor and link: k x (1 + k3 x2) + c xd, x the twist; its size is the
    compliance [rad/Nm], the motor's side a share of the joint's inertia."""
    joint = d.joint((1, 2, 3, 1, 2, 3, 4, 5, 6))
    whole = d.reach.inertia[joint - 1]
    motor = d.uniform(0.2, 0.45) * whole
    link = whole - motor
    ratio = d.uniform(0.02, 0.07)
    stiffer = d.maybe(0.5, 0, 0.3)

    def changes(size: float, log: str) -> list[Change]:
        stiffness = 1 / size
        damping = 2 * ratio * np.sqrt(stiffness * link)
        stiffening = stiffer / (d.reach.rms[joint - 1] / stiffness) ** 2
        return [Transmission(joint - 1, stiffness, damping, motor, stiffening=stiffening)]

    def told(size: float) -> dict[str, Any]:
        return {
            "stiffness_Nm_rad": 1 / size,
            "motor_side_inertia_kgm2": motor,
            "locked_motor_frequency_Hz": float(np.sqrt(1 / size / link) / 2 / np.pi),
            "damping_ratio": ratio,
            "stiffening_at_rms_torque": stiffer,
        }

    softest = link * (2 * np.pi * 4.5) ** 2
    stiffest = link * (2 * np.pi * 40) ** 2
    return Effect(d.kind, joint, changes, told, 1 / stiffest, 1 / softest, closed=True)


def transmission_backlash(d: Draw) -> Effect:
    """Play between motor and link; k y + c xd in contact, y the twist beyond half of it; its size
    is the play [rad], the contact's frequency 25-45 Hz."""
    joint = d.joint((1, 4, 5, 6))
    whole = d.reach.inertia[joint - 1]
    motor = d.uniform(0.2, 0.45) * whole
    link = whole - motor
    frequency = d.uniform(25, 45)
    stiffness = link * (2 * np.pi * frequency) ** 2
    ratio = d.uniform(0.1, 0.3)
    damping = 2 * ratio * np.sqrt(stiffness * link)

    def changes(size: float, log: str) -> list[Change]:
        return [Transmission(joint - 1, stiffness, damping, motor, gap=size)]

    def told(size: float) -> dict[str, Any]:
        return {
            "gap_rad": size,
            "contact_stiffness_Nm_rad": stiffness,
            "contact_frequency_Hz": frequency,
            "motor_side_inertia_kgm2": motor,
            "damping_ratio": ratio,
        }

    return Effect(d.kind, joint, changes, told, 3e-4, 1e-2, closed=True)
