"""Effects that change the arm itself, its transmission or its measuring chain: their laws, by
size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import native
from .effects import Drawn
from .parameters import FLANGE_OFFSET, RANGES, TORQUE_LIMITS, Arm, join

RIGID = np.array([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def _lump(mass: float, centre: np.ndarray, radius: float) -> np.ndarray:
    """A sphere of that radius of gyration."""
    return np.concatenate([[mass], centre, np.full(3, mass * radius**2), np.zeros(3)])


def changed_arm(arm: Arm, drawn: Drawn, size: float) -> Arm:
    """The arm with a payload [kg], bracket [kg], rod [kg], rotor [kg m2] or tilt [rad] of that
    size."""
    a, b, c = drawn.spare[:3]
    match drawn.effect.kind:
        case "payload":
            centre = np.array([0.06 * a, 0.06 * b, FLANGE_OFFSET + 0.12 + 0.1 * c])
            return replace(arm, payload=_lump(size, centre, 0.06))
        case "link_inertia":
            assert drawn.joint is not None
            i = drawn.joint - 1
            reach = {1: [0.4, 0.0, 0.0], 2: [0.1, 0.3, 0.0], 3: [0.0, 0.0, -0.35]}[i]
            centre = np.array(reach) + 0.12 * np.array([a, b, c])
            return arm.with_body(i, join(arm.bodies[i], _lump(size, centre, 0.08)))
        case "linkage_inertia":
            return replace(
                arm, rod=np.array([size, 0.35 + 0.05 * a, -np.pi / 2 + 0.3 * b, 0.08 + 0.05 * c])
            )
        case "rotor_inertia":
            assert drawn.joint is not None
            rotor = arm.rotor.copy()
            rotor[drawn.joint - 1] += size
            return replace(arm, rotor=rotor)
        case "base_tilt":
            heading = np.pi * a
            down = np.array(
                [np.sin(size) * np.cos(heading), np.sin(size) * np.sin(heading), -np.cos(size)]
            )
            return replace(arm, gravity=9.81 * down)
    raise ValueError(f"{drawn.effect.kind} does not change the arm")


def transmission(arm: Arm, drawn: Drawn, size: float) -> np.ndarray:
    """Two-mass transmission: compliance relative to a 5 Hz joint, or half the gap [rad] before a
    stiff one.

    The motor takes its rotor's inertia out of the link's, so that at low frequency the arm is the
    rigid one.
    """
    assert drawn.joint is not None
    j = drawn.joint - 1
    rng = np.random.default_rng(7)
    poses = rng.uniform(0.6 * RANGES[:, 0], 0.6 * RANGES[:, 1], (60, 6))
    mass = [native.equations_of_motion(arm.packed(), q, np.zeros(6))[0] for q in poses]
    rotor = 0.35 * min(1 / np.linalg.inv(m)[j, j] for m in mass)
    link = np.median([m[j, j] for m in mass]) - rotor
    if drawn.effect.kind == "elastic_joint":
        stiffness = link * (2 * np.pi * 5.0) ** 2 / size
        cubic = 2e3 * (1 + drawn.spare[0])
        gap = 0.0
        damping = 0.06
    else:
        stiffness = link * (2 * np.pi * 30.0) ** 2
        cubic = 0.0
        gap = size
        damping = 0.2
    stiffness = min(stiffness, rotor * 2500.0**2)  # what steps of 0.25 ms resolve
    return np.array([j, rotor, stiffness, cubic, 2 * damping * np.sqrt(stiffness * rotor), gap])


def measured_torque(time: np.ndarray, tau: np.ndarray, drawn: Drawn, size: float) -> np.ndarray:
    """What the measuring chain reports of torques (n, 6) at even times: gain, offset or delay."""
    seen = tau.copy()
    if drawn.effect.kind == "time_delay":  # seven tenths pure delay, three tenths first-order lag
        dt = time[1] - time[0]
        pole = np.exp(-dt / max(0.3 * size, 1e-9))
        for i in range(6):
            late = np.interp(time - 0.7 * size, time, tau[:, i])
            seen[:, i] = _first_order(late, pole)
    elif drawn.effect.kind in ("torque_gain", "torque_offset"):
        assert drawn.joint is not None
        j = drawn.joint - 1
        if drawn.effect.kind == "torque_gain":
            seen[:, j] *= 1 + size * (1 - 0.4 * np.abs(tau[:, j]) / TORQUE_LIMITS[j])
        else:
            seen[:, j] += size * (1 + 0.1 * np.sin(2 * np.pi * time / 150 + drawn.spare[0]))
    return np.where((time >= drawn.effect.on_at)[:, None], seen, tau)


def _first_order(x: np.ndarray, pole: float) -> np.ndarray:
    from scipy.signal import lfilter

    out, _ = lfilter([1 - pole], [1, -pole], x, zi=[pole * x[0]])
    return np.asarray(out)
