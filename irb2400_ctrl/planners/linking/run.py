"""`Run`: a part of an operation that is followed without a stop."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Integers
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.redundancy.known_way import End
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.robot import Robot

# of the timing of lines and moves of the joints
_CELLS = 200


@dataclass(frozen=True)
class Run:
    """All of an operation, or what is between two places where axes are unwound."""

    operation: Operation
    plan: Plan
    points: Integers
    """index of the operation's way-point that each of its points is, -1 for one that was put in
    between, shape (len(plan.path),)"""
    arm: Robot
    """as its file describes it, without a tool of the cell"""
    options: PlanOptions
    """rows, cell and tool of the moves beside it: its own"""
    wait: float = 0.0
    """how long the arm stands at its end, where its operation waits [s]"""
    because: str = ""
    """why the operation is not followed in one go; empty where it is"""

    @property
    def moving(self) -> bool:
        """Whether a positioner turns the part, or a carriage the arm, on the way."""
        return self.plan.trajectory.external is not None

    @property
    def turning(self) -> bool:
        """Whether a positioner turns the part on the way."""
        rows = self.plan.trajectory.external
        return rows is not None and rows.q.shape[1] > len(rows.lengths)

    def stands(self, end: End) -> tuple[float, float] | None:
        """(tilt, turn) of the positioner at an end [deg]; None without one."""
        rows = self.plan.trajectory.external
        if rows is None or not self.turning:
            return self.options.positioner
        tilt, turn = np.degrees(rows.q[0 if end == "first" else -1, len(rows.lengths) :])
        return float(tilt), float(turn)

    def carriage(self, end: End) -> float | None:
        """Place of the carriage at an end [m]; None without a rail."""
        rows = self.plan.trajectory.external
        if rows is None or not rows.lengths:
            return self.options.rail
        return float(rows.q[0 if end == "first" else -1, 0])

    def beside(self, end: End) -> Run:
        """The same for the moves beside one of its ends, during which carriage and positioner
        stand."""
        cell = self.options.cell
        if not self.moving or cell is None:
            return self
        place = self.carriage(end)
        if cell.rail is not None and cell.rail_moves and place is not None:
            cell = cell.on_rail(float(np.clip(1e3 * place, *cell.rail.range_mm)))
        angles = self.stands(end)
        if angles is not None:
            cell = cell.on_positioner(angles)
        return replace(self, options=replace(self.options, cell=cell))

    @property
    def start(self) -> int:
        """Index of the way-point at or before its beginning."""
        inserted = int(self.points[0] < 0)
        return int(self.points[inserted]) - inserted

    @cached_property
    def scene(self) -> Scene | None:
        """The arm in its cell; None where nothing is known of the space that it takes up."""
        tool = self.options.in_spindle
        return Scene.of(Model(self.plan.robot), self.arm, self.options.cell, tool)

    @property
    def feed(self) -> float:
        """Of its first move [m/s]; inf where that is a rapid one."""
        return float(self.plan.path.feed[1])

    @property
    def timing(self) -> TimingOptions:
        """Limits and back-end of the moves beside it: its own."""
        return TimingOptions(
            self.options.timing,
            _CELLS,
            self.plan.certificate.limits.first(self.plan.robot.n),
            self.options.sampling,
            self.options.torque_share,
            self.options.rates_stated,
        )
