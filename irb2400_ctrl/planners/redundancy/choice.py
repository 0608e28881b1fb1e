"""`Choice`: a joint path along a tool path, and how it was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import CollisionError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import Clearance, continuous_clearance
from irb2400_ctrl.planners.clearance.continuous import CONTACT
from irb2400_ctrl.planners.clearance.room import COMFORTABLE_CLEARANCE
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.follow import Followed, JointTarget
from irb2400_ctrl.planners.redundancy.singularity_margins import (
    COMFORTABLE,
    relative_margins,
)
from irb2400_ctrl.planners.redundancy.wrist_passage import Passing
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

CLEARANCE_WORTH = 0.1
"""what a comfortable clearance is worth, as a relative margin to singularities [-]"""
LONG = 1500
"""segments of a path above which few choices are followed and one is timed: each takes seconds"""
RotationLaw = Callable[[Array], Array]
"""free rotation [rad] over the length along the path [m]"""


@dataclass(frozen=True)
class GivenWay:
    """How far the tip gives way to a cutting force, at samples of a joint path."""

    largest: float
    """[m]"""
    mean: float
    """over the length of the path [m]"""
    s: float
    """where it is largest, as a length along the joint path [m]"""


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
    clearance: Clearance | None = None
    """how far the motion stays from everything; None where it is not known"""
    passing: Passing | None = None
    """how a path of given orientations takes the wrist singularity"""
    given_way: GivenWay | None = None
    """how far the tip gives way to a cutting force; None where none is stated"""

    @property
    def margin(self) -> float:
        """Smallest of the three, leaving out a wrist singularity that the path passes on
        purpose."""
        passed = self.passing is not None and len(self.passing.passages) > 0
        return float(self.margins[1:].min() if passed else self.margins.min())

    @property
    def worth(self) -> float:
        """Margin and clearance in one number; more than comfortable is worth nothing."""
        near = self.clearance
        room = 0.0 if near is None else min(near.value / COMFORTABLE_CLEARANCE, 1.0)
        return min(self.margin, COMFORTABLE) + CLEARANCE_WORTH * room

    @property
    def rank(self) -> tuple[float, float]:
        """Smallest first: what is worth more, then what gives way less to a cutting force."""
        soft = 0.0 if self.given_way is None else self.given_way.largest
        return -round(self.worth, 2), soft

    @property
    def comfortable(self) -> bool:
        """Whether no other choice can rank before it, as far as that is told apart."""
        if self.given_way is not None:
            return False
        most = COMFORTABLE + (0.0 if self.clearance is None else CLEARANCE_WORTH)
        return round(self.worth, 2) >= round(most, 2)

    @property
    def turn(self) -> float:
        """Angle by which the stated orientation is left at most [rad]."""
        return 0.0 if self.passing is None else self.passing.turn


def continuous_margins(model: Model, followed: Followed) -> Array:
    """Smallest relative margins over the path, sampled four times between stations, shape
    (3,)."""
    fine = _finer(followed)
    return np.asarray(
        relative_margins(model, followed.joints(fine)[:, : model.robot.n]).min(axis=0)
    )


def _finer(followed: Followed) -> Array:
    """Places four times as dense as the stations, shape (n,) [m]."""
    s = followed.joints.knots
    parts = [s[:-1] + f * np.diff(s) for f in (0, 0.25, 0.5, 0.75)]
    return np.unique(np.concatenate([*parts, s[-1:]]))


def given_way(model: Model, followed: Followed, load: CuttingLoad | None) -> GivenWay | None:
    """How far the tip gives way, sampled four times between stations; None without a load."""
    if load is None:
        return None
    s = _finer(followed)
    found = load.deflection(model, followed.joints(s)[:, : model.robot.n])
    at = int(np.argmax(found))
    mean = float(np.trapezoid(found, s) / (s[-1] - s[0]))
    return GivenWay(float(found[at]), mean, float(s[at]))


def stay_inside(model: Model, followed: Followed, target: JointTarget) -> None:
    """Refuse a joint path that leaves the joint box.

    Raises:
        UnreachableError: says near which point, which axis, by how much.
    """
    s = followed.joints.knots
    fine = np.concatenate([s, (s[:-1] + s[1:]) / 2])
    u = np.concatenate([followed.u, (followed.u[:-1] + followed.u[1:]) / 2])
    q = followed.joints(fine)[:, : model.robot.n]
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


def cutting_between(
    curve: TaskCurve, moves: npt.NDArray[np.bool_], u: Array
) -> npt.NDArray[np.bool_]:
    """Whether the tool may cut all the way between neighbouring parameters u, shape (n - 1,)."""
    allowed = moves[curve.origin]
    refused = np.concatenate([[0], np.cumsum(~allowed)])
    first = np.clip(np.floor(u[:-1] + 1e-9).astype(int), 0, curve.segments)
    last = np.clip(np.ceil(u[1:] - 1e-9).astype(int), 0, curve.segments)
    return np.asarray(refused[last] == refused[first])


def clear(
    scene: Scene | None, followed: Followed, target: JointTarget, moves: npt.NDArray[np.bool_]
) -> Clearance | None:
    """How far a joint path stays from everything; None where that is not known.

    Args:
        scene: the arm in its cell.
        followed: the joint path.
        target: what it follows.
        moves: whether the tool may cut on the way to each way-point, shape (n,).

    Raises:
        CollisionError: it cannot be shown free; says what touches what, where.
    """
    if scene is None:
        return None
    cutting = cutting_between(target.curve, moves, followed.u)
    found = continuous_clearance(scene, followed.joints, cutting)
    if found.free:
        return found
    u = float(np.interp(found.s, followed.joints.knots, followed.u))
    first, other = found.pair
    near = "touch" if found.value <= 0 else f"come within {1e3 * found.value:.2f} mm"
    wanted = f", {1e3 * found.keep:g} mm are to be kept" if found.keep else ""
    if wanted and found.value > found.keep:
        wanted += f", and {1e3 * CONTACT:g} mm more cannot be told from contact"
    raise CollisionError(
        f"near point {target.point(u)} {first} and {other} {near}{wanted}; move the work "
        "frame, free the tool rotation, or change the cell"
    )
