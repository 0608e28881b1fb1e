"""What an effect says about the spring between a motor and its link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import casadi as ca

Number = TypeVar("Number", ca.SX, ca.DM)

STRAIGHT = 1e-3
"""[1/rad] stiffening that is none, so that the law has no division by nothing"""


@dataclass(frozen=True)
class Transmission:
    """What one effect says about a joint's transmission; what it leaves open another may say.

    Args:
        stiffness: of the spring [Nm/rad]; damping: its ratio for the link, motor held.
        gap: full lost motion [rad].
        stiffening: twisted, the spring is cosh(stiffening twist) times as stiff [1/rad].
    """

    stiffness: float | None = None
    damping: float | None = None
    gap: float | None = None
    stiffening: float | None = None


def wound(load: Number, stiffness: Number | float, stiffening: Number | float) -> Number:
    """Twist asinh(a load / k) / a of springs at rest [rad].

    Args:
        load: [Nm]; stiffness: k [Nm/rad]; stiffening: a [1/rad]; of one shape.
    """
    bent = stiffening + STRAIGHT
    return ca.asinh(bent * load / stiffness) / bent


def wound_torque(twist: Number, stiffness: Number | float, stiffening: Number | float) -> Number:
    """Torque (k / a) sinh(a twist) of springs [Nm], what `wound` is the inverse of.

    Args:
        twist: beyond the gap [rad]; stiffness: k [Nm/rad]; stiffening: a [1/rad]; of one shape.
    """
    bent = stiffening + STRAIGHT
    return stiffness / bent * ca.sinh(bent * twist)
