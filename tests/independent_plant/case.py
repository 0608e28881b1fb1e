"""One test case: an arm nobody has seen, its effects, two recorded motions, and the truth about them."""

from __future__ import annotations

import gzip
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from . import arm_changes, motion, native
from .effects import LIBRARY, Drawn, Effect, draw
from .parameters import Servo, drawn_arm
from .sensors import Sensors

HEADER = ",".join(
    ["time_s"]
    + [f"{name}{i}{unit}" for name, unit in (("q", "_deg"), ("qd", "_deg_s"), ("tau", "_Nm"), ("q", "_ref_deg")) for i in range(1, 7)]
)
DIGITS = [4] + [5] * 6 + [4] * 6 + [3] * 6 + [5] * 6


@dataclass(frozen=True)
class Log:
    """A recorded motion; arrays (n,) or (n, 6), SI and radians."""

    time: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    tau: np.ndarray
    q_ref: np.ndarray

    def table(self) -> np.ndarray:
        """Columns of the log format, (n, 25)."""
        d = np.degrees
        return np.column_stack([self.time, d(self.q), d(self.qd), self.tau, d(self.q_ref)])

    def write_csv(self, path: str | Path, reference: bool = True) -> Path:
        """Write as `.csv` or `.csv.gz`, without the commanded positions if asked."""
        path = Path(path)
        columns = 25 if reference else 19
        lines = [",".join(HEADER.split(",")[:columns])]
        form = ",".join(f"%.{k}f" for k in DIGITS[:columns])
        lines += [form % tuple(row) for row in self.table()[:, :columns]]
        text = ("\n".join(lines) + "\n").encode()
        path.write_bytes(gzip.compress(text, 4, mtime=0) if path.suffix == ".gz" else text)
        return path


@dataclass(frozen=True)
class TrueEffect:
    """What is really there.

    Args:
        kind, joint: the name; joint is 1-6 or None (whole arm).
        signals: what its torque depends on: q, qd, sign_qd, qdd, load, time of the joint; "q4", "qd4" of another.
        fractions: rms of its torque over the rms torque of each joint during identification, (6,).
        size: in the law's own unit.
        in_library: whether the library is expected to know the kind.
        on_at: time from which it acts [s].
    """

    kind: str
    joint: int | None
    signals: tuple[str, ...]
    fractions: tuple[float, ...]
    size: float
    in_library: bool
    on_at: float

    @property
    def main_joint(self) -> int:
        """The joint it sits on, or whose torque it changes most."""
        return self.joint or int(np.argmax(self.fractions)) + 1

    @property
    def fraction(self) -> float:
        return self.fractions[self.main_joint - 1]


@dataclass(frozen=True)
class _Scene:
    """Drawn effects with their sizes, ready for the C plant."""

    sized: tuple[tuple[Drawn, float], ...] = ()


@dataclass(frozen=True)
class Case:
    """An arm with effects.

    Args:
        seed: everything random follows from it; the arm, its motions and noise do not depend on the effects.
        effects: what it has beyond rigid bodies and paper friction.
        duration, validation_duration: of the recorded motions [s].
        spread: times the data-sheet uncertainty of the base parameters (1: as the priors say).
        idle: axes (1-6) that rest during identification.
        chirp: a 0.6-7 Hz chirp on top of the identification motion.
        sensors: noise, quantisation, lost samples.
        name: for tables.
    """

    seed: int
    effects: tuple[Effect, ...] = ()
    duration: float = 40.0
    validation_duration: float = 30.0
    spread: float = 1.0
    idle: tuple[int, ...] = ()
    chirp: bool = False
    sensors: Sensors = field(default_factory=Sensors)
    name: str = ""

    def _rng(self, what: str) -> np.random.Generator:
        return np.random.default_rng([self.seed, *what.encode()])

    @cached_property
    def _arm(self):  # type: ignore[no-untyped-def]
        return drawn_arm(self._rng("arm"), self.spread)

    @cached_property
    def _servo(self) -> Servo:
        return Servo.drawn(self._rng("servo"), self._arm[0])

    @cached_property
    def _motions(self) -> tuple[motion.Motion, motion.Motion]:
        first = motion.identification(self._rng("identification"), self.duration, self.idle, self.chirp)
        return first, motion.validation(self._rng("validation"), self.validation_duration)

    def _plant(self, scene: _Scene) -> tuple[np.ndarray, np.ndarray]:
        """The C structures: plant and effects."""
        before, friction = self._arm
        after, change_at, zero, transmission, laws = before, -np.inf, np.zeros(6), arm_changes.RIGID, []
        for drawn, size in scene.sized:
            kind, joint = drawn.effect.kind, (drawn.joint or 1) - 1
            if drawn.recipe.where == "arm":
                after, change_at = arm_changes.changed_arm(after, drawn, size), drawn.effect.on_at
            elif drawn.recipe.where == "transmission":
                transmission = arm_changes.transmission(before, drawn, size)
            elif kind == "encoder_zero":
                zero = zero.copy()
                zero[joint] = size
            elif kind == "process_force":
                laws.append(_process_force(drawn, size))
            elif drawn.recipe.where == "law":
                p = [size, *drawn.shape]
                laws.append([native.law_index()[kind], joint, drawn.effect.on_at, *p, *[0.0] * (8 - len(p))])
        parts = [before.packed(), after.packed(), [change_at], friction.ravel(), self._servo.table.ravel(), zero, transmission]
        return np.concatenate(parts), np.array(laws, dtype=float).reshape(-1, 11)

    def _closed_loop(self, scene: _Scene, move: motion.Motion) -> tuple[np.ndarray, np.ndarray]:
        """Times and record (q, qd, reported torque) at 1 kHz, free of noise, without the run-up."""
        record = native.follow(*self._plant(scene), move.start - move.lead, move.q)
        time = move.start - move.lead + np.arange(len(record)) / native.RECORD_RATE
        for drawn, size in scene.sized:
            if drawn.recipe.where == "chain":
                record[:, 12:] = arm_changes.measured_torque(time, record[:, 12:], drawn, size)
        skip = round(move.lead * native.RECORD_RATE)
        return time[skip:], record[skip:]

    def _asked_torque(self, scene: _Scene) -> np.ndarray:
        """Torque (n, 6) that the commanded identification motion asks for."""
        dt, moving = self._motions[0].with_derivatives()
        tau = native.prescribed(*self._plant(scene), 0.0, dt, moving)
        for drawn, size in scene.sized:
            if drawn.recipe.where == "chain":
                tau = arm_changes.measured_torque(dt * np.arange(len(tau)), tau, drawn, size)
        return tau

    def _fractions(self, drawn: Drawn, size: float, base: np.ndarray) -> np.ndarray:
        """Rms torque of an effect over the rms torque of each joint."""
        scene = _Scene(((drawn, size),))
        if drawn.recipe.where == "transmission":
            tau = self._closed_loop(scene, self._motions[0])[1][:, 12:]
        else:
            tau = self._asked_torque(scene)
        return np.sqrt(((tau - base) ** 2).mean(0) / (base**2).mean(0))

    def _sized(self, drawn: Drawn) -> tuple[Drawn, float, np.ndarray]:
        """Search the size whose torque has the wanted fraction, within what is plausible."""
        from dataclasses import replace

        always = replace(drawn, effect=replace(drawn.effect, on_at=-np.inf))
        nothing = _Scene()
        if drawn.recipe.where == "transmission":
            base = self._closed_loop(nothing, self._motions[0])[1][:, 12:]
        else:
            base = self._asked_torque(nothing)
        size, limit = drawn.sign * drawn.recipe.start, drawn.recipe.limit
        fractions = self._fractions(always, size, base)
        for _ in range(4):
            got = fractions[drawn.joint - 1] if drawn.joint else fractions.max()
            if abs(got / drawn.effect.fraction - 1) < 0.05:
                break
            next_size = float(np.clip(size * drawn.effect.fraction / max(got, 1e-9), -limit, limit))
            if next_size == size:
                break
            size = next_size
            fractions = self._fractions(always, size, base)
        return drawn, size, fractions

    @cached_property
    def _found(self) -> list[tuple[Drawn, float, np.ndarray]]:
        rng = self._rng("effects")
        return [self._sized(draw(effect, rng)) for effect in self.effects]

    @cached_property
    def truth(self) -> tuple[TrueEffect, ...]:
        """What this arm has, with the sizes it really came to."""
        return tuple(
            TrueEffect(
                d.effect.kind, d.joint, d.signals, tuple(map(float, f)), size, d.effect.kind in LIBRARY, d.effect.on_at
            )
            for d, size, f in self._found
        )

    def simulate(self) -> tuple[Log, Log]:
        """The identification and the validation log."""
        scene = _Scene(tuple((d, size) for d, size, _ in self._found))
        logs = []
        for move, what in zip(self._motions, ("noise", "more noise"), strict=True):
            time, record = self._closed_loop(scene, move)
            skip = round(move.lead * native.RECORD_RATE)
            kept = self.sensors.read(self._rng(what), time, record, move.q[skip:])
            logs.append(Log(*kept))
        return logs[0], logs[1]


def _process_force(drawn: Drawn, size: float) -> list[float]:
    a, b, c, d, e, f = drawn.spare
    direction = np.array([a, b, c]) / np.linalg.norm([a, b, c])
    cuts = [9.0 + 2 * d, 3.5 + e, 4.0 + f, 0.15]
    return [native.law_index()["process_force"], 0, drawn.effect.on_at, *(size * direction), *cuts, 0.0]
