"""An effect on an arm: its shape drawn, its size found, what it adds to the torque of a motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from independent_plant.parameters import FLANGE_OFFSET, Arm, join

from .draws import KINDS, LIBRARY, Make, Recipe
from .forces import State
from .machine import Machine, TipForce
from .mjcf import TO_LINKS, Spring

STREAM = 250.0
"""rate at which torques are compared [Hz]"""


@dataclass(frozen=True)
class Wanted:
    """What is asked for: a kind, where (None: drawn, or the whole arm), and its rms torque over the
    joint's, or its size in the law's own unit."""

    kind: str
    joint: int | None = None
    fraction: float = 0.05
    size: float | None = None


@dataclass(frozen=True)
class Present:
    """A kind on a joint (1-6 or None) with everything drawn but its size: sign, law, spare
    numbers; gear ripple is MuJoCo's cogging where `poles` is given."""

    kind: str
    joint: int | None
    sign: float
    make: Make | None
    spare: tuple[float, ...]
    poles: int | None

    @property
    def recipe(self) -> Recipe:
        return KINDS[self.kind]

    @property
    def index(self) -> int:
        """The joint as a place in an array; 0 for the whole arm."""
        return (self.joint or 1) - 1

    @property
    def limit(self) -> float:
        """Largest plausible size."""
        wrist = self.joint is not None and self.joint > 3 and self.recipe.where == "force"
        return self.recipe.limit * (0.1 if wrist or self._light else 1.0)

    @property
    def _light(self) -> bool:
        return self.kind == "rotor_inertia" and self.index > 2

    @property
    def in_library(self) -> bool:
        return self.kind in LIBRARY


def draw(wanted: Wanted, rng: np.random.Generator) -> Present:
    """Joint, sign, shape."""
    recipe = KINDS[wanted.kind]
    joint = wanted.joint
    if joint is None and recipe.joints:
        joint = int(rng.choice(recipe.joints))
    sign = float(rng.choice([-1.0, 1.0])) if recipe.signed else 1.0
    make = None if recipe.draw is None else recipe.draw(rng, (joint or 1) - 1)
    spare = tuple(float(v) for v in rng.uniform(-1, 1, 4))
    cogs = wanted.kind == "gear_ripple" and rng.uniform() < 1.0 / 3.0
    poles = int(rng.integers(8, 40)) if cogs else None
    return Present(wanted.kind, joint, sign, make, spare, poles)


def lump(mass: float, centre: np.ndarray, radius: float) -> np.ndarray:
    """A sphere of that radius of gyration."""
    return np.concatenate([[mass], centre, np.full(3, mass * radius**2), np.zeros(3)])


def changed_arm(arm: Arm, effect: Present, size: float) -> Arm:
    """With payload [kg], bracket [kg], rotor [kg m2], or tilted by [rad]."""
    a, b, c = effect.spare[:3]
    if effect.kind == "payload":
        centre = np.array([0.07 * a, 0.07 * b, FLANGE_OFFSET + 0.1 + 0.08 * c])
        return replace(arm, payload=lump(size, centre, 0.05))
    if effect.kind == "link_inertia":
        reach = {1: [0.4, 0.0, 0.0], 2: [0.1, 0.2, 0.0], 3: [0.0, 0.0, -0.3]}[effect.index]
        body = lump(size, np.array(reach) + 0.1 * np.array([a, b, c]), 0.07)
        return arm.with_body(effect.index, join(arm.bodies[effect.index], body))
    if effect.kind == "rotor_inertia":
        return replace(arm, rotor=arm.rotor + size * np.eye(6)[effect.index])
    if effect.kind == "base_tilt":
        down = [np.sin(size) * np.cos(np.pi * a), np.sin(size) * np.sin(np.pi * a), -np.cos(size)]
        return replace(arm, gravity=9.81 * np.array(down))
    raise ValueError(f"{effect.kind} does not change the arm")


def spring_of(machine: Machine, effect: Present, size: float) -> Spring:
    """A resonance of 7 Hz / sqrt(size) with the rotor held, or half the play [rad] before a stiff
    spring; three tenths of what the motor feels at least are its own."""
    j = effect.index
    rotor = 0.3 * float(machine.least_inertia[j])
    link = float(machine.inertia[j]) - rotor
    a, b = effect.spare[:2]
    if effect.kind == "elastic_joint":
        stiffness = link * (2 * np.pi * 7.0) ** 2 / size
        return Spring(j, rotor, stiffness, 2 * (0.05 + 0.02 * a) * np.sqrt(stiffness * link))
    stiffness = link * (2 * np.pi * 30.0) ** 2
    return Spring(j, rotor, stiffness, 2 * (0.2 + 0.05 * b) * np.sqrt(stiffness * link), size)


def with_effect(machine: Machine, effect: Present, size: float) -> Machine:
    """The machine with what changes arm or transmission."""
    if effect.recipe.where == "arm":
        return replace(machine, arm=changed_arm(machine.arm, effect, size))
    if effect.recipe.where == "transmission":
        spring = spring_of(machine, effect, size)
        bandwidth = machine.bandwidth.copy()
        bandwidth[effect.index] *= 0.4
        return replace(machine, spring=spring, bandwidth=bandwidth)
    if effect.poles is not None:
        cogs = list(machine.cogging)
        # MuJoCo adds its cogging to what the motor gives
        cogs[effect.index] = (-size, effect.poles, np.pi * effect.spare[0])
        return replace(machine, cogging=tuple(cogs))
    return machine


def reported(time: np.ndarray, tau: np.ndarray, effect: Present, size: float) -> np.ndarray:
    """What the measuring chain makes of torques (n, 6) at even times."""
    seen = tau.copy()
    j = effect.index
    a, b = effect.spare[:2]
    if effect.kind == "torque_gain":  # a little less where it is large, or one way
        bend = 1 - 0.15 * (1 + a) * np.abs(tau[:, j]) / np.abs(tau[:, j]).max()
        seen[:, j] *= 1 + size * bend * np.where(tau[:, j] > 0, 1.0, 1.0 + 0.1 * b)
    elif effect.kind == "torque_offset":
        seen[:, j] += size * (1 + 0.05 * a * np.sin(2 * np.pi * time / 90 + 3 * b))
    elif effect.kind == "gain_drift":
        seen[:, j] *= 1 + size * (1 - np.exp(-time / (12 + 6 * a)))
    elif effect.kind == "time_delay":  # part dead time, part first-order lag
        from scipy.signal import lfilter

        dead = size * (0.65 + 0.3 * a)
        pole = np.exp(-(time[1] - time[0]) / (size - dead))
        for k in range(6):
            late = np.interp(time - dead, time, tau[:, k])
            seen[:, k] = lfilter([1 - pole], [1, -pole], late, zi=[pole * late[0]])[0]
    return seen


def force_torque(
    machine: Machine, effect: Present, size: float, moving: np.ndarray, load: np.ndarray
) -> np.ndarray:
    """A law of force along a motion (n, 18) at `STREAM`, (n, 6)."""
    if effect.poles is not None:
        angle = effect.poles * moving[:, effect.index] + np.pi * effect.spare[0]
        return np.asarray(size * np.sin(angle)[:, None] * np.eye(6)[effect.index])
    assert effect.make is not None
    law = effect.make(size)
    data = mujoco.MjData(machine.model)
    hold = TipForce(machine.model, data)

    def tip_force(force: np.ndarray) -> np.ndarray:
        data.qpos[:6] = TO_LINKS @ np.array(state.q)
        mujoco.mj_kinematics(machine.model, data)
        mujoco.mj_comPos(machine.model, data)
        return hold(force)

    state = State(1.0 / STREAM, tip_force)
    out = np.zeros((len(moving), 6))
    for i, row in enumerate(moving):
        state.at(i / STREAM, row[:6], row[6:12], load[i])
        law.add(state, out[i])
    return out
