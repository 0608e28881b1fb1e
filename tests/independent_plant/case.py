"""One test case: an arm nobody has seen, its effects, two recorded motions, and the truth about
them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from . import native
from .effects import LIBRARY, Drawn, Effect, draw
from .log import Log
from .machine import STREAM, Driven, Machine
from .motion import Motion, identification, validation
from .parameters import Servo, drawn_arm
from .sensors import Sensors


@dataclass(frozen=True)
class TrueEffect:
    """What is really there.

    Args:
        kind, joint: the name; joint is 1-6 or None (whole arm).
        signals: what its torque depends on: q, qd, sign_qd, qdd, load of the joint, time; "q4",
            "qd4" of another.
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
        """Its size at the main joint; less than was asked for where that was beyond what is
        plausible."""
        return self.fractions[self.main_joint - 1]


def _rng(seed: int, what: str) -> np.random.Generator:
    return np.random.default_rng([seed, *what.encode()])


@lru_cache(maxsize=8)  # only the latest: a list of hundreds of cases is not to hold all of theirs
def _motions(
    seed: int, duration: float, validation_duration: float, idle: tuple[int, ...], chirp: bool
) -> tuple[Motion, Motion]:
    first = identification(_rng(seed, "identification"), duration, idle, chirp)
    return first, validation(_rng(seed, "validation"), validation_duration)


@dataclass(frozen=True)
class Case:
    """An arm with effects.

    Args:
        seed: everything random follows from it; arm, motions and noise do not depend on the
            effects.
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
        return _rng(self.seed, what)

    @cached_property
    def machine(self) -> Machine:
        """The arm and its drives, without effects."""
        arm, friction = drawn_arm(self._rng("arm"), self.spread)
        return Machine(arm, friction, Servo.drawn(self._rng("servo"), arm))

    @property
    def motions(self) -> tuple[Motion, Motion]:
        """Commanded identification and validation motion."""
        return _motions(self.seed, self.duration, self.validation_duration, self.idle, self.chirp)

    @cached_property
    def plain_torque(self) -> np.ndarray:
        """What the identification motion asks of the arm without effects, (n, 6) at 250 Hz."""
        return self.machine.asked_torque((), *self.motions[0].with_derivatives(STREAM))

    def effect_torque(self, drawn: Drawn, size: float) -> np.ndarray:
        """What an effect, on from the beginning, adds to the torques of the identification, (n, 6)
        at 250 Hz."""
        always = ((replace(drawn, effect=replace(drawn.effect, on_at=-np.inf)), size),)
        if drawn.recipe.where == "transmission":
            return self.machine.unexplained_torque(always, self.motions[0])[
                : len(self.plain_torque)
            ]
        asked = self.machine.asked_torque(always, *self.motions[0].with_derivatives(STREAM))
        return np.asarray(asked - self.plain_torque)

    def _fractions(self, drawn: Drawn, size: float) -> np.ndarray:
        power, total = (
            (x**2).mean(axis=0) for x in (self.effect_torque(drawn, size), self.plain_torque)
        )
        return np.asarray(np.sqrt(power / total))

    def _with_size(self, drawn: Drawn) -> tuple[Drawn, float, np.ndarray]:
        """Search the size whose torque has the wanted fraction, within what is plausible."""
        size = drawn.sign * drawn.recipe.start
        limit = drawn.limit
        fractions = self._fractions(drawn, size)
        for _ in range(5):
            got = fractions[drawn.joint - 1] if drawn.joint else fractions.max()
            next_size = float(np.clip(size * drawn.effect.fraction / max(got, 1e-9), -limit, limit))
            if abs(next_size / size - 1) < 0.05:
                break
            size = next_size
            fractions = self._fractions(drawn, size)
        return drawn, size, fractions

    @cached_property
    def sized_effects(self) -> tuple[tuple[Drawn, float, np.ndarray], ...]:
        """Effects with everything drawn, their sizes, and their torque as a fraction of each
        joint's (6,)."""
        rng = self._rng("effects")
        return tuple(self._drawn_and_sized(effect, rng) for effect in self.effects)

    def _drawn_and_sized(
        self, effect: Effect, rng: np.random.Generator
    ) -> tuple[Drawn, float, np.ndarray]:
        """Draw anew, a few times, where the motion does not reach what was drawn (a cushion, a
        window)."""
        best = self._with_size(draw(effect, rng))
        for _ in range(0 if best[0].recipe.where == "transmission" else 6):
            if best[2].max() > 0.7 * effect.fraction:
                break
            best = max(
                best, self._with_size(draw(effect, rng)), key=lambda found: float(found[2].max())
            )
        return best

    @cached_property
    def truth(self) -> tuple[TrueEffect, ...]:
        """What this arm has, with the sizes it really came to."""
        return tuple(
            TrueEffect(
                d.effect.kind,
                d.joint,
                d.signals,
                tuple(map(float, f)),
                size,
                d.effect.kind in LIBRARY,
                d.effect.on_at,
            )
            for d, size, f in self.sized_effects
        )

    def simulate(self, commanded: Motion | None = None) -> tuple[Log, Log]:
        """The identification and the validation log; `commanded` replaces the motion of the first,
        not the effects."""
        return self.recorded(0, commanded), self.recorded(1)

    def recorded(self, which: int, commanded: Motion | None = None) -> Log:
        """The identification log (0) or the validation log (1) alone, as of `simulate`."""
        move = self.motions[which] if commanded is None else commanded
        noise = self._rng(("noise", "more noise")[which])
        effects = tuple((drawn, size) for drawn, size, _ in self.sized_effects)
        return self._read(noise, *self.machine.closed_loop(effects, move), move)

    def drive(self, drive: native.Drive) -> Driven:
        """The validation motion made by somebody's controller instead of the arm's own servo."""
        effects = tuple((drawn, size) for drawn, size, _ in self.sized_effects)
        return self.machine.driven(effects, self.motions[1], drive)

    def _read(
        self, rng: np.random.Generator, time: np.ndarray, record: np.ndarray, move: Motion
    ) -> Log:
        skip = round(move.lead * native.RECORD_RATE)
        return Log(*self.sensors.read(rng, time, record, move.q[skip:]))
