"""One test case: an arm of the second plant, its effects, the conditions of its log, the truth."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from independent_plant import Log
from independent_plant.machine import below_10_hz
from independent_plant.motion import Motion, identification
from independent_plant.parameters import drawn_arm
from independent_plant.visibility import beyond_base

from .machine import RATE, Machine
from .present import STREAM, Present, Wanted, draw, force_torque, reported, with_effect
from .reading import Reading

SMALL = 0.02
"""rms torque over the joint's that an effect is to have at least, if it can"""


@dataclass(frozen=True)
class Truth:
    """What is there: kind, joint, size, rms torque over the joint's (6,), torque (n, 6) at
    `STREAM`, and how many standard deviations it stands out of noise and data sheet."""

    kind: str
    joint: int | None
    size: float
    fractions: np.ndarray
    strength: float
    in_library: bool

    @property
    def main_joint(self) -> int:
        """The joint it sits on, or moves most."""
        return self.joint or int(np.argmax(self.fractions)) + 1


@dataclass(frozen=True)
class Case:
    """An arm with effects; everything random follows from the seed, arm and motion not from the
    effects.

    Args:
        effects: beyond rigid bodies and friction.
        duration: of the log [s].
        chirp: a 0.6-7 Hz chirp on the motion.
        reading: the conditions of the log.
        friction_scale: all friction times this: a cold arm, a warm one.
        spread: times the data-sheet uncertainty by which the arm is off the paper.
    """

    seed: int
    effects: tuple[Wanted, ...] = ()
    duration: float = 30.0
    chirp: bool = False
    reading: Reading = field(default_factory=Reading)
    friction_scale: float = 1.0
    spread: float = 1.0
    name: str = ""

    def _rng(self, what: str) -> np.random.Generator:
        return np.random.default_rng([self.seed, *what.encode()])

    @cached_property
    def machine(self) -> Machine:
        """Arm and drives without effects."""
        arm, friction = drawn_arm(self._rng("arm"), self.spread)
        friction[:, :3] *= self.friction_scale
        return Machine.drawn(self._rng("drives"), arm, friction)

    @cached_property
    def motion(self) -> Motion:
        """What is commanded."""
        return identification(self._rng("motion"), self.duration, chirp=self.chirp)

    @cached_property
    def moving(self) -> np.ndarray:
        """The commanded q, qd, qdd at `STREAM`, (n, 18)."""
        return self.motion.with_derivatives(round(RATE / STREAM))[1]

    @cached_property
    def plain_torque(self) -> np.ndarray:
        """What the motion asks of the arm without effects, (n, 6)."""
        q, qd, qdd = np.split(self.moving, 3, axis=1)
        return self.machine.rigid_torque(q, qd, qdd) + self.machine.friction_torque(qd)

    def torque_of(self, effect: Present, size: float) -> np.ndarray:
        """What an effect adds along the commanded motion, (n, 6)."""
        q, qd, qdd = np.split(self.moving, 3, axis=1)
        where = effect.recipe.where
        if where == "force":
            return force_torque(self.machine, effect, size, self.moving, self.plain_torque)
        if where == "chain":
            time = np.arange(len(q)) / STREAM
            return reported(time, self.plain_torque, effect, size) - self.plain_torque
        if where == "transmission":
            return self._unexplained(with_effect(self.machine, effect, size))
        plain = self.plain_torque - self.machine.friction_torque(qd)
        if where == "zero":
            shift = size * np.eye(6)[effect.index]
            return self.machine.rigid_torque(q - shift, qd, qdd) - plain
        return with_effect(self.machine, effect, size).rigid_torque(q, qd, qdd) - plain

    def _unexplained(self, machine: Machine) -> np.ndarray:
        """Torque less what the plain arm needs for the motion made, 0 near rest, below 10 Hz."""
        lead = round(self.motion.lead * RATE)
        record = machine.closed_loop([], self.motion.q, -self.motion.lead)[lead:]
        rates = np.gradient(record[:, 6:12], 1 / RATE, axis=0)
        every = slice(None, None, round(RATE / STREAM))
        q, qd, tau = np.split(record[every], 3, axis=1)
        needed = self.machine.rigid_torque(q, qd, rates[every]) + self.machine.friction_torque(qd)
        left = np.where(np.abs(qd) < 0.05, 0.0, tau - needed)
        return below_10_hz(left)[: len(self.moving)]

    def _sized(self, effect: Present, wanted: Wanted) -> tuple[float, np.ndarray]:
        """Size and torque: as asked, or searched for the wanted share within what is plausible."""
        if wanted.size is not None or effect.recipe.where == "transmission":
            size = wanted.size
            if size is None:
                size = effect.recipe.start * 10 ** (0.4 * effect.spare[2])
            return size, self.torque_of(effect, size)
        size = effect.sign * effect.recipe.start
        torque = self.torque_of(effect, size)
        for _ in range(3):
            shares = self._shares(torque)
            got = shares[effect.index] if effect.joint else shares.max()
            limit = effect.limit
            better = float(np.clip(size * wanted.fraction / max(got, 1e-9), -limit, limit))
            if abs(better / size - 1) < 0.05:
                break
            size = better
            torque = self.torque_of(effect, size)
        return size, torque

    def _shares(self, torque: np.ndarray) -> np.ndarray:
        return np.sqrt((torque**2).mean(axis=0) / (self.plain_torque**2).mean(axis=0))

    @cached_property
    def present(self) -> tuple[tuple[Present, float, np.ndarray], ...]:
        """Effects with shape, size and torque; drawn anew where the motion does not reach them."""
        rng = self._rng("effects")
        found = []
        for wanted in self.effects:
            tries: list[tuple[Present, float, np.ndarray]] = []
            for _ in range(4):
                effect = draw(wanted, rng)
                tries.append((effect, *self._sized(effect, wanted)))
                share = self._shares(tries[-1][2]).max()
                if wanted.size is not None or share > max(0.6 * wanted.fraction, SMALL / 2):
                    break
            found.append(max(tries, key=lambda one: float(self._shares(one[2]).max())))
        return tuple(found)

    @cached_property
    def truth(self) -> tuple[Truth, ...]:
        """What this arm has."""
        torques = [torque for _, _, torque in self.present]
        errors = Reading().torque_errors(np.random.default_rng(0), 20000)
        strengths = beyond_base(self.moving, 1 / STREAM, errors, self.plain_torque, torques)
        return tuple(
            Truth(e.kind, e.joint, size, self._shares(torque), strength, e.in_library)
            for (e, size, torque), (_, strength) in zip(self.present, strengths, strict=True)
        )

    def simulate(self) -> Log:
        """The log of the identification motion."""
        machine = self.machine
        laws = []
        shift = np.zeros(6)
        for effect, size, _ in self.present:
            machine = with_effect(machine, effect, size)
            if effect.recipe.where == "zero":
                shift[effect.index] = size
            elif effect.make is not None and effect.poles is None:
                laws.append(effect.make(size))
        record = machine.closed_loop(laws, self.motion.q - shift, -self.motion.lead)
        record[:, :6] += shift
        time = np.arange(len(record)) / RATE - self.motion.lead
        for effect, size, _ in self.present:
            if effect.recipe.where == "chain":
                record[:, 12:] = reported(time, record[:, 12:], effect, size)
        skip = round(self.motion.lead * RATE)
        asked = self.motion.q[: len(record)]
        return self.reading.read(self._rng("noise"), time[skip:], record[skip:], asked[skip:])

    def named(self, name: str) -> Case:
        """The same under another name."""
        return replace(self, name=name)
