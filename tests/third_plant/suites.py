"""Which arms a seed has: four suites, their effects, the joints to try, what their logs show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import arm_laws, chain_laws, force_laws, friction_laws, outside_laws
from .effect import ALL

FIRST_SEED = 772397595
"""that of the first blind logs"""
SUITES = ("clean", "single", "pairs", "outside")
CLEAN = 12
PAIRS = 12
_LAWS = [
    arm_laws.payload,
    arm_laws.rotor_inertia,
    friction_laws.coulomb_asymmetry,
    friction_laws.coulomb_change,
    friction_laws.viscous_change,
    friction_laws.viscous_warmup,
    friction_laws.load_friction,
    friction_laws.hysteresis,
    force_laws.gear_ripple,
    force_laws.balancer,
    force_laws.cable_spring,
    force_laws.wrist_coupling,
    chain_laws.torque_gain,
    chain_laws.torque_offset,
    chain_laws.time_delay,
    arm_laws.elastic_joint,
    arm_laws.transmission_backlash,
    arm_laws.base_tilt,
    force_laws.process_force,
    arm_laws.link_inertia,
    chain_laws.encoder_zero,
    friction_laws.viscous_power,
]
_TWICE = [
    outside_laws.brake_drag,
    outside_laws.motor_saturation,
    outside_laws.friction_zone,
    outside_laws.soft_stop,
    outside_laws.sloshing_tool,
    outside_laws.parallelogram_friction,
]
_ONCE = [
    outside_laws.spindle_gyro,
    outside_laws.torque_drift,
    outside_laws.sample_hold,
    outside_laws.spindle_unbalance,
]
LIBRARY = {law.__name__: law for law in _LAWS}
OUTSIDE = {law.__name__: law for law in [*_TWICE, *_ONCE]}
KINDS = LIBRARY | OUTSIDE
WHOLE = {"payload", "base_tilt", "process_force", "link_inertia"}
SPRINGS = {"elastic_joint", "transmission_backlash"}
"""the plant has one"""
JOINTS: dict[str, tuple[int, ...]] = {
    "balancer": (2, 3),
    "cable_spring": (4, 5, 6),
    "wrist_coupling": (5, 6),
    "transmission_backlash": (1, 4, 5, 6),
    "encoder_zero": (2, 3, 4, 5),
    "soft_stop": (1, 2, 3, 4, 5),
    "parallelogram_friction": (3,),
}


@dataclass(frozen=True)
class Planned:
    """One arm of a seed.

    Args:
        seed, index: its draws follow from them.
        suite, number: its name.
        kinds: of its effects; joints: to try first (1-6).
        has_speed, has_reference, coloured: columns of its logs, noise of first order in them.
    """

    seed: int
    index: int
    suite: str
    number: int
    kinds: tuple[str, ...]
    joints: tuple[int, ...]
    has_speed: bool
    has_reference: bool
    coloured: bool

    @property
    def name(self) -> str:
        """As in tables."""
        return f"{self.suite}/{self.number}"


def _pairs(rng: np.random.Generator) -> list[tuple[str, ...]]:
    kinds = [kind for kind in LIBRARY if kind not in WHOLE]
    pool = [str(k) for k in rng.permutation(kinds)]
    pool += [str(k) for k in rng.permutation(kinds)]
    pairs: list[tuple[str, ...]] = []
    while len(pairs) < PAIRS:
        one = pool.pop(0)
        other = next(k for k in pool if k != one and not {one, k} <= SPRINGS)
        pool.remove(other)
        pairs.append((one, other))
    return pairs


def _joints(rng: np.random.Generator, arms: list[tuple[str, ...]]) -> list[tuple[int, ...]]:
    """In turn, so that two arms of one kind do not have it on the same joint."""
    left: dict[str, list[int]] = {}
    found = []
    for kinds in arms:
        mine = []
        for kind in kinds:
            turn = left.setdefault(kind, [])
            if not turn:
                turn.extend(int(j) for j in rng.permutation(JOINTS.get(kind, ALL)))
            mine.append(turn.pop())
        found.append(tuple(mine))
    return found


def plan(seed: int) -> list[Planned]:
    """All arms of a seed: 12 clean, 44 with one effect, 12 with two, 16 with one from outside. Of
    each suite half have speeds, three quarters the commanded motion, a third coloured noise."""
    rng = np.random.default_rng([seed, 999])
    single = list(LIBRARY) * 2
    rng.shuffle(single)
    pairs = _pairs(rng)
    outside = [law.__name__ for law in [*_TWICE, *_TWICE, *_ONCE]]
    rng.shuffle(outside)
    kinds: dict[str, list[tuple[str, ...]]] = {
        "clean": [()] * CLEAN,
        "single": [(k,) for k in single],
        "pairs": pairs,
        "outside": [(k,) for k in outside],
    }
    joints = _joints(rng, [one for arms in kinds.values() for one in arms])
    names = [(suite, i, k) for suite, arms in kinds.items() for i, k in enumerate(arms)]
    flags = np.zeros((len(names), 3), dtype=bool)
    for suite in SUITES:
        mine = np.array([i for i, one in enumerate(names) if one[0] == suite])
        for column, count in enumerate((len(mine) // 2, 3 * len(mine) // 4, len(mine) // 3)):
            flags[rng.permutation(mine)[:count], column] = True
    return [
        Planned(seed, index, *name, joints[index], *(bool(f) for f in flags[index]))
        for index, name in enumerate(names)
    ]
