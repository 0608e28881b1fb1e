"""What an effect says about the spring between a motor and its link."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Transmission:
    """What one effect says about a joint's transmission; what it leaves open another may say.

    Args:
        stiffness: of the spring [Nm/rad]; damping: its ratio for the link, motor held.
        gap: full lost motion [rad].
    """

    stiffness: float | None = None
    damping: float | None = None
    gap: float | None = None
