"""An effect as drawn: where it sits, what it changes at a size, what a size may be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .arm import Arm, Law, Transmission
from .sensors import Channel

Change = Law | Transmission | Channel | Callable[[Arm], Arm]
ALL = (1, 2, 3, 4, 5, 6)
IDENTIFICATION = "identification"
VALIDATION = "validation"


@dataclass
class Effect:
    """One effect; its size is searched for.

    Args:
        kind: its name.
        joint: 1-6, or None (whole arm).
        changes: of a size and a log.
        parameters: what it is at a size, in units of their names.
        low, high: sizes it may have.
        start: size to begin with; without one between low and high.
        kept: the start is its size.
        balances: its sign is to relieve the motor, mostly.
        closed: seen in a closed loop alone.
        most: share of the main joint's rms torque that is drawn up to.
    """

    kind: str
    joint: int | None
    changes: Callable[[float, str], Sequence[Change]]
    parameters: Callable[[float], dict[str, Any]]
    low: float
    high: float
    start: float | None = None
    kept: bool = False
    balances: bool = False
    closed: bool = False
    most: float = 0.15
    sign: float = field(default=1.0, init=False)
    size: float = field(init=False)

    def __post_init__(self) -> None:
        if self.start is None:
            self.start = float(np.sqrt(max(self.low, 1e-9) * self.high))
        self.size = self.start

    @property
    def signed_size(self) -> float:
        """With the sign that relieves the motor."""
        return self.size * self.sign

    def changes_in(self, log: str) -> Sequence[Change]:
        """At its size."""
        return self.changes(self.signed_size, log)

    def told(self) -> dict[str, Any]:
        """Its parameters at its size."""
        return self.parameters(self.signed_size)


@dataclass(frozen=True)
class Reach:
    """What the identification motion asks of the arm without effects, per joint (6,): rms and peak
    torque [Nm], least and largest angle [rad], rms speed [rad/s], smallest inertia [kg m2]."""

    rms: np.ndarray
    peak: np.ndarray
    low: np.ndarray
    high: np.ndarray
    speed: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True)
class Draw:
    """Draws the shape of one effect; the order of draws makes the arms of a seed."""

    rng: np.random.Generator
    reach: Reach
    kind: str
    wanted: int | None

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """Between the two."""
        return float(self.rng.uniform(low, high))

    def log_uniform(self, low: float, high: float) -> float:
        """Its logarithm between those of the two."""
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def maybe(self, chance: float, low: float, high: float, otherwise: float = 0.0) -> float:
        """Between the two in that share of the arms."""
        return self.uniform(low, high) if self.uniform() < chance else otherwise

    def sign(self, chance: float = 0.5) -> float:
        """1 in that share of the arms, else -1."""
        return 1.0 if self.uniform() < chance else -1.0

    def joint(self, among: Sequence[int] = ALL) -> int:
        """The one that is wanted, or one of them."""
        return int(self.rng.choice(among)) if self.wanted is None else self.wanted

    def law(self, joint: int, *numbers: float) -> list[Change]:
        """The C law of this kind on a joint (1-6)."""
        return [Law(self.kind, joint - 1, tuple(float(x) for x in numbers))]
