"""How an effect's torque is best drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Signal = Literal["q", "qd", "qdd", "load", "time"]


@dataclass(frozen=True)
class Drawing:
    """Axes of the curve of an effect.

    Args:
        abscissa: signal over which its torque is best drawn.
        against_motion: its curve is drawn for motion in the positive direction; the other one is
            turned over.
    """

    abscissa: Signal = "q"
    against_motion: bool = False
