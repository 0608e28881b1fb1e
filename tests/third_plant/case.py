"""One arm of a seed: its numbers, effects and motions, its two logs, the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from independent_plant.visibility import beyond_base

from .arm import RANGES, SPEEDS, Arm, drawn_arm
from .drives import (
    Run,
    Servo,
    added_torques,
    friction_columns,
    rms,
    run,
    smoothed,
    states_in_log,
)
from .effect import IDENTIFICATION, VALIDATION, Effect, Reach
from .excitation import excitation
from .log import Log, Reading
from .moves import moves
from .sensors import FIRST, RATE
from .sizing import Bench, drawn_effects
from .suites import Planned
from .truth import Truth, in_library_terms

TRIES = 6
SLOWER = 0.88
POSES = slice(None, None, 400)
"""of a motion, at which inertias are looked at"""


@dataclass(frozen=True)
class Made:
    """All that a seed makes of an arm: commands as the controller gives them (m, 18), runs along
    them, conditions of the logs."""

    arm: Arm
    effects: list[Effect]
    commands: tuple[np.ndarray, np.ndarray]
    runs: tuple[Run, Run]
    reading: Reading
    logs: tuple[str, str]


def _inertias(arm: Arm, command: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest inertia that each motor feels with the other joints free, and the median one with
    them held, (6,)."""
    masses = np.array([arm.mass_matrix(q) for q in command[POSES, :6]])
    free = (1 / np.array([np.diag(np.linalg.inv(m)) for m in masses])).min(0)
    held = np.median(np.array([np.diag(m) for m in masses]), 0)
    return free, held


def _reach(command: np.ndarray, plain: Run, inertia: np.ndarray) -> Reach:
    q = command[:, :6]
    peak = np.abs(plain.tau).max(0)
    speed = rms(command[:, 6:12])
    return Reach(rms(plain.tau), peak, q.min(0), q.max(0), speed, inertia)


def _is_over(made: Run) -> bool:
    """Beyond what drives, speeds or ranges allow."""
    q = made.seen[0][FIRST:]
    beyond = (q < RANGES[:, 0]).any() or (q > RANGES[:, 1]).any()
    return bool(made.cut > 0 or (np.abs(made.motion[1][FIRST:]) > SPEEDS).any() or beyond)


@dataclass(frozen=True)
class Case:
    """One arm; everything random follows from its seed and index."""

    planned: Planned

    @property
    def name(self) -> str:
        """As in tables."""
        return self.planned.name

    @cached_property
    def made(self) -> Made:
        """Arm, effects and logs, drawn until both motions are within the limits.

        Raises:
            RuntimeError: they never are, or an effect finds no size.
        """
        planned = self.planned
        rng = np.random.default_rng([planned.seed, planned.index])
        arm = drawn_arm(rng)
        servo = Servo.drawn(rng)
        scale = 1.0
        for _ in range(TRIES):
            commands = (excitation(rng, scale), moves(rng, scale))
            if not all(arm.is_possible(command[POSES, :6]) for command in commands):
                arm = drawn_arm(rng)
                continue
            free, held = _inertias(arm, commands[0])
            bristles = np.sqrt(arm.friction[:, 1] / arm.bend * free)
            arm = replace(arm, damping=0.35 * bristles)
            gains = servo.gains(held)
            asked, asked_later = (smoothed(command, *servo.filter) for command in commands)
            plain = run(arm, [], IDENTIFICATION, asked, gains)
            bench = Bench(arm, asked, gains, plain)
            effects = drawn_effects(planned, bench, _reach(commands[0], plain, free), rng)
            first = run(arm, effects, IDENTIFICATION, asked, gains)
            second = run(arm, effects, VALIDATION, asked_later, gains)
            if _is_over(first) or _is_over(second):
                scale *= SLOWER
                continue
            flags = (planned.coloured, planned.has_speed, planned.has_reference)
            reading = Reading.drawn(rng, np.abs(first.tau).max(0), *flags)
            runs = (first, second)
            logs = (
                reading.written(rng, first, commands[0]),
                reading.written(rng, second, commands[1]),
            )
            return Made(arm, effects, commands, runs, reading, logs)
        raise RuntimeError(f"{self.name}: never within the limits in {TRIES} draws")

    @cached_property
    def effect_torques(self) -> list[np.ndarray]:
        """What each effect adds to the identification log's torque, (n, 6) at 250 Hz."""
        made = self.made
        return added_torques(made.arm, made.effects, IDENTIFICATION, made.runs[0])

    def identification(self) -> Log:
        """The first log."""
        return Log.read(self.made.logs[0])

    def validation(self) -> Log:
        """The second."""
        return Log.read(self.made.logs[1])

    @cached_property
    def truth(self) -> tuple[Truth, ...]:
        """What this arm has."""
        made = self.made
        first = made.runs[0]
        pairs = zip(made.effects, self.effect_torques, strict=True)
        entries = [entry for one in pairs for entry in in_library_terms(*one)]
        errors = made.reading.torque_errors(np.random.default_rng(0), 20000)
        torques = [entry.torque for entry in entries]
        friction = friction_columns(made.arm, IDENTIFICATION, first)
        states = states_in_log(first)
        found = beyond_base(states, 1 / RATE, errors, first.tau, torques, friction=friction)
        strengths = [strength for _, strength in found]
        return tuple(
            Truth.of(entry, rms(entry.torque) / rms(first.tau), strength)
            for entry, strength in zip(entries, strengths, strict=True)
        )

    def told(self) -> list[dict[str, Any]]:
        """Effects in this plant's own terms: kind, joint, parameters, rms torque (6,) [Nm]."""
        return [
            {
                "kind": effect.kind,
                "joint": effect.joint,
                "parameters": effect.told(),
                "rms_Nm": rms(torque).tolist(),
            }
            for effect, torque in zip(self.made.effects, self.effect_torques, strict=True)
        ]
