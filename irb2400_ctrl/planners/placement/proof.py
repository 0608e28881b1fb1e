"""`Proof`: what holds of a task at a place over the continuous path, before it is timed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners.joint_box import left_in_box
from irb2400_ctrl.planners.placement.task import Task
from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.choices import choices
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.toolpath.orientation import shape_path


@dataclass(frozen=True)
class Proof:
    """The joint paths that `plan` would begin with, of all tasks the least."""

    margins: dict[str, float]
    """relative singularity margins [-], joint_limits_deg, clearance_mm where it is known"""
    deflection: float | None = None
    """[m]"""
    refused: str = ""
    way: tuple[Array, Array] | None = None
    """of the first task: lengths [m], shape (m,), and angles there [rad], shape (m, n)"""

    def summary(self) -> dict[str, Any]:
        """For `placement.json`."""
        return {
            "margins": self.margins,
            "deflection_mm": None if self.deflection is None else 1e3 * self.deflection,
            "refused": self.refused,
        }


def prove(tasks: Sequence[Task], X_BW: Array, load: CuttingLoad | None) -> Proof:
    """Follow each task with the joints, with the work object at X_BW (4, 4).

    Args:
        tasks: what is to be followed.
        X_BW: [m].
        load: force of the tool [N] while it cuts.
    """
    least: dict[str, float] = {}
    given: list[float] = []
    way: tuple[Array, Array] | None = None
    turned = None if load is None else load.turned(X_BW)
    for task in tasks:
        try:
            choice = _choice(task, X_BW, turned)
        except UnreachableError as error:
            return Proof({}, refused=str(error))
        way = way or _way(choice)
        for name, value in _margins(task, choice).items():
            least[name] = min(value, least.get(name, value))
        if choice.given_way is not None:
            given.append(choice.given_way.largest)
    return Proof(least, max(given, default=None), way=way)


def _choice(task: Task, X_BW: Array, load: CuttingLoad | None) -> Choice:
    """The first of the joint paths that `plan` would compare."""
    curve = task.orientation.curve
    orientation = shape_path(task.path, task.orientation.spindle, curve.tolerance, X_BW)
    scene = None if task.scene is None else task.scene.placed(X_BW)
    found = choices(task.model, orientation, task.free, keep=1, scene=scene, load=load)
    return next(iter(found))


def _margins(task: Task, choice: Choice) -> dict[str, float]:
    _, q = _way(choice)
    found = dict(zip(NAMES, choice.margins.tolist(), strict=True))
    found["joint_limits_deg"] = float(np.degrees(left_in_box(task.model.robot, q).min()))
    if choice.clearance is not None:
        found["clearance_mm"] = 1e3 * choice.clearance.value
    return found


def _way(choice: Choice) -> tuple[Array, Array]:
    """Lengths and angles at the knots of a joint path, and between them."""
    joints = choice.followed.joints
    knots = joints.knots
    s = np.unique(np.concatenate([knots, (knots[1:] + knots[:-1]) / 2]))
    return s, np.asarray(joints(s))
