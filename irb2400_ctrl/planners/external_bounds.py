"""`AxisBounds`: what is sure of an axis that carries the part, over all times of the rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import ReferenceBounds


@dataclass(frozen=True)
class AxisBounds:
    """Upper bounds of the rows of one axis as they are read, and its limits."""

    least: float
    most: float
    """angles that it stays between [rad]"""
    speed: float
    """largest |ed| over its limit"""
    acceleration: float
    """largest |edd| over its limit"""
    speed_limit: float
    """[rad/s]"""
    acceleration_limit: float
    """[rad/s2]"""

    def summary(self, name: str) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        return {
            "name": name,
            "between_deg": [float(np.degrees(v)) for v in (self.least, self.most)],
            "max_speed_ratio": self.speed,
            "max_acceleration_ratio": self.acceleration,
            "speed_limit_deg_s": float(np.degrees(self.speed_limit)),
            "acceleration_limit_deg_s2": float(np.degrees(self.acceleration_limit)),
        }


def axis_bounds(
    places: JointPath, bounds: ReferenceBounds, limits: MotionLimits, n: int
) -> tuple[AxisBounds, ...]:
    """Of the axes behind the arm's n joints.

    Args:
        places: where all axes are over the time.
        bounds: of their speed, and of the acceleration where the arm has its torque.
        limits: with those of these axes.
    """
    h = np.diff(places.knots)[:, None]
    value, slope, bend, third = places.coefficients[:, :, n:]
    b1 = value + slope * h / 3
    b2 = value + 2 * slope * h / 3 + bend * h**2 / 3
    b3 = value + slope * h + bend * h**2 + third * h**3
    low, high = bernstein.hull(np.stack([value, b1, b2, b3], axis=1))
    found = []
    for j in range(places.n - n):
        limit = (float(limits.qd_max[n + j]), float(limits.tau_max[n + j]))
        found.append(
            AxisBounds(
                least=float(low[:, j].min()),
                most=float(high[:, j].max()),
                speed=float(bounds.speed[:, n + j].max()) / limit[0],
                acceleration=float(bounds.torque[:, n + j].max()) / limit[1],
                speed_limit=limit[0],
                acceleration_limit=limit[1],
            )
        )
    return tuple(found)
