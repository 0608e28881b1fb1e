"""`Choice`: a joint path along a tool path, and how it was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.follow import Followed, JointTarget
from irb2400_ctrl.planners.redundancy.singularity_margins import relative_margins
from irb2400_ctrl.planners.redundancy.wrist_passage import Passing

RotationLaw = Callable[[Array], Array]
"""free rotation [rad] over the length along the path [m]"""


@dataclass(frozen=True)
class Choice:
    """A joint path and how it was found."""

    kind: str
    """"given orientation", "constant rotation" or "free rotation" """
    branch: int
    """closed-form branch at the start"""
    rotation: RotationLaw
    followed: Followed
    margins: Array
    """smallest relative margins (wrist, shoulder, elbow) over the joint path, shape (3,) [-]"""
    passing: Passing | None = None
    """how a path of given orientations takes the wrist singularity"""

    @property
    def margin(self) -> float:
        """Smallest of the three, leaving out a wrist singularity that the path passes on
        purpose."""
        passed = self.passing is not None and len(self.passing.passages) > 0
        return float(self.margins[1:].min() if passed else self.margins.min())

    @property
    def turn(self) -> float:
        """Angle by which the stated orientation is left at most [rad]."""
        return 0.0 if self.passing is None else self.passing.turn


def continuous_margins(model: Model, followed: Followed) -> Array:
    """Smallest relative margins over the path, sampled four times between stations, shape
    (3,)."""
    s = followed.joints.knots
    fine = np.unique(
        np.concatenate([s[:-1] + f * np.diff(s) for f in (0, 0.25, 0.5, 0.75)] + [s[-1:]])
    )
    return np.asarray(relative_margins(model, followed.joints(fine)).min(axis=0))


def stay_inside(model: Model, followed: Followed, target: JointTarget) -> None:
    """Refuse a joint path that leaves the joint box.

    Raises:
        UnreachableError: says near which point, which axis, by how much.
    """
    s = followed.joints.knots
    fine = np.concatenate([s, (s[:-1] + s[1:]) / 2])
    u = np.concatenate([followed.u, (followed.u[:-1] + followed.u[1:]) / 2])
    q = followed.joints(fine)
    excess = np.maximum(model.robot.q_min - q, q - model.robot.q_max)
    worst = int(np.argmax(excess.max(axis=1)))
    axis = int(np.argmax(excess[worst]))
    if excess[worst, axis] > 0:
        low, high = np.degrees([model.robot.q_min[axis], model.robot.q_max[axis]])
        raise UnreachableError(
            f"near point {target.point(u[worst])} axis {axis + 1} would need "
            f"{np.degrees(q[worst, axis]):.1f} deg, "
            f"{np.degrees(excess[worst, axis]):.1f} deg beyond its range {low:.0f} to {high:.0f} "
            "deg"
        )
