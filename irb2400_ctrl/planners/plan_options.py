"""`PlanOptions`: how a tool path is to be shaped, followed and written down."""

from __future__ import annotations

import math
from dataclasses import dataclass

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell, CellTool
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import positive
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.part_law import part_motion
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import Interpolation
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.toolpath.orientation import Orientation, shape_path
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

MOST_TOLERANCE = 0.02
"""[m] to which a corner is cut at most: more is taken for millimetres"""


@dataclass(frozen=True)
class PlanOptions:
    """What `plan_path` was asked for, its timing apart.

    Raises:
        InputError: a rate or a tolerance that is not a positive number, or one of centimetres.
    """

    rate: float
    """rows of the trajectory per second [1/s]"""
    free_tool_rotation: bool
    work_frame: Array | None
    """pose X_BW of the frame the path is stated in, shape (4, 4)"""
    tolerance: float
    """how far corners of the polygon may be cut [m]"""
    axis_tolerance: float
    """how far a stated orientation may be left at the wrist singularity [rad]"""
    interpolation: Interpolation
    """how the rows of the trajectory are read"""
    cell: Cell | None = None
    """what stands around the arm"""
    tool_name: str | None = None
    """of a tool of the cell; None for what the robot file describes"""
    load: CuttingLoad | None = None
    """a force on the tip that the posture is chosen for"""
    mapped: bool = False
    """whether other tool rotations are looked at all along the path"""

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
        if self.tool_name is not None and self.cell is None:
            raise InputError(
                f"tool {self.tool_name!r} is one of a cell: expected a cell, too (cell=, --cell)"
            )

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
    def tool(self) -> CellTool | None:
        """The tool of the cell in the spindle."""
        if self.tool_name is None or self.cell is None:
            return None
        return self.cell.tool(self.tool_name)

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

    @property
    def sampling(self) -> Sampling:
        """How the motion is written and read."""
        return Sampling(self.rate, self.interpolation)
