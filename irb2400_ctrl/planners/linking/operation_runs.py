"""`operation_runs`: an operation planned in one go, or in parts between which axes are unwound."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import cutting_moves
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.linking.waits import waiting, waits
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.plan_path import plan_asked
from irb2400_ctrl.planners.redundancy.choices import GRID, cutting_at, stations
from irb2400_ctrl.planners.redundancy.follow import arc_length
from irb2400_ctrl.planners.redundancy.ladder_graph import FREE_SHIFTS, Ladder
from irb2400_ctrl.planners.redundancy.reentry import cheapest_reentries
from irb2400_ctrl.planners.redundancy.way_out import WayOut, way_is_free
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.planners.toolpath.orientation import Orientation, shape_path
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot

# what a mark on the part is worth [s]
_MARK = 2.0
# rapid speed that the way out is counted with [m/s]
_RAPID = 0.5
# parts of parts: how deep
_DEPTH = 3


def operation_runs(
    robot: Robot,
    operation: Operation,
    plane: ClearancePlane,
    links: LinkOptions,
    options: PlanOptions,
) -> tuple[Run, ...]:
    """The plan of an operation, in one go where that is possible.

    Args:
        robot: the arm with the operation's tool.
        operation: in the work frame.
        plane: what is above the part, in the base.
        links: heights.
        options: for the operation, see `PlanOptions.for_operation`.

    Raises:
        UnreachableError: neither in one go nor with unwinding; says where, and which axis.
    """
    split = Split.of(robot, operation, plane, links, options)
    whole = split.whole
    try:
        plan = plan_asked(robot, split.path, split.options, split.way_out(whole))
    except UnreachableError as error:
        return split.waiting(split.runs(whole, error, _DEPTH))
    return split.waiting((split.run(plan, whole, ""),))


def unwound_runs(
    robot: Robot,
    operation: Operation,
    plane: ClearancePlane,
    links: LinkOptions,
    options: PlanOptions,
    because: UnreachableError,
) -> tuple[Run, ...]:
    """The parts of an operation that cannot be followed in one go.

    Raises:
        UnreachableError: `because`, where unwinding does not help.
    """
    split = Split.of(robot, operation, plane, links, options)
    return split.waiting(split.runs(split.whole, because, _DEPTH))


@dataclass(frozen=True)
class Part:
    """A part of an operation's path."""

    path: ToolPath
    points: Integers
    """index of the operation's way-point that each of its points is, -1 for one put in between"""


@dataclass(frozen=True)
class Split:
    """An operation that is cut where that is cheapest."""

    robot: Robot
    operation: Operation
    path: ToolPath
    """in the base"""
    plane: ClearancePlane
    links: LinkOptions
    options: PlanOptions
    """of `path`: its work frame is the base"""
    seen: ToolPath
    """in the base as the arm sees it, `path` where neither positioner nor carriage moves"""

    @classmethod
    def of(
        cls,
        robot: Robot,
        operation: Operation,
        plane: ClearancePlane,
        links: LinkOptions,
        options: PlanOptions,
    ) -> Split:
        """The operation in the base, ready to be cut in parts; its arguments as `operation_runs`.

        Raises:
            UnreachableError: it waits while axes beside the arm move.
        """
        path = options.placed(operation.path)
        middle = [point for point in waits(operation) if point < len(path) - 1]
        if options.external is not None and middle:
            raise UnreachableError(
                f"operation {operation.number} waits at point {middle[0] + 1}, which is not "
                "planned while the positioner or the carriage moves; state where they stand for "
                "this operation"
            )
        seen = options.seen(operation.path, robot)
        options = replace(options, work_frame=np.eye(4))
        return cls(robot, operation, path, plane, links, options, seen)

    @property
    def moving(self) -> bool:
        """Whether a positioner turns the part, or a carriage the arm, on the way."""
        return self.options.external is not None

    @property
    def whole(self) -> Part:
        """The operation in one part."""
        return Part(self.path, np.arange(len(self.path)))

    def runs(self, part: Part, because: UnreachableError, depth: int) -> tuple[Run, ...]:
        """The plans of a part that cannot be followed in one go.

        Raises:
            UnreachableError: `because`, where no re-entry helps.
        """
        if self.moving:
            raise UnreachableError(
                f"{because}; while a positioner or a carriage moves axes are not unwound: state "
                "where they stand for this operation, or another direction to keep"
            )
        pieces = self._pieces(part) if depth else []
        if len(pieces) < 2:
            raise because
        found: list[Run] = []
        for piece in pieces:
            try:
                plan = plan_asked(self.robot, piece.path, self.options, self.way_out(piece))
                found.append(self.run(plan, piece, str(because)))
            except UnreachableError:
                found += self.runs(piece, because, depth - 1)
        return tuple(found)

    def run(self, plan: Plan, part: Part, because: str) -> Run:
        """A part with its plan."""
        options = self.options.beside
        return Run(self.operation, plan, part.points, self.robot, options, because=because)

    def waiting(self, runs: tuple[Run, ...]) -> tuple[Run, ...]:
        """The runs, cut where the operation waits."""
        tolerance = self.options.tolerance
        return tuple(part for run in runs for part in waiting(run, tolerance))

    def way_out(self, part: Part) -> WayOut:
        """From the ends of a part up to the plane; none from those of the motion itself."""
        path = self.seen if self.moving else part.path
        whole = self.plane.way_outs(path, self.robot.spindle_axis, self.links.approach)
        begins = part.points[0] == 0
        ends = part.points[-1] == len(self.path) - 1
        return WayOut(
            None if begins and not self.links.ends else whole.first,
            None if ends and not self.links.ends else whole.last,
        )

    def _pieces(self, part: Part) -> list[Part]:
        """The part cut at the cheapest re-entries; in two halves, where the ladder needs none."""
        orientation = shape_path(part.path, self.robot.spindle_axis, self.options.tolerance)
        held = orientation.curve.full and not self.options.free_tool_rotation
        u = stations(orientation)
        model = Model(self.options.armed(self.robot))
        ladder = Ladder.of(model, orientation, u, np.zeros(1) if held else GRID)
        ladder = self.way_out(part).kept(ladder, orientation)
        scene = Scene.of(model, self.robot, self.options.cell, self.options.in_spindle)
        if scene is not None:
            moves = cutting_moves(part.path, orientation.spindle)
            ladder = ladder.free_of(scene, cutting_at(orientation.curve, moves, u))
        exits = _Exits(self, part, orientation, ladder)
        shifts = (0,) if held else FREE_SHIFTS
        found = cheapest_reentries(ladder, shifts, exits.cost, exits.free)
        if found is None:
            return []
        return _cut(part, orientation, u, found or (len(u) // 2,))


@dataclass(frozen=True)
class _Exits:
    """What leaving a part at one of its stations takes."""

    split: Split
    part: Part
    orientation: Orientation
    ladder: Ladder

    def way(self, station: int) -> Array:
        """Places from the station up to the plane, shape (k, 3)."""
        X = self.orientation.poses(self.ladder.u[station : station + 1], np.zeros(1))[0]
        axis = -X[:3, :3] @ self.orientation.spindle
        return self.split.plane.way_out(X[:3, 3], axis, self.split.links.approach)

    def cost(self, station: int) -> float:
        """Up and down again, and the mark that is left on the part [s]."""
        curve = self.orientation.curve
        segment = min(int(self.ladder.u[station]), curve.segments - 1)
        feed = float(self.part.path.feed[curve.origin[segment]])
        length = float(np.linalg.norm(np.diff(self.way(station), axis=0), axis=1).sum())
        rapid = 2 * length / _RAPID
        if length == 0.0:
            return rapid
        number = int(self.part.points[curve.origin[segment]])
        if number >= 0 and self.split.operation.rapid[number]:
            return rapid
        return rapid + self.split.links.approach / feed + _MARK

    def free(self, station: int) -> Array:
        """Nodes that can be left along the way, shape (r, 8)."""
        ladder = self.ladder
        X = self.orientation.fan(ladder.u[station : station + 1], ladder.rotation)[0]
        return way_is_free(ladder.model, X, ladder.q[station], self.way(station))


def _cut(part: Part, orientation: Orientation, u: Array, places: tuple[int, ...]) -> list[Part]:
    """The part cut at stations: at the nearest way-point, or at a point put in between where
    way-points are far apart."""
    curve = orientation.curve
    length = arc_length(curve, u)
    near = float(length[-1]) / (len(u) - 1)
    found: list[Part] = []
    rest = part
    gone = 0
    for station in places:
        segment = min(int(u[station]), curve.segments - 1)
        number = int(curve.origin[segment]) - gone
        at = curve.pose(u[station : station + 1])
        away = np.linalg.norm(rest.path.position[max(number - 1, 0) : number + 1] - at[0], axis=1)
        k = max(number - 1, 0) + int(np.argmin(away))
        if away.min() <= near and 0 < k < len(rest.path) - 1:
            found.append(_slice(rest, 0, k + 1))
            rest = _slice(rest, k, len(rest.path))
            gone += k
        elif 0 < number < len(rest.path):
            longer = _inserted(rest, number, at)
            found.append(_slice(longer, 0, number + 1))
            rest = _slice(longer, number, len(longer.path))
            gone += number - 1
    return [*found, rest]


def _slice(part: Part, first: int, last: int) -> Part:
    kept = slice(first, last)
    return Part(part.path.part(kept), part.points[kept])


def _inserted(part: Part, number: int, at: tuple[Array, Array, Array | None]) -> Part:
    """One more point on the way to a way-point."""
    path = part.path
    position, axis, rotation = at
    return Part(
        ToolPath(
            np.insert(path.position, number, position[0], axis=0),
            None if path.axis is None else np.insert(path.axis, number, axis[0], axis=0),
            None
            if path.rotation is None or rotation is None
            else np.insert(path.rotation, number, rotation[0], axis=0),
            np.insert(path.feed, number, path.feed[number]),
            path.name,
        ),
        np.insert(part.points, number, -1),
    )
