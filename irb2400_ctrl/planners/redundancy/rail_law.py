"""Where a carriage goes along a tool path while the arm works: chosen before the arm's own motion.

With p(s) the place of the tip along the rail and e(s) that of the carriage,

    int (p - e)^2 + L^2 e'^2 + L^4 / 16 e''^2 ds

is least within a corridor: the arm stays across from its tool, but does not go along with what is
short beside L, which its own joints do with less. The corridor is where one branch of the inverse
kinematics reaches the pose with its joints inside their box, at some tool rotation; of the branches
and of the parts of a corridor the cheapest is found by dynamic programming on a grid. The places
are control points of a cubic B-spline.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.follow import arc_length, station_parameters
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

# what is shorter than about this the arm does by itself [m]
_LENGTH = 0.3
# distance of the stations [m], and how many there may be
_SPACING = 0.02
_FEWEST = 30
_MOST = 1500
# stations at which the reach is looked at, and tool rotations there
_LOOKS = 120
_ROTATIONS = 12
# of the places on the rail that are looked at [m], and how many there may be
_STEP = 0.05
_MOST_PLACES = 120
# a place out of reach costs as much as one so far from the tip [m]
_OUT = 30.0
# kept from the ends of the joints' box [rad], and of the rail [m]
_FROM_BOX = np.radians(3.0)
_INSET = 1e-3


def rail_law(
    model: Model, orientation: Orientation, rail: ExternalAxes, free_tool_rotation: bool
) -> Callable[[Array], Array]:
    """Curve parameters (m,) -> places of the carriage (m, 1) [m].

    Args:
        model: the arm.
        orientation: the tool path, with the carriage at zero.
        rail: the rail alone.
        free_tool_rotation: whether the tool may turn about the spindle as it likes.
    """
    curve = orientation.curve
    u = even_stations(curve)
    length = float(arc_length(curve, u)[-1])
    way = -rail.direction[0]
    tip = orientation.poses(u, np.zeros(1))[:, :3, 3] @ way
    low = float(rail.low[0]) + _INSET
    high = float(rail.high[0]) - _INSET
    count = int(np.clip(np.ceil((high - low) / _STEP), 2, _MOST_PLACES)) + 1
    places = np.linspace(low, high, count)
    looks = np.unique(np.round(np.linspace(0, len(u) - 1, min(_LOOKS, len(u)))).astype(int))
    reached = _reached(model, orientation, u[looks], places, way, free_tool_rotation)
    spacing = length / (len(looks) - 1)
    chosen = _cheapest(reached, tip[looks], places, spacing)
    corridor = _corridor(reached[chosen[0]], chosen[1], places)
    ends = [np.interp(np.arange(len(u)), looks, end) for end in corridor]
    e = _smoothest(tip, ends[0], ends[1], length / (len(u) - 1))
    law = uniform_spline(length, e[:, None])

    def along(at: Array) -> Array:
        distinct, back = np.unique(at, return_inverse=True)
        return np.asarray(law(np.minimum(arc_length(curve, distinct), length)))[back]

    return along


def even_stations(curve: TaskCurve) -> Array:
    """Parameters of stations evenly spread along a curve, ends included."""
    u = station_parameters(curve, _SPACING)
    s = arc_length(curve, u)
    count = int(np.clip(np.ceil(s[-1] / _SPACING), _FEWEST, _MOST)) + 1
    even = np.interp(np.linspace(0, s[-1], count), s, u)
    even[[0, -1]] = 0.0, float(curve.segments)
    return even


def uniform_spline(length: float, control: Array):  # type: ignore[no-untyped-def]
    """The cubic B-spline over the length with these control points (m, k), spread evenly."""
    from scipy.interpolate import BSpline

    inner = np.linspace(0.0, length, len(control) - 2)
    knots = np.concatenate([[0.0] * 3, inner, [length] * 3])
    return BSpline(knots, control, 3)


def _reached(
    model: Model, orientation: Orientation, u: Array, places: Array, way: Array, free: bool
) -> npt.NDArray[np.bool_]:
    """Whether each branch reaches the pose at some tool rotation, shape (branches, len(u),
    len(places))."""
    turns = np.linspace(-np.pi, np.pi, _ROTATIONS, endpoint=False) if free else np.zeros(1)
    low = model.robot.q_min + _FROM_BOX
    high = model.robot.q_max - _FROM_BOX
    found = []
    for X in orientation.fan(u, turns):
        asked = np.tile(X, (len(places), 1, 1, 1))
        asked[:, :, :3, 3] -= places[:, None, None] * way
        q = model.inverse_kinematics_branches(asked.reshape(-1, 4, 4)).q
        # whole turns up to the box
        q = q + 2 * np.pi * np.ceil((low - q) / (2 * np.pi))
        inside = np.isfinite(q).all(axis=2) & (q <= high).all(axis=2)
        found.append(inside.reshape(len(places), len(turns), -1).any(axis=1))
    return np.stack(found).transpose(2, 0, 1)


def _cheapest(
    reached: npt.NDArray[np.bool_], tip: Array, places: Array, spacing: float
) -> tuple[int, Integers]:
    """Number of the branch, and those of the places at the stations."""
    beside = (tip[:, None] - places) ** 2
    price = (_LENGTH * (places[:, None] - places) / spacing) ** 2
    best: tuple[float, int, Integers] | None = None
    for branch, inside in enumerate(reached):
        cost = beside + _OUT**2 * ~inside
        total = cost[0]
        back = []
        for station in cost[1:]:
            ways = total[None] + price
            back.append(ways.argmin(axis=1))
            total = ways.min(axis=1) + station
        rows = [int(np.argmin(total))]
        for choice in back[::-1]:
            rows.append(int(choice[rows[-1]]))
        if best is None or total.min() < best[0]:
            best = (float(total.min()), branch, np.array(rows[::-1], dtype=np.int64))
    assert best is not None
    return best[1], best[2]


def _corridor(inside: npt.NDArray[np.bool_], rows: Integers, places: Array) -> tuple[Array, Array]:
    """Ends of what is reached around the places chosen, a step of the grid away from what is not;
    all of the rail where nothing is."""
    low = np.empty(len(rows))
    high = np.empty(len(rows))
    for k, (free, row) in enumerate(zip(inside, rows, strict=True)):
        out = np.flatnonzero(~free)
        below = out[out < row]
        above = out[out > row]
        first = int(below[-1]) + 2 if len(below) and free[row] else 0
        last = int(above[0]) - 2 if len(above) and free[row] else len(places) - 1
        low[k] = places[min(first, int(row))]
        high[k] = places[max(last, int(row))]
    return low, high


def _smoothest(tip: Array, low: Array, high: Array, spacing: float) -> Array:
    """The least squares of the module's head within the corridor, shape (n,) [m]."""
    from scipy.optimize import lsq_linear
    from scipy.sparse import diags_array, eye_array, vstack

    n = len(tip)
    first = diags_array([-1.0, 1.0], offsets=[0, 1], shape=(n - 1, n)) * (_LENGTH / spacing)
    bend = diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 2, n))
    rows = vstack([eye_array(n), first, bend * ((_LENGTH / spacing) ** 2 / 4)]).tocsr()
    wished = np.concatenate([tip, np.zeros(2 * n - 3)])
    wide = np.maximum(high, low + 1e-6)
    found = lsq_linear(rows, wished, (low, wide), tol=1e-8, lsmr_tol="auto")
    return np.asarray(np.clip(found.x, low, wide))
