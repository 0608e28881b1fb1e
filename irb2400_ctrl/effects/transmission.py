"""What an effect says about the spring between a motor and its link."""

from __future__ import annotations

from dataclasses import dataclass

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
