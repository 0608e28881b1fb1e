"""How further axes go along a tool path: chosen before the arm's own motion.

First the axes of a positioner, which turn the part; then a rail under the arm
(`rail_law`).

At every place of the path the tool should be near a wished direction d, and its tip on the robot's
side of the part. With the tool axis a and the tip p in the base at angles e,

    cost = int 1 - a(e) . d + w (p_x^2 + p_y^2) + l |de/ds|^2 ds

is least along e(s): dynamic programming on a grid of angles, then twice on a finer one around what
was found. The angles found, averaged over neighbours, are the control points of a cubic B-spline:
twice continuously differentiable, and within the range of the axes as they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.follow import arc_length
from irb2400_ctrl.planners.redundancy.rail_law import even_stations, rail_law, uniform_spline
from irb2400_ctrl.planners.toolpath.orientation import Orientation, PartMotion
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

# of the grid of angles [rad], and of the finer ones around the best way
_STEP = np.radians(10.0)
_FINER = (np.radians(2.5), np.radians(0.6))
# steps of the grid between neighbouring stations
_MOST_STEPS = 3
# weights: of the tip's distance from the arm's first axis [1/m2], of turning [m/rad2], of an angle
# that makes no difference [1/rad2]
_NEAR = 0.05
_TURNING = 3e-4
_ANYWHERE = 1e-7
# distance kept from the ends of a range [rad]
_INSET = np.radians(0.2)
# stations over which angles are averaged (standard deviation)
_SMOOTH = 2.0


def part_motion(
    curve: TaskCurve, spindle: Array, cell: Cell, model: Model, free_tool_rotation: bool
) -> PartMotion:
    """How the axes of a cell go along a curve.

    Args:
        curve: placed with the axes at zero.
        spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
        cell: with axes that move.
        model: the arm.
        free_tool_rotation: whether the tool may turn about the spindle as it likes.
    """
    axes = cell.external_axes
    assert axes is not None
    turning = axes.turning
    part = None
    if len(turning):
        part = PartMotion(turning, _turning_law(curve, spindle, cell, model.robot.upright[2]))
    if not axes.slides:
        assert part is not None
        return part
    orientation = Orientation.of(curve, spindle, part)
    along = rail_law(model, orientation, axes.rail, free_tool_rotation)

    def places(at: Array) -> Array:
        return np.hstack([along(at), orientation.external(at)])

    return PartMotion(axes, places)


def _turning_law(
    curve: TaskCurve, spindle: Array, cell: Cell, up: Array
) -> Callable[[Array], Array]:
    """Of the axes of a positioner; where the arm stands on a rail, from the place of the carriage
    that is nearest to them.

    Args:
        curve: the path and its tool axes.
        spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
        cell: with axes that move.
        up: in the base, what the tool is kept near unless the cell says otherwise, shape (3,).
    """
    axes = cell.external_axes
    assert cell.positioner is not None
    assert axes is not None
    wished = np.array(up if cell.positioner.keep is None else cell.positioner.keep)
    u = even_stations(curve)
    s = arc_length(curve, u)
    position, first, full = curve.pose(u)
    axis = first if full is None else -(full @ (spindle / np.linalg.norm(spindle)))
    turning = axes.turning
    if axes.slides:
        way = axes.direction[0]
        nearest = np.clip(-(turning.point[-1] @ way), axes.low[0], axes.high[0]) * way
        turning = replace(turning, point=turning.point + nearest)
        position = position + nearest
    search = _Search(turning, position, axis, wished / np.linalg.norm(wished), s[-1] / (len(s) - 1))
    law = uniform_spline(s[-1], _averaged(search.best()))

    def angles(at: Array) -> Array:
        places, back = np.unique(at, return_inverse=True)
        return np.asarray(law(np.minimum(arc_length(curve, places), s[-1])))[back]

    return angles


class _Search:
    """The cheapest angles along the stations."""

    def __init__(
        self, axes: ExternalAxes, place: Array, tool: Array, wished: Array, spacing: float
    ) -> None:
        self.axes = axes
        self.place = place
        self.tool = tool
        self.wished = wished
        self.turning = _TURNING / spacing**2
        stands = axes.high - axes.low < 2 * _INSET
        middle = (axes.low + axes.high) / 2
        self.low = np.where(stands, middle, axes.low + _INSET)
        self.high = np.where(stands, middle, axes.high - _INSET)

    def best(self) -> Array:
        """Angles at the stations, shape (n, k) [rad]."""
        found = self._within(self._coarse(around=True))
        if found is None:
            found = self._coarse(around=False)
        for step in _FINER:
            found = self._finer(found, step)
        return found

    def _within(self, e: Array) -> Array | None:
        """The same shifted by whole turns into the ranges, as near to zero as may be; None where
        they do not fit."""
        turn = 2 * np.pi
        least = np.ceil((self.low - e.min(axis=0)) / turn - 1e-9)
        most = np.floor((self.high - e.max(axis=0)) / turn + 1e-9)
        if (least > most).any():
            return None
        nearest = -np.round((e.min(axis=0) + e.max(axis=0)) / 2 / turn)
        return np.asarray(e + turn * np.clip(nearest, least, most))

    def _cost(self, station: int, e: Array) -> Array:
        """Of angles (m, k) at a station, shape (m,)."""
        M = self.axes.turned(e)
        return _discomfort(M, self.place[station], self.tool[station], self.wished, e)

    def _coarse(self, *, around: bool) -> Array:
        """On the grid of all angles; `around`: an axis with a whole turn in its range goes round
        and round."""
        grids = [self._grid(i, around) for i in range(len(self.axes))]
        loops = [around and self.high[i] - self.low[i] >= 2 * np.pi for i in range(len(grids))]
        shape = tuple(len(grid) for grid in grids)
        e = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, len(grids))
        M = self.axes.turned(e)
        steps = np.array([grid[1] - grid[0] if len(grid) > 1 else 0.0 for grid in grids])
        ranges = [range(-_MOST_STEPS, _MOST_STEPS + 1) if n > 1 else (0,) for n in shape]
        shifts = np.array(list(itertools.product(*ranges)))
        price = self.turning * ((shifts * steps) ** 2).sum(axis=1)
        best = np.zeros(shape)
        back = []
        for place, tool in zip(self.place, self.tool, strict=True):
            ways = np.stack([_moved(best, shift, loops) for shift in shifts])
            ways += price.reshape(-1, *[1] * len(shape))
            choice = ways.argmin(axis=0)
            back.append(choice)
            cost = _discomfort(M, place, tool, self.wished, e).reshape(shape)
            best = np.take_along_axis(ways, choice[None], axis=0)[0] + cost
        at = np.array(np.unravel_index(int(np.argmin(best)), shape))
        rows = [at]
        for choice in back[:0:-1]:
            before = rows[-1] - shifts[choice[tuple(rows[-1] % np.array(shape))]]
            rows.append(before)
        index = np.array(rows[::-1])
        first = np.array([grid[0] for grid in grids])
        return np.asarray(first + steps * index)

    def _grid(self, i: int, around: bool) -> Array:
        width = self.high[i] - self.low[i]
        if around and width >= 2 * np.pi:
            return np.arange(-np.pi, np.pi - 1e-9, _STEP)
        return np.linspace(self.low[i], self.high[i], int(np.ceil(width / _STEP)) + 1)

    def _finer(self, around: Array, step: float) -> Array:
        """On a small grid around the angles at every station."""
        k = len(self.axes)
        offsets = step * np.array(list(itertools.product((-2, -1, 0, 1, 2), repeat=k)))
        e = np.clip(around[:, None] + offsets, self.low, self.high)
        best = np.zeros(len(offsets))
        back: list[Integers] = []
        for station in range(len(e)):
            if station:
                change = ((e[station][:, None] - e[station - 1][None]) ** 2).sum(axis=2)
                ways = best[None] + self.turning * change
                back.append(ways.argmin(axis=1))
                best = ways.min(axis=1)
            best = best + self._cost(station, e[station])
        row = int(np.argmin(best))
        rows = [row]
        for choice in back[::-1]:
            row = int(choice[row])
            rows.append(row)
        return np.asarray(e[np.arange(len(e)), rows[::-1]])


def _discomfort(M: Array, place: Array, tool: Array, wished: Array, e: Array) -> Array:
    """Of a place and a tool axis of the part, each (3,), turned by M (m, 4, 4), shape (m,)."""
    p = M[:, :2, :3] @ place + M[:, :2, 3]
    near = _NEAR * (p**2).sum(axis=1)
    return np.asarray(1 - (M[:, :3, :3] @ tool) @ wished + near + _ANYWHERE * (e**2).sum(axis=1))


def _moved(best: Array, shift: Array, loops: list[bool]) -> Array:
    """What it costs to come from the node `shift` steps before, inf from beyond an end."""
    found = best
    for axis, (by, loop) in enumerate(zip(shift, loops, strict=True)):
        if not by:
            continue
        found = np.roll(found, by, axis=axis)
        if not loop:
            cut = [slice(None)] * found.ndim
            cut[axis] = slice(None, by) if by > 0 else slice(by, None)
            found[tuple(cut)] = np.inf
    return found


def _averaged(e: Array) -> Array:
    """Means over neighbouring stations; what is averaged stays within the range."""
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(e, _SMOOTH, axis=0, mode="nearest"))
