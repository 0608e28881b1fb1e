"""`InfeasiblePointError`: no motion within the limits, and where on the path."""

from __future__ import annotations

from irb2400_ctrl.errors import InfeasibleError


class InfeasiblePointError(InfeasibleError):
    """The limits leave no motion at one place of a path."""

    def __init__(self, s: float, reason: str) -> None:
        """At length s along the path [m], for a reason that follows the place in the message."""
        super().__init__(f"at {1e3 * s:.1f} mm{reason}")
        self.s = s
        self.reason = reason
