"""Rows of torque and rates in the cells of a path, summed: as machine code, or in numpy."""

from irb2400_ctrl.planners.timing.rate_limited.cell_rows.machine_code import (
    along,
    slacks,
    steepest,
    sums,
    updated,
)
from irb2400_ctrl.planners.timing.rate_limited.cell_rows.rows_of_cells import RowsOfCells, Sums

__all__ = ["RowsOfCells", "Sums", "along", "slacks", "steepest", "sums", "updated"]
