"""`PlanOptions`: how a tool path is to be shaped, followed and written down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell, CellTool
from irb2400_ctrl.errors import InputError


@dataclass(frozen=True)
class PlanOptions:
    """What `plan_path` was asked for, its timing apart.

    Raises:
        InputError: a rate or a tolerance that is not a positive number.
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
    cell: Cell | None = None
    """what stands around the arm"""
    tool: CellTool | None = None
    """of the cell, in the spindle"""

    def __post_init__(self) -> None:
        if not np.isfinite(self.rate) or self.rate <= 0:
            raise InputError(
                f"rate: found {self.rate}, expected a positive number of rows per second"
            )
        if not np.isfinite(self.tolerance) or self.tolerance <= 0:
            raise InputError(f"tolerance: found {self.tolerance} m, expected a positive length")
