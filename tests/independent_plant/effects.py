"""Catalogue of what an arm may have: where it can sit, what it depends on, and how its shape is
drawn.

The laws themselves are in `csrc/effects.c` (forces) and `arm_changes.py` (arm, transmission,
measuring chain). They deliberately differ from a textbook's: second harmonics, cubic terms, odd
exponents, two-mass transmissions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .parameters import RANGES, SPEEDS

ALL = (1, 2, 3, 4, 5, 6)
Shape = Callable[[np.random.Generator, int, int], list[float]]  # (rng, joint, partner) -> p[1:]


@dataclass(frozen=True)
class Recipe:
    """One kind of effect.

    Args:
        where: "law" (C force), "arm", "transmission" or "chain".
        joints: joints (1-6) it may sit on; empty if it concerns the whole arm.
        signals: what its torque depends on; "partner:x" becomes the partner joint's signal, e.g.
            "qd4".
        shape: draws the law's parameters after its size.
        start: size to begin the search with; limit: largest plausible size, in the law's own unit.
        wrist: share of the limit that holds for axes 4-6.
        signed: whether the size may be negative.
        partners: joints that may be the partner.
    """

    where: str
    joints: tuple[int, ...]
    signals: tuple[str, ...]
    start: float
    limit: float
    shape: Shape = field(default=lambda rng, joint, partner: [])
    signed: bool = False
    partners: tuple[int, ...] = ()
    wrist: float = 1.0


def _middle(joint: int) -> float:
    return float(RANGES[joint - 1].mean())


def _half(joint: int) -> float:
    """Half of the range a motion really uses [rad]."""
    return 0.27 * float(np.ptp(RANGES[joint - 1]))


def _inside(rng: np.random.Generator, joint: int, share: float) -> float:
    return _middle(joint) + share * _half(joint) * rng.uniform(-1, 1)


def _ripple(rng: np.random.Generator, joint: int, _: int) -> list[float]:
    order = rng.uniform(8, 45) if joint <= 3 else rng.uniform(5, 25)
    return [order, rng.uniform(0, 6.28), rng.uniform(0.2, 0.4), rng.uniform(0, 6.28)]


def _cable(rng: np.random.Generator, joint: int, _: int) -> list[float]:
    return [_inside(rng, joint, 0.4), rng.uniform(0.05, 0.2) / _half(joint) ** 2]


def _hysteresis(rng: np.random.Generator, joint: int, _: int) -> list[float]:
    travel = np.radians(rng.uniform(0.4, 2.0))
    return [travel, 3 * travel, 8 * travel]


LIBRARY: dict[str, Recipe] = {
    "payload": Recipe("arm", (), ("q", "qdd"), 1.0, 12.0),
    "rotor_inertia": Recipe("arm", ALL, ("qdd",), 1.0, 30.0, wrist=0.1),
    "coulomb_asymmetry": Recipe(
        "law",
        ALL,
        ("sign_qd",),
        1.0,
        30.0,
        lambda r, j, k: [r.uniform(0.85, 1.2), r.uniform(0.85, 1.2)],
        signed=True,
    ),
    "coulomb_change": Recipe(
        "law",
        ALL,
        ("sign_qd",),
        1.0,
        40.0,
        lambda r, j, k: [r.uniform(0.0, 0.3), r.uniform(0.03, 0.2)],
    ),
    "viscous_change": Recipe(
        "law", ALL, ("qd",), 1.0, 60.0, lambda r, j, k: [r.uniform(0.85, 1.15)]
    ),
    "viscous_warmup": Recipe(
        "law",
        ALL,
        ("qd", "time"),
        1.0,
        60.0,
        lambda r, j, k: [r.uniform(0.9, 1.05), r.uniform(8, 40), r.uniform(1.0, 1.6)],
    ),
    "load_friction": Recipe(
        "law",
        (1, 2, 3, 4, 5),
        ("load", "sign_qd"),
        0.02,
        0.6,
        lambda r, j, k: [r.uniform(0.85, 1.1)],
    ),
    "hysteresis": Recipe("law", ALL, ("q", "qd"), 1.0, 60.0, _hysteresis),
    "gear_ripple": Recipe("law", ALL, ("q",), 1.0, 60.0, _ripple),
    "balancer": Recipe(
        "law",
        (2, 3),
        ("q",),
        100.0,
        3000.0,
        lambda r, j, k: [
            r.uniform(0.3, 0.6),
            r.uniform(0.4, 0.6),
            r.uniform(0.4, 1.0),
            r.uniform(-0.1, 0.1),
        ],
    ),
    "cable_spring": Recipe("law", (1, 3, 4, 5, 6), ("q",), 1.0, 200.0, _cable),
    "wrist_coupling": Recipe(
        "law",
        (4, 5),
        ("qd", "partner:qd"),
        1.0,
        60.0,
        lambda r, j, k: [
            r.uniform(0.3, 0.6) * r.choice([-1, 1]),
            r.uniform(0.03, 0.08),
            r.uniform(0.85, 1.0),
            j,
        ],
        partners=(5, 6),
    ),
    "torque_gain": Recipe("chain", ALL, ("load",), 0.05, 0.3, signed=True),
    "torque_offset": Recipe("chain", ALL, (), 1.0, 60.0, signed=True),
    "time_delay": Recipe("chain", (), ("qd",), 0.004, 0.04),
    "encoder_zero": Recipe("chain", (2, 3, 5), ("q",), 0.005, 0.04, signed=True),
    "elastic_joint": Recipe("transmission", ALL, ("qdd",), 0.3, 1.0),
    "transmission_backlash": Recipe("transmission", ALL, ("qd", "load"), 0.002, 0.02),
    "base_tilt": Recipe("arm", (), ("q",), 0.02, 0.1),
    "process_force": Recipe("law", (), ("q", "time"), 20.0, 400.0),
    "linkage_inertia": Recipe("arm", (3,), ("q", "qdd"), 2.0, 25.0),
    "link_inertia": Recipe("arm", (2, 3, 4), ("q", "qdd"), 1.0, 25.0),
}

OUTSIDE: dict[str, Recipe] = {
    "angle_product": Recipe(
        "law",
        ALL,
        ("q", "partner:q"),
        1.0,
        500.0,
        lambda r, j, k: [_inside(r, j, 0.2), _inside(r, k, 0.2), k - 1],
        signed=True,
        partners=ALL,
    ),
    "speed_bump": Recipe(
        "law",
        ALL,
        ("qd",),
        1.0,
        100.0,
        lambda r, j, k: [
            r.uniform(0.06, 0.14) * SPEEDS[j - 1],
            r.uniform(0.015, 0.04) * SPEEDS[j - 1],
        ],
    ),
    "sticky_window": Recipe(
        "law",
        ALL,
        ("q", "qd"),
        1.0,
        150.0,
        lambda r, j, k: [_inside(r, j, 0.5), r.uniform(0.1, 0.2) * _half(j)],
    ),
    "even_speed": Recipe("law", ALL, ("qd",), 1.0, 100.0, signed=True),
    "offset_drift": Recipe(
        "law", ALL, ("time",), 1.0, 100.0, lambda r, j, k: [r.uniform(6, 20)], signed=True
    ),
    "hum": Recipe(
        "law", ALL, ("time",), 1.0, 100.0, lambda r, j, k: [r.uniform(1.0, 6.0), r.uniform(0, 6.28)]
    ),
    "end_cushion": Recipe(
        "law",
        ALL,
        ("q",),
        10.0,
        3000.0,
        lambda r, j, k: [_inside(r, j, 0.2), r.uniform(0.45, 0.6) * _half(j)],
    ),
    "angle_speed": Recipe(
        "law", ALL, ("q", "qd"), 1.0, 300.0, lambda r, j, k: [_inside(r, j, 0.3)]
    ),
    "cross_speed": Recipe(
        "law",
        ALL,
        ("partner:qd",),
        1.0,
        100.0,
        lambda r, j, k: [0.0, 0.0, k - 1],
        signed=True,
        partners=ALL,
    ),
    "acceleration_square": Recipe("law", ALL, ("qdd",), 0.1, 100.0, signed=True),
}

KINDS: dict[str, Recipe] = LIBRARY | OUTSIDE

# Kinds that one motion of the bare arm can hardly tell apart; a truth is met by any of its group.
GROUPS: tuple[frozenset[str], ...] = (
    frozenset({"transmission_backlash", "encoder_zero"}),
    frozenset({"coulomb_asymmetry", "torque_offset"}),
    frozenset(
        {
            "torque_gain",
            "balancer",
            "link_inertia",
            "linkage_inertia",
            "payload",
            "encoder_zero",
            "base_tilt",
        }
    ),
    frozenset({"load_friction", "coulomb_change"}),
    frozenset({"rotor_inertia", "link_inertia", "linkage_inertia", "elastic_joint"}),
    frozenset({"viscous_change", "viscous_warmup", "viscous_power"}),
    frozenset({"hysteresis", "coulomb_change"}),
)


@dataclass(frozen=True)
class Effect:
    """An effect asked for.

    Args:
        kind: a key of `KINDS`.
        joint: 1-6; None leaves it to the draw, or to the whole arm.
        fraction: wanted rms torque over that of the joint (of the joint it moves most, if of the
            whole arm).
        on_at: time from which it acts [s].
    """

    kind: str
    joint: int | None = None
    fraction: float = 0.05
    on_at: float = -np.inf

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"unknown effect {self.kind!r}; known are {', '.join(KINDS)}")
        joints = KINDS[self.kind].joints
        if self.joint is not None and self.joint not in joints:
            raise ValueError(
                f"{self.kind} sits on joints {joints or 'of the whole arm'}, not on {self.joint}"
            )


@dataclass(frozen=True)
class Drawn:
    """An effect with everything drawn but its size: sign, joint, partner, shape, spare random
    numbers."""

    effect: Effect
    joint: int | None
    partner: int | None
    sign: float
    shape: tuple[float, ...]
    spare: tuple[float, ...]

    @property
    def recipe(self) -> Recipe:
        return KINDS[self.effect.kind]

    @property
    def limit(self) -> float:
        """Largest plausible size on this joint."""
        return self.recipe.limit * (self.recipe.wrist if self.joint and self.joint > 3 else 1.0)

    @property
    def signals(self) -> tuple[str, ...]:
        """Signals of the joint itself by bare name, a partner's with its number."""
        return tuple(
            s.replace("partner:", "") + (str(self.partner) if "partner" in s else "")
            for s in self.recipe.signals
        )


def draw(effect: Effect, rng: np.random.Generator) -> Drawn:
    """Fix everything about an effect but its size."""
    recipe = KINDS[effect.kind]
    joint = effect.joint
    if joint is None and recipe.joints:
        joint = int(rng.choice(recipe.joints))
    partner: int | None = None
    if effect.kind == "wrist_coupling":
        assert joint is not None
        partner = joint + 1
    elif recipe.partners:
        partner = int(rng.choice([k for k in recipe.partners if k != joint]))
    sign = float(rng.choice([-1.0, 1.0])) if recipe.signed else 1.0
    shape = recipe.shape(rng, joint or 1, partner or 1)
    return Drawn(
        effect, joint, partner, sign, tuple(map(float, shape)), tuple(rng.uniform(-1, 1, 6))
    )
