"""An arm with effects under its servo: what is simulated, and what each effect adds to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import signal

from . import native
from .arm import BEND_SIGMA, FRICTION_SIGMA, NOMINAL, TORQUES, Arm, Law, Transmission
from .effect import Effect
from .sensors import DT, SHOWN, TIME, Channel, Motion, Zero, in_log, seen, unseen

BAND = 40
"""Hz, up to which a transmission's torque is told: break-away of the light motor side is beyond"""
_LOW_PASS = signal.butter(4, BAND, fs=1 / DT, output="sos")


def rms(x: np.ndarray) -> np.ndarray:
    """Per column."""
    return np.asarray(np.sqrt((x**2).mean(0)))


def smoothed(command: np.ndarray, frequency: float, ratio: float) -> np.ndarray:
    """As the controller's path filter of second order hands it to the servo."""
    w = 2 * np.pi * frequency
    b, a = signal.bilinear([w * w], [1, 2 * ratio * w, w * w], 1 / DT)
    start = np.concatenate([command[0, :6], np.zeros(12)])
    return np.asarray(signal.lfilter(b, a, command - start, axis=0) + start)


def with_effects(
    arm: Arm, effects: Sequence[Effect], log: str, rigid: bool = False
) -> tuple[Arm, list[Channel]]:
    """The arm and its measuring chain in one of the logs; `rigid`: without transmissions that give
    way."""
    chain: list[Channel] = []
    for effect in effects:
        for change in effect.changes_in(log):
            if isinstance(change, Law):
                arm = arm.with_law(change)
            elif isinstance(change, Channel):
                chain.append(change)
            elif isinstance(change, Transmission):
                arm = arm if rigid else replace(arm, transmission=change)
            else:
                arm = change(arm)
    return arm, chain


@dataclass(frozen=True)
class Servo:
    """Gains of six joints: natural frequencies [rad/s] about a median inertia, damping, integral
    rate [1/s], shares of inertia and friction that are fed ahead; the path filter's frequency [Hz]
    and damping."""

    frequencies: np.ndarray
    damping: float
    integral: float
    inertia_ahead: float
    friction_ahead: float
    filter: tuple[float, float]

    @staticmethod
    def drawn(rng: np.random.Generator) -> Servo:
        """A drive of 8-16 Hz."""
        frequencies = 2 * np.pi * rng.uniform(8, 16) * np.array([1, 1, 1, 1.2, 1.2, 1.3])
        damping = rng.uniform(0.7, 1.0)
        inertia = rng.uniform(0.75, 1.0)
        friction = 1.0 if rng.uniform() < 0.6 else 0.0
        path = (rng.uniform(8, 25), rng.uniform(0.75, 1.0))
        return Servo(frequencies, damping, rng.uniform(3, 10), inertia, friction, path)

    def gains(self, inertia: np.ndarray) -> np.ndarray:
        """As the C structure, for inertias (6,)."""
        kp = inertia * self.frequencies**2
        kd = 2 * self.damping * self.frequencies * inertia
        ahead = [self.inertia_ahead, self.friction_ahead]
        return np.concatenate([kp, kd, kp * self.integral, ahead])


@dataclass(frozen=True)
class Run:
    """One simulated motion.

    Args:
        cut: how often a motor was at its limit during the log.
        motion: at the motors, 4 kHz; seen: as the encoders show it.
        tau: as the log has it, without noise, (n, 6) at 250 Hz.
        given: what a transmission that gives way adds to the motors' torque, (m, 6) at 4 kHz.
    """

    cut: int
    motion: Motion
    seen: Motion
    tau: np.ndarray
    given: np.ndarray | float


def run(
    arm: Arm, effects: Sequence[Effect], log: str, command: np.ndarray, gains: np.ndarray
) -> Run:
    """The closed loop along a command (m, 18)."""
    plant, chain = with_effects(arm, effects, log)
    for channel in chain:
        if isinstance(channel, Zero):
            command = command.copy()
            command[:, channel.joint] = channel.unseen(command[:, channel.joint], 0)
    packed = plant.packed()
    start = float(TIME[0])
    believed = NOMINAL.packed()
    cut, (q, qd, qdd, u) = native.simulate(packed, believed, command, gains, TORQUES, start, DT)
    given: np.ndarray | float = 0.0
    if plant.transmission is not None:
        stiff, _ = with_effects(arm, effects, log, rigid=True)
        given = signal.sosfiltfilt(_LOW_PASS, u - stiff.torque(q, qd, qdd, start, DT), axis=0)
    motion = (q, qd, qdd)
    return Run(cut, motion, seen(motion, chain), in_log(u, chain), given)


def _shown(
    arm: Arm, effects: Sequence[Effect], log: str, motion: Motion, given: np.ndarray | float
) -> np.ndarray:
    """Torque (n, 6) that the log of an arm with these effects has along a motion that was seen."""
    plant, chain = with_effects(arm, effects, log, rigid=True)
    tau = plant.torque(*unseen(motion, chain), float(TIME[0]), DT)
    if with_effects(arm, effects, log)[0].transmission is not None:
        tau = tau + given
    return in_log(tau, chain)


def added_torques(arm: Arm, effects: Sequence[Effect], log: str, made: Run) -> list[np.ndarray]:
    """What each effect adds to the torque in the log, the others being there, (n, 6) at 250 Hz."""
    whole = _shown(arm, effects, log, made.seen, made.given)
    return [
        whole - _shown(arm, [e for e in effects if e is not one], log, made.seen, made.given)
        for one in effects
    ]


def friction_columns(arm: Arm, log: str, made: Run) -> np.ndarray:
    """Torque in the log per standard deviation of each number of an arm's friction, as `drawn_arm`
    draws it before there are effects: bend, static, Coulomb, viscous, Stribeck speed; of each
    joint, (n, 6, 30)."""
    changed = [arm, replace(arm, bend=arm.bend * np.exp(BEND_SIGMA))]
    for k in range(4):
        friction = arm.friction.copy()
        friction[:, k] *= 1 + FRICTION_SIGMA
        changed.append(replace(arm, friction=friction))
    plain, *found = [_shown(one, (), log, made.seen, 0.0) for one in changed]
    # a joint's friction is felt there alone
    return np.concatenate([(one - plain)[:, :, None] * np.eye(6) for one in found], axis=2)


def states_in_log(made: Run) -> np.ndarray:
    """q, qd, qdd (n, 18) at 250 Hz as the encoders show them."""
    return np.concatenate([x[SHOWN] for x in made.seen], axis=1)
