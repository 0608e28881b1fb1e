"""toppra as a timing back-end: the same rows at the ends of every cell (its Interpolation scheme),
nothing guaranteed.

toppra's own torque constraint calls the dynamics point by point and knows no viscous friction; here
its constraint class only hands over rows computed for all cells at once, friction linearised at the
speeds of the pass before.
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits, speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.torque_constraints import Linearisation, torque_constraints


def time_with_toppra(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    feed_bound: Array | None = None,
    passes: int = 3,
) -> PiecewiseConstantLaw:
    """Rest-to-rest time law from toppra (seidel), torque rows at the ends of the cells, constant
    acceleration between.

    Args:
        cells: the path enclosed cell by cell.
        limits: of torque [Nm], speed and acceleration, and of their rates.
        friction: (F_s [Nm], F_c [Nm], F_v [Nm s/rad], omega_st [rad/s]) of each joint, shape (n,
            4).
        feed_bound: of sdot^2 at the grid points [m2/s2]; default none.
        passes: rounds in which dry friction is taken at the speeds of the round before.

    Raises:
        InfeasibleError: toppra finds no parametrisation.
    """
    import toppra
    from toppra.algorithm import TOPPRA

    logging.getLogger("toppra").setLevel(logging.ERROR)
    bound = speed_bounds(cells, limits.qd_max, feed_bound)
    bound = np.minimum(bound, 1e9)
    x = np.minimum(0.25 * bound, np.median(bound))
    m = len(cells.h)
    for _ in range(passes):
        mean = np.maximum((x[:-1] + x[1:]) / 2, 1e-30)
        at = Linearisation(mean, mean, 1.02 * mean, np.full(m, np.inf), np.diff(x) / (2 * cells.h))
        rows = torque_constraints(cells, limits, friction, at)
        # the rows of a cubic's four Bernstein coefficients: the first and the last are its ends
        ends = end_rows(rows, limits)
        instance = TOPPRA(
            [_constraint(ends, bound, limits.qd_max.size)],
            toppra.SplineInterpolator([cells.s[0], cells.s[-1]], np.zeros((2, limits.qd_max.size))),
            gridpoints=cells.s,
            solver_wrapper="seidel",
        )
        _, speed, _ = instance.compute_parameterization(0.0, 0.0)
        if speed is None or not np.isfinite(speed).all():
            raise InfeasibleError(
                "toppra finds no motion within the torque limits; try the certified timing, which "
                "says where"
            )
        x = np.asarray(speed, dtype=float) ** 2
    return PiecewiseConstantLaw(cells.s, x)


def end_rows(rows: Array, limits: MotionLimits) -> Array:
    """Of the rows of every cubic only those of its two ends, shape (m, k / 2, 3)."""
    m = len(rows)
    n = limits.qd_max.size
    start = 0
    kept = []
    bounded = int(np.isfinite(limits.qdd_max).sum())
    # torque first, one block for every combination of the effects, then acceleration
    blocks = (rows.shape[1] // 4 - 2 * bounded) // n
    for axes in [n] * blocks + [bounded] * 2:
        block = rows[:, start : start + 4 * axes].reshape(m, 4, axes, 3)
        kept.append(block[:, [0, 3]].reshape(m, -1, 3))
        start += 4 * axes
    return np.concatenate(kept, axis=1)


def _constraint(rows: Array, bound: Array, dof: int) -> Any:
    """toppra's linear constraint with the given rows on each stage."""
    from toppra.constraint import LinearConstraint

    class Rows(LinearConstraint):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            self.dof = dof
            self.identical = True

        def compute_constraint_params(self, path: Any, gridpoints: Any) -> tuple[Any, ...]:
            # no motion starts from the last grid point: its rows do not matter
            all_rows = np.concatenate([rows, np.zeros_like(rows[:1])])
            a, b, r = np.moveaxis(all_rows, -1, 0)
            r[-1] = 1.0
            k = a.shape[1]
            xbound = np.stack([np.zeros_like(bound), bound], axis=1)
            return a, b, -r, np.eye(k), np.zeros(k), None, xbound

    return Rows()
