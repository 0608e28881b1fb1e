"""`LinkOptions`: how the tool gets to, between and away from operations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.typed import typed

CLEARANCE = 0.05
APPROACH = 0.01


@typed
@dataclass(frozen=True)
class LinkOptions:
    """Heights and ends of the moves beside the operations.

    Raises:
        InputError: a length that is not positive.
    """

    clearance: float = CLEARANCE
    """height of the moves between operations above the highest cut of the program [m]"""
    approach: float = APPROACH
    """last part of the lead-in, driven at the feed of the first cut [m]"""
    start: Array | None = None
    """configuration to come from and to return to [rad], shape (n,); None: all axes at zero, or in
    the middle of their range where zero is outside"""
    ends: bool = True
    """whether the motion begins and ends at `start`; else at the first and the last way-point"""

    def __post_init__(self) -> None:
        for name, value in (("clearance", self.clearance), ("approach", self.approach)):
            if not np.isfinite(value) or value <= 0:
                raise InputError(f"{name}: found {1e3 * value:g} mm, expected a positive length")
        if self.start is not None and not np.isfinite(numbers("start", self.start)).all():
            raise InputError(f"start: found {self.start}, expected finite angles [rad]")
