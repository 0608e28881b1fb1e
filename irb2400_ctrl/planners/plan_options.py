"""`PlanOptions`: what a plan is asked for, from the command line to the timing."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell, CellTool, with_tool
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import positive
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.part_law import part_motion
from irb2400_ctrl.planners.stage_clock import Progress
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import DEFAULT, interpolation
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.timing_options import Backend, TimingOptions
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.planners.toolpath.orientation import Orientation, shape_path
from irb2400_ctrl.planners.toolpath.positioner import upright
from irb2400_ctrl.planners.toolpath.task_curve import TOLERANCE
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory.trajectory import RATE
from irb2400_ctrl.typed import typed

MOST_TOLERANCE = 0.02
"""[m] to which a corner is cut at most: more is taken for millimetres"""


@typed
@dataclass(frozen=True)
class PlanOptions:
    """What `plan_path` is asked for: its arguments, which say what each is, robot and path apart.

    Raises:
        InputError: a rate or a tolerance that is not a positive number, or one of centimetres.
    """

    rate: float = RATE
    free_tool_rotation: bool = True
    work_frame: Array | None = None
    tolerance: float = TOLERANCE
    axis_tolerance: float = math.radians(0.1)
    timing: Backend = "certified"
    cells: int = 1000
    limits: MotionLimits | None = None
    torque_rate: ArrayLike | None = None
    jerk: ArrayLike | None = None
    cell: Cell | None = None
    tool: str | None = None
    torque_share: float = 1.0
    interpolation: str = DEFAULT
    load: CuttingLoad | None = None
    rotation_map: bool = False
    progress: Progress | None = None

    def __post_init__(self) -> None:
        positive("rate", self.rate, "rows per second")
        positive("tolerance", self.tolerance, "m")
        if self.tolerance > MOST_TOLERANCE:
            raise InputError(
                f"tolerance: found {1e3 * self.tolerance:g} mm, expected at most "
                f"{1e3 * MOST_TOLERANCE:g} mm; in Python it is in metres, 5e-05 for 0.05 mm"
            )
        # zero asks for the stated orientation itself
        if not (math.isfinite(self.axis_tolerance) and self.axis_tolerance >= 0):
            raise InputError(
                f"axis_tolerance: found {self.axis_tolerance} rad, expected zero or more"
            )

    def check_axes(self) -> None:
        """Hold against each other what a plan of one path cannot have together.

        Raises:
            InputError: a load on axes that move, or a positioner whose angles are to be found.
        """
        if self.load is not None and self.external is not None:
            raise InputError(
                "cutting force: found one together with a positioner that moves, which turns it "
                "with the part, or with a carriage that moves; expected places at which they stand"
            )
        plate = None if self.cell is None else self.cell.positioner
        if plate is not None and plate.position_deg == "find":
            raise InputError(
                'positioner: found position_deg = "find", which is answered for each operation of '
                "a program (plan_program, irb2400 plan); expected angles: cell.on_positioner(...)"
            )

    @property
    def in_spindle(self) -> CellTool | None:
        """The tool of the cell; None for what the robot file describes.

        Raises:
            InputError: there is no cell, or the cell does not have it.
        """
        if self.tool is None:
            return None
        if self.cell is None:
            raise InputError(
                f"tool {self.tool!r} is one of a cell: expected a cell, too (cell=, --cell)"
            )
        return self.cell.tool(self.tool)

    def armed(self, robot: Robot) -> Robot:
        """The arm with the TCP at the tip of what is in its spindle."""
        tool = self.in_spindle
        return robot if tool is None else with_tool(robot, tool)

    @property
    def rail(self) -> float | None:
        """Where on its rail the carriage stands [m]; None without a rail, and where it moves."""
        if self.cell is None or self.cell.rail is None or self.cell.rail_moves:
            return None
        return self.cell.rail.stands_mm / 1e3

    @property
    def positioner(self) -> tuple[float, float] | None:
        """(tilt, turn) at which the positioner stands [deg]; None without one."""
        return None if self.cell is None else self.cell.positioner_deg

    @property
    def external(self) -> ExternalAxes | None:
        """Axes that move the part or the arm during the cut; None where none does."""
        return None if self.cell is None else self.cell.external_axes

    def shaped(self, path: ToolPath, spindle: Array, model: Model) -> Orientation:
        """The smooth curve of a tool path, and where its part and the arm are carried along it.

        Args:
            path: in the frame that is asked for.
            model: the arm.
            spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
        """
        found = shape_path(path, spindle, self.tolerance, self.frame)
        if self.cell is None or self.external is None:
            return found
        free = self.free_tool_rotation and path.rotation is None
        part = part_motion(found.curve, spindle, self.cell, model, free)
        return Orientation.of(found.curve, spindle, part)

    @property
    def frame(self) -> Array | None:
        """Pose X_BW that the path is placed at: the work frame, else the cell's work object."""
        if self.work_frame is None and self.cell is not None:
            return self.cell.work_frame
        return self.work_frame

    def placed(self, path: ToolPath) -> ToolPath:
        """A path in the base; with axes that move at zero."""
        return path if self.frame is None else path.moved(self.frame)

    def seen(self, path: ToolPath, robot: Robot) -> ToolPath:
        """A path in the base as the arm sees it: where a positioner or a carriage moves, each
        way-point with its place there."""
        placed = self.placed(path)
        if self.external is None:
            return placed
        orientation = self.shaped(path, robot.spindle_axis, Model(self.armed(robot)))
        origin = orientation.curve.origin
        u = np.searchsorted(origin, np.arange(len(path)), side="right").astype(float)
        return placed.carried(self.external.turned(orientation.external(u)))

    def for_operation(self, operation: Operation, robot: Robot) -> PlanOptions:
        """The same with the cell's tool that the operation asks for, unless one is named, with the
        carriage where the operation wants it and the positioner at its angles.

        Raises:
            InputError: the file's angles are outside the positioner's ranges.
        """
        cell = self.cell
        if cell is None:
            return self
        tool = self.tool
        if tool is None:
            tool = cell.tool_of(operation.tool.number, operation.tool.name)
        frame = self.work_frame
        if cell.rail is not None:
            moved = cell.on_rail(cell.rail.asked(operation.number, operation.name))
            if frame is not None:
                # stated as the arm sees it from where the carriage stands
                frame = moved.seen @ np.linalg.inv(cell.seen) @ frame
            cell = moved
        if cell.positioner is not None:
            angles = cell.positioner.asked(operation.number, operation.name)
            if angles == "find":
                assert cell.work_object is not None
                path = operation.path.moved(cell.work_object.pose)
                axes = cell.positioner.kinematics
                setting = upright(axes, path, robot.spindle_axis, robot.upright[2])
                first, last = np.degrees(setting.angles)
                angles = (round(float(first), 3), round(float(last), 3))
            cell = cell.on_positioner(angles)
            frame = None
        return replace(self, cell=cell, tool=tool, work_frame=frame)

    @property
    def sampling(self) -> Sampling:
        """How the motion is written and read."""
        return Sampling(self.rate, interpolation(self.interpolation))

    @property
    def rates_stated(self) -> bool:
        """Whether somebody asked for limits of torque rate or jerk."""
        return self.torque_rate is not None or self.jerk is not None

    def timed(self, robot: Robot) -> TimingOptions:
        """Limits and back-end of the timing, as the robot allows them.

        Raises:
            InputError, ToolMissingError: as `TimingOptions.of`.
        """
        bounds = (self.limits, self.torque_rate, self.jerk)
        rows = (self.sampling, self.torque_share, self.external)
        return TimingOptions.of(robot, self.timing, self.cells, *bounds, *rows)

    @property
    def beside(self) -> PlanOptions:
        """Of the moves beside the path, which are stated in the base: the tool does not turn."""
        return replace(
            self,
            free_tool_rotation=False,
            work_frame=np.eye(4),
            tolerance=TOLERANCE,
            axis_tolerance=0.0,
            load=None,
            rotation_map=False,
            progress=None,
        )
