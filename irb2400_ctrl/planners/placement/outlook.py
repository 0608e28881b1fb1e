"""`Outlook`: how well an arm does a task that stands at a place, before anything is planned.

Seen at stations: the best way with a constant tool rotation, or else through the ladder graph, and
what it leaves of each margin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance.room import COMFORTABLE_CLEARANCE, room
from irb2400_ctrl.planners.placement.constant_ways import Ways, constant_ways
from irb2400_ctrl.planners.placement.task import Task
from irb2400_ctrl.planners.redundancy.choice import CLEARANCE_WORTH
from irb2400_ctrl.planners.redundancy.comfort import (
    COMFORTABLE_MARGINS,
    feed_and_torque,
    part_of_comfort,
)
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.ladder_graph import FREE_SHIFTS, Ladder, LadderWay
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE
from irb2400_ctrl.robot.shape import place_and_turn

ALIKE = 0.05
"""places whose worst margins differ by less, as a part of what is comfortable, count as alike"""
# ways whose forces are looked at
_LOOKS = 3


@dataclass(frozen=True, eq=False)
class Outlook:
    """What a place leaves of each margin; of several tasks the least."""

    X_BW: Array
    """pose of the work object, shape (4, 4)"""
    margins: dict[str, float]
    """smallest at the stations, under the keys of `COMFORTABLE_MARGINS`; empty where the task
    cannot be done"""
    deflection: float | None = None
    """how far the tip gives way at most [m]; None without a cutting force"""
    reachable: float = 1.0
    """part of the stations that the arm reaches; 1 where it reaches all"""
    refused: str = ""
    """why the task cannot be done there"""

    @cached_property
    def parts(self) -> dict[str, float]:
        """Each margin as a part of what is comfortable, at most 1."""
        return {
            name: float(part_of_comfort(name, np.asarray(value)))
            for name, value in self.margins.items()
        }

    @property
    def worth(self) -> float:
        """The worst part; below zero where the task cannot be done."""
        if self.refused:
            return self.reachable - 2.0
        return min(self.parts.values())

    @property
    def worst(self) -> str:
        """Name of the worst margin, or why there is none."""
        return self.refused or min(self.parts, key=lambda name: self.parts[name])

    @property
    def rank(self) -> tuple[float, float]:
        """Larger is better: the worst margin; among alike ones what gives way least, or else the
        mean of the margins."""
        if self.refused:
            return self.worth, 0.0
        level = float(np.floor(self.worth / ALIKE + 1e-9))
        if self.deflection is not None:
            return level, -self.deflection
        over = np.array([self.margins[name] / COMFORTABLE_MARGINS[name] for name in self.margins])
        # more than comfortable counts a little, less and less
        return level, float(np.mean(over / (1 + over)))

    def summary(self) -> dict[str, Any]:
        """For `placement.json`."""
        place, turn = place_and_turn(self.X_BW)
        return {
            "work_frame": [round(v, 3) + 0.0 for v in (*place, *turn)],
            "worth": self.worth,
            "worst": self.worst,
            "margins": self.margins,
            "deflection_mm": None if self.deflection is None else 1e3 * self.deflection,
            "refused": self.refused,
        }


def outlook(
    tasks: Sequence[Task], X_BW: Array, load: CuttingLoad | None = None, patient: bool = False
) -> Outlook:
    """All tasks from one place; ends with the first that cannot be done.

    Args:
        tasks: thinned, in the frame of the work object.
        X_BW: pose of the work object, shape (4, 4).
        load: a force on the tip, stated in the work object's frame.
        patient: whether rotations that vary are looked for, too, where no constant one will do.
    """
    margins: dict[str, float] = {}
    given: list[float] = []
    turned = None if load is None else load.turned(X_BW)
    for task in tasks:
        seen = _of_task(task, X_BW, turned, patient)
        if seen.refused:
            return seen
        for name, value in seen.margins.items():
            margins[name] = min(value, margins.get(name, value))
        if seen.deflection is not None:
            given.append(seen.deflection)
    return Outlook(X_BW, margins, max(given, default=None))


def _of_task(task: Task, X_BW: Array, load: CuttingLoad | None, patient: bool) -> Outlook:
    """The best way of one task, or why there is none."""
    found = task.model.inverse_kinematics_branches((X_BW @ task.poses).reshape(-1, 4, 4))
    base = found.q.reshape(*task.poses.shape[:2], *found.q.shape[1:])
    reached = np.isfinite(base).all(axis=3).reshape(len(base), -1).any(axis=1)
    if not reached.all():
        return Outlook(X_BW, {}, None, float(reached.mean()), "out of reach")
    ways = constant_ways(task.model, base)
    scene = None if task.scene is None else task.scene.placed(X_BW)
    best = _best(task, ways, scene, X_BW, load)
    if best is not None and (not best.refused or not patient):
        return best
    if patient and len(task.rotation) > 1:
        varied = _varied(task, X_BW, scene, load)
        if varied is not None:
            return varied
    return best or Outlook(X_BW, {}, refused="joint limits or a singularity")


def _best(
    task: Task, ways: Ways, scene: Scene | None, X_BW: Array, load: CuttingLoad | None
) -> Outlook | None:
    """The best of these ways; None where there is none at all."""
    if not len(ways.q):
        return None
    order = _preferred(ways, None if load is None else load.deflection(task.model, ways.q))
    found: list[tuple[float, Outlook]] = []
    for k in order:
        free = _room(task, scene, ways.q[k])
        if free <= 0:
            continue
        margins = {name: float(values[k]) for name, values in ways.kinematic.items()}
        margins |= _forced(task, ways.q[k], load)
        if scene is not None:
            margins["clearance_mm"] = 1e3 * free
        given = None if load is None else float(load.deflection(task.model, ways.q[k]).max())
        near = CLEARANCE_WORTH * min(free / COMFORTABLE_CLEARANCE, 1.0)
        worth = round(min(margins["singularity"], COMFORTABLE) + near, 2)
        found.append((worth, Outlook(X_BW, margins, given)))
        if len(found) == _LOOKS:
            break
    if not found:
        return Outlook(X_BW, {}, refused="collision")
    return max(found, key=lambda pair: pair[0])[1]


def _preferred(ways: Ways, deflection: Array | None) -> list[int]:
    """Numbers of the ways as `plan` orders them: comfortable ones first, then what gives way less,
    or else the shorter motion.

    Args:
        deflection: of the tip, shape (w, n) [m].
    """
    worth = np.round(np.minimum(ways.kinematic["singularity"], COMFORTABLE), 3)
    then = ways.time if deflection is None else deflection.max(axis=1)
    return [int(k) for k in np.lexsort((then, -worth))]


def _varied(
    task: Task, X_BW: Array, scene: Scene | None, load: CuttingLoad | None
) -> Outlook | None:
    """The best way whose tool rotation varies, through the ladder graph; None without one."""
    ladder = Ladder.at(task.model, task.u, task.rotation, X_BW @ task.poses)
    ladder = ladder.priced(scene, task.cutting, load)
    found = ladder.best(FREE_SHIFTS, keep=1)
    if not found:
        return None
    q = _joints(ladder, found[0])
    return _best(task, constant_ways(task.model, q[:, None, None]), scene, X_BW, load)


def _room(task: Task, scene: Scene | None, q: Array) -> float:
    """Beside what is to be kept, at most the comfortable one [m]; without a scene all of it."""
    if scene is None:
        return COMFORTABLE_CLEARANCE
    return float(room(scene, q, task.cutting).min())


def _joints(ladder: Ladder, way: LadderWay) -> Array:
    """Joint angles along a way, whole turns included, shape (n, joints)."""
    count = len(ladder.rotation)
    row = np.rint(way.rotation * count / (2 * np.pi)).astype(int) % count
    q = np.unwrap(ladder.q[np.arange(len(row)), row, way.branch], axis=0)
    return np.asarray(q + way.q_start - q[0])


def _forced(task: Task, q: Array, load: CuttingLoad | None) -> dict[str, float]:
    """What is left of torque and feed on a way q (n, joints), as if it were followed on straight
    lines between the stations."""
    length = np.maximum(np.diff(task.s), 1e-9)[:, None]
    feed = np.where(np.isfinite(task.feed), task.feed, 0.0)
    rate = np.diff(q, axis=0) / length * feed[1:, None]
    middle = (q[1:] + q[:-1]) / 2
    kept, left = feed_and_torque(task.model, middle, rate)
    # the cutting force takes its part of every joint, whichever way it pushes
    share = (_cutting_torque(task.model, middle, load) / task.model.robot.tau_max).max(axis=1)
    return {"torque_left": float((left - share).min()), "feed_kept": float(kept.min())}


def _cutting_torque(model: Model, q: Array, load: CuttingLoad | None) -> Array:
    """Size of the torque that a cutting force asks of each joint [Nm], shape (m, n)."""
    if load is None:
        return np.zeros_like(q)
    J = np.asarray(model.tcp_jacobian(q))[:, :3]
    if len(load.force) == 3:
        return np.asarray(np.abs(np.einsum("mij,i->mj", J, load.force)))
    return np.asarray(abs(load.force[0]) * np.linalg.norm(J, axis=1))
