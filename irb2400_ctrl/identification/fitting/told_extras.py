"""The extras of an identification in words: what they are, and what their numbers are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.identification.fitting.columns import FELT, Extra
from irb2400_ctrl.wording import joined


@dataclass(frozen=True)
class Kind:
    """What extras of one kind are.

    Args:
        says: of the joint that has one; effect: of the library, None: of the joint's friction.
        numbers: what they are, and their units, as `EXTRA_COLUMNS` has them.
    """

    says: str
    effect: str | None
    numbers: tuple[str, ...]


def _coupled(effect: str, other: str) -> Kind:
    """Gears that join a joint and another."""
    numbers = [
        said
        for what, unit in (("acceleration", "kg m2"), ("speed", "Nm s/rad"), ("sign", "Nm"))
        for said in (
            f"here, by the other's {what} [{unit}]",
            f"on the other, by its own {what} [{unit}]",
        )
    ]
    return Kind(f"moves with the {other} joint (gears of a wrist)", effect, tuple(numbers))


KINDS = {
    "coupling": _coupled("wrist_coupling", "next"),
    "far_coupling": _coupled("far_wrist_coupling", "next but one"),
    "motor": Kind(
        "has a motor that turns along with {turning} (gears of a wrist)",
        "geared_motor",
        ("motor's inertia [kg m2]", "its friction [Nm s/rad]", "its dry friction [Nm]"),
    ),
    "balancer": Kind(
        "has a balancer that the file does not name",
        "balancer",
        ("times sin q [Nm]", "times cos q [Nm]"),
    ),
    "spring": Kind(
        "is pulled towards one angle, as by a hose or a cable",
        "cable_spring",
        ("stiffness [Nm/rad]",),
    ),
    "reading": Kind(
        "reads its torque without part of what accelerates it",
        "acceleration_reading",
        ("not read, beyond the rotor [kg m2]",),
    ),
    "stribeck": Kind(
        "has more friction at low speed than the file says", None, ("more at low speed [Nm]",)
    ),
    "load": Kind(
        "has dry friction that grows with the torque that its gear carries",
        "load_friction",
        ("loss over the torque carried [Nm/Nm]",),
    ),
    "power": Kind(
        "has friction that does not grow in proportion to its speed",
        "viscous_power",
        ("over the root of speed [Nm (s/rad)^1/2]",),
    ),
}
"""of every kind that an identified arm can have"""


def said_of(extra: Extra) -> str:
    """What its joint does or has."""
    turning = [
        f"{ratio:+.2f} times joint {extra.joint - away}"
        for away, ratio in enumerate(extra.ratios, start=1)
        if abs(ratio) > FELT
    ]
    return KINDS[extra.kind].says.format(turning=joined(turning) if turning else "no other joint")


def extra_json(extra: Extra) -> dict[str, Any]:
    """As in identification.json."""
    return {
        "kind": extra.kind,
        "joint": extra.joint,
        "effect": KINDS[extra.kind].effect,
        "ratios": list(extra.ratios) if extra.kind == "motor" else None,
    }
