"""Feeds: a speed, a way per turn of the spindle, or a share of the move per time."""

from __future__ import annotations

import math
from dataclasses import dataclass

from irb2400_ctrl.errors import InputError

MM = 1e-3
INCH = 25.4e-3
FOOT = 12 * INCH
LENGTHS = {"mm": MM, "cm": 1e-2, "m": 1.0, "inch": INCH, "foot": FOOT}
"""units of length that a file may state [m]"""


@dataclass(frozen=True)
class Feed:
    """A programmed feed."""

    kind: str = "none"
    """"speed" [m/s], "turn" [m per revolution], "inverse" [moves per second], or "none" """
    value: float = math.inf

    def speed(self, length: float, spindle_speed: float) -> float:
        """Speed of the tool tip [m/s] on a move of `length` [m]; `spindle_speed` [rad/s].

        Raises:
            InputError: a feed of zero; one per revolution, and the spindle stands.
        """
        if self.value == 0:
            raise InputError(
                "a cut with the feed zero, at which the tool stands; expected a positive "
                "feed before it or in its block"
            )
        if self.kind == "turn":
            if spindle_speed <= 0:
                raise InputError(
                    "the feed is per revolution, but no spindle speed is stated; "
                    "expected SPINDL/…,RPM (or S and M3) before the move, a feed per minute, or "
                    "the speed from you (spindle_rpm=…, --spindle-rpm …)"
                )
            return self.value * spindle_speed / (2 * math.pi)
        if self.kind == "inverse":
            return max(self.value * length, 1e-9)
        return self.value

    def turning_alone(self) -> str:
        """What is said of a cut in which the tip stands and the tool turns.

        Raises:
            InputError: its time is stated.
        """
        if self.kind == "inverse":
            raise InputError(
                "found a cut in inverse time (G93, INVERS) that turns the tool on the spot; a plan "
                "has feeds of the tip, which stands, and cannot hold its time: expected G94, where "
                "it turns as fast as the arm's limits allow, or a turn on the way"
            )
        return (
            "a cut that turns the tool on the spot: F, degrees per minute on many controls, does "
            "not limit it; it turns as fast as the arm's limits allow"
        )
