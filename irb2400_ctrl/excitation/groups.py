"""Ambiguity groups: which effects look alike, of what size they are imagined, what to measure where
no motion helps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError

Place = tuple[str, int | None]
"""kind of an effect and its joint (from 1; None: the whole arm)"""

LOOKALIKES: dict[str, tuple[str, ...]] = {
    "base": ("encoder_zero", "payload"),
    "coupling": ("viscous_change", "rotor_inertia"),
    "delay": ("viscous_change", "rotor_inertia"),
    "dynamic": ("rotor_inertia", "time_delay", "transmission_backlash"),
    "friction level": ("hysteresis",),
    "gain": ("link_inertia",),
    "inertia": ("linkage_inertia", "link_inertia"),
    "mass": (),
    "position error": ("elastic_joint",),
    "position law": ("torque_offset", "balancer"),
    "reversal": ("coulomb_change",),
    "ripple": ("cable_spring",),
    "tool": ("payload", "base_tilt"),
}
"""effects of other groups that pass for a member of this one on an ordinary motion"""

MEASURE_ELSE: dict[str, str] = {
    "base": "measure the base with a level; a tilt turns with axis 1, an encoder zero does not",
    "coupling": "move one wrist axis by hand with the brakes of the other released, and watch the "
    "other's torque",
    "delay": "record position and torque of one tap on the arm, on one clock",
    "dynamic": "tap the arm with the axis held and read the ringing frequency from the torque",
    "friction level": "record the same motion with a second, known payload: friction of the load "
    "grows with it",
    "gain": "record the same motion with a second, known payload: a gain scales its torque too, a "
    "spring does not",
    "inertia": "take the rotor inertia from the motor's data sheet, or record the motor uncoupled "
    "from the gear",
    "mass": "weigh the tool, or record the same motion without it; a link's mass stays",
    "offset": "read the torque with the brakes on and the drives off: an offset of the measurement "
    "stays, friction "
    "does not; no motion of the arm shows this difference",
    "position error": "turn the link by hand against the braked motor: play is felt and measured "
    "with a dial gauge; "
    "or record the same motion with a second payload",
    "position law": "record the same motion with the cable package taken off",
    "reversal": "record slow reversals of the axis alone with the brakes of the others on",
    "ripple": "record one slow turn of the axis alone over its whole range, in both directions",
    "tool": "record the same motion without contact",
    "viscous": "record the same motion again when warm, half an hour later",
}

SIZES: dict[str, dict[str, Any]] = {
    "balancer": {"torque_Nm": 100.0, "free_ratio": 0.45},
    "base_tilt": {"tilt_x_rad": 0.01, "tilt_y_rad": 0.01},
    "cable_spring": {"stiffness_Nm_rad": 10.0, "neutral_rad": 0.1},
    "coulomb_asymmetry": {"delta_Nm": 1.0},
    "coulomb_change": {"coulomb_Nm": 1.0},
    "elastic_joint": {"damping_ratio": 0.04},
    "encoder_zero": {"zero_rad": 0.01},
    "gear_ripple": {"amplitude_Nm": 1.0, "order": 20.0, "phase_rad": 0.5},
    "hysteresis": {"amplitude_Nm": 1.0, "width_rad": 0.02},
    "link_inertia": {"mass_kg": 5.0, "com_m": (0.15, 0.05, 0.1)},
    "linkage_inertia": {"inertia_kgm2": 3.0, "moment_kgm": 2.0},
    "load_friction": {"coefficient": 0.05},
    "payload": {"mass_kg": 5.0, "com_m": (0.03, 0.02, 0.1)},
    "process_force": {"force_x_N": 30.0, "force_y_N": 20.0, "force_z_N": 40.0},
    "rotor_inertia": {"inertia_kgm2": 1.0},
    "time_delay": {"delay_s": 0.004},
    "torque_gain": {"gain": 1.1},
    "torque_offset": {"offset_Nm": 1.0},
    "transmission_backlash": {"gap_rad": 0.004, "crossing_s": 0.06},
    "viscous_change": {"viscous_Nms_rad": 1.0},
    "viscous_power": {"coefficient": 1.0, "exponent": 0.5},
    "viscous_warmup": {"viscous_Nms_rad": 1.0, "time_constant_s": 20.0},
    "wrist_coupling": {"inertia_kgm2": 0.05, "viscous_Nms_rad": 0.5},
}
"""the law that stands for each kind; its height is then set in the common unit of `alternatives`"""

CONTAINED = (("coulomb_change", "hysteresis"), ("viscous_change", "viscous_warmup"))
"""members that are a limit of a rival (a loop of no width, a warm-up without end): only simplicity
speaks for them"""
TIME_DEPENDENT = ("viscous_warmup", "process_force")
"""kinds for which it matters at what time of the record something is moved"""
ON_ANOTHER_LINK = ("payload", "link_inertia", "linkage_inertia")
"""kinds that pass for the same kind, or each other, on another link"""


@dataclass(frozen=True)
class AmbiguityGroup:
    """Effects that are hard to tell apart.

    Args:
        name; kinds: of the members; lookalikes: kinds of other groups that pass for a member.
        splits: the experiment that tells them apart, in words; measure_else: where a motion does
            not.
    """

    name: str
    kinds: tuple[str, ...]
    lookalikes: tuple[str, ...]
    splits: str
    measure_else: str

    def members(self, n: int, joint: int | None = None) -> list[Place]:
        """Places of the members on an arm of n joints; with `joint` only those there or on the
        whole arm."""
        return [
            p
            for kind in self.kinds
            for p in places(kind, n)
            if joint is None or p[1] in (joint, None)
        ]

    def rivals(self, place: Place, n: int) -> list[Place]:
        """What could be meant instead of a member."""
        others = [
            p for name in (*self.kinds, *self.lookalikes) for p in places(name, n) if p != place
        ]
        return [p for p in others if _alike(place, p)]


def _alike(one: Place, other: Place) -> bool:
    if one[0] in ON_ANOTHER_LINK and other[0] in ON_ANOTHER_LINK:
        return True
    if (one[0], other[0]) in CONTAINED:
        return False
    return one[0] != other[0] and (one[1] == other[1] or None in (one[1], other[1]))


def places(kind: str, n: int) -> list[Place]:
    """Where an effect can sit on an arm of n joints; a delay of one joint is looked at joint by
    joint only."""
    joints: Sequence[int | None] = LIBRARY[kind].joints(n)
    if any(j is not None for j in joints):
        joints = [j for j in joints if j is not None]
    return [(kind, j) for j in joints if j is None or j <= n]


def groups() -> dict[str, AmbiguityGroup]:
    """All ambiguity groups of the library by name."""
    found = {}
    for name in sorted({effect.group for effect in LIBRARY.values()}):
        kinds = tuple(kind for kind, effect in LIBRARY.items() if effect.group == name)
        splits = "; ".join(dict.fromkeys(LIBRARY[kind].splits for kind in kinds))
        found[name] = AmbiguityGroup(
            name, kinds, LOOKALIKES.get(name, ()), splits, MEASURE_ELSE.get(name, "")
        )
    return found


def group_called(name: str) -> AmbiguityGroup:
    """The group of this name, or the one an effect of this name belongs to.

    Raises:
        InputError: neither; lists the groups.
    """
    known = groups()
    plain = name.strip().lower().replace("_", " ").replace("-", " ")
    if plain in known:
        return known[plain]
    kind = plain.replace(" ", "_")
    if kind in LIBRARY:
        return known[LIBRARY[kind].group]
    listed = "; ".join(f"{g.name} ({', '.join(g.kinds)})" for g in known.values())
    raise InputError(f"found no ambiguity group {name!r}; expected one of: {listed}")
