"""The joint path of a tool path: branch and tool rotation chosen, candidates compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import CollisionError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import Clearance, continuous_clearance, cutting_moves
from irb2400_ctrl.planners.redundancy.follow import (
    Followed,
    JointTarget,
    arc_length,
    follow,
    station_parameters,
)
from irb2400_ctrl.planners.redundancy.ladder_graph import BOX_INSET, FREE_SHIFTS, Ladder, LadderWay
from irb2400_ctrl.planners.redundancy.singularity_margins import relative_margins
from irb2400_ctrl.planners.redundancy.wrist_passage import Passing, passings
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

RotationLaw = Callable[[Array], Array]
"""free rotation [rad] over the length along the path [m]"""

GRID = np.radians(np.arange(0.0, 360.0, 5.0))
MAX_STATIONS = 600


@dataclass(frozen=True)
class Choice:
    """A joint path and how it was found."""

    kind: str
    """"given orientation", "constant rotation" or "free rotation" """
    branch: int
    """closed-form branch at the start"""
    rotation: RotationLaw
    followed: Followed
    margins: Array
    """smallest relative margins (wrist, shoulder, elbow) over the joint path, shape (3,) [-]"""
    clearance: Clearance | None = None
    """how far the motion stays from everything; None where it is not known"""
    passing: Passing | None = None
    """how a path of given orientations takes the wrist singularity"""

    @property
    def margin(self) -> float:
        """Smallest of the three, leaving out a wrist singularity that the path passes on
        purpose."""
        passed = self.passing is not None and len(self.passing.passages) > 0
        return float(self.margins[1:].min() if passed else self.margins.min())

    @property
    def turn(self) -> float:
        """Angle by which the stated orientation is left at most [rad]."""
        return 0.0 if self.passing is None else self.passing.turn


def choices(
    model: Model,
    orientation: Orientation,
    free: bool,
    keep: int = 3,
    scene: Scene | None = None,
) -> Iterator[Choice]:
    """Joint paths inside the joint box that touch nothing, the most promising of each kind first.

    Args:
        model: the arm.
        orientation: the tool path, placed and smoothed.
        free: choose the rotation about the spindle along the path.
        keep: ways of each kind that are looked at.
        scene: the arm in its cell; None where nothing is known of the space that it takes up.

    Raises:
        UnreachableError: no way leads through; says at which point, which axis, by how much, or
            (CollisionError) what touches what.
    """
    curve = orientation.curve
    held = curve.full and not free
    u = _stations(orientation)
    s = arc_length(curve, u)
    ladder = Ladder.of(model, orientation, u, np.zeros(1) if held else GRID)
    moves = cutting_moves(curve.path, orientation.spindle)
    if scene is not None:
        ladder = ladder.free_of(scene, _cutting_at(curve, moves, u))
    problem: UnreachableError | None = None
    found = False
    options = (
        _held(model, orientation, ladder) if held else _turned(ladder, orientation, s, free, keep)
    )
    for kind, branch, law, target, q_start, passing in options:
        try:
            followed = follow(model, target, q_start)
            _inside_box(model, followed, target)
            clearance = _clear(scene, followed, target, moves)
        except UnreachableError as error:
            problem = problem or error
            continue
        found = True
        margins = continuous_margins(model, followed)
        yield Choice(kind, branch, law, followed, margins, clearance, passing)
    if not found:
        names = curve.origin[np.minimum(u.astype(int), curve.segments - 1)].copy()
        names[0] = 0
        raise problem or ladder.explain(names)


_Option = tuple[str, int, RotationLaw, JointTarget, Array | None, Passing | None]


def _held(model: Model, orientation: Orientation, ladder: Ladder) -> Iterator[_Option]:
    """Every posture whose first three axes stay in the joint box, with every way past or through
    the wrist."""
    low = model.robot.q_min[:3] + BOX_INSET
    high = model.robot.q_max[:3] - BOX_INSET
    with np.errstate(invalid="ignore"):
        each = ((ladder.q[:, 0, :, :3] >= low) & (ladder.q[:, 0, :, :3] <= high)).all(axis=(0, 2))
        inside = each.reshape(-1, 2).any(axis=1)
    for posture in np.flatnonzero(inside):
        for passing in passings(model, orientation, int(posture)):
            branch = int(passing.target.branch(np.zeros(1))[0])
            yield "given orientation", branch, _constant(0.0), passing.target, None, passing


def _turned(
    ladder: Ladder, orientation: Orientation, s: Array, free: bool, keep: int
) -> Iterator[_Option]:
    """The best constant rotations and, if the rotation is free, the best varying ones, smoothed."""
    ways: list[tuple[str, LadderWay]] = []
    ways += [("constant rotation", c) for c in ladder.best((0,), per_rotation=True, keep=keep)]
    if free:
        ways += [("free rotation", c) for c in ladder.best(FREE_SHIFTS, keep=keep)]
    for kind, way in ways:
        for law in _laws(s, way, kind):
            branch = int(way.branch[0])
            yield kind, branch, law, JointTarget.of(orientation, law, branch), way.q_start, None


def continuous_margins(model: Model, followed: Followed) -> Array:
    """Smallest relative margins over the path, sampled four times between stations, shape
    (3,)."""
    s = followed.joints.knots
    fine = np.unique(
        np.concatenate([s[:-1] + f * np.diff(s) for f in (0, 0.25, 0.5, 0.75)] + [s[-1:]])
    )
    return np.asarray(relative_margins(model, followed.joints(fine)).min(axis=0))


def _stations(orientation: Orientation) -> Array:
    """Evenly spread stations, at most MAX_STATIONS, ends included."""
    curve = orientation.curve
    u = station_parameters(curve, 0.02)
    s = arc_length(curve, u)
    count = int(np.clip(np.ceil(s[-1] / 0.01), 40, MAX_STATIONS))
    even = np.interp(np.linspace(0, s[-1], count), s, u)
    even[0] = 0.0
    even[-1] = float(curve.segments)
    return even


def _laws(s: Array, way: LadderWay, kind: str) -> list[RotationLaw]:
    """The rotation as a smooth function of the length: strongly, then lightly smoothed."""
    if kind != "free rotation" or np.ptp(way.rotation) < 1e-9:
        return [_constant(float(way.rotation[0]))]
    from scipy.interpolate import make_smoothing_spline

    # penalty on the curvature of the rotation; a length scale of 1/10 and 1/40 of the path
    spread = [(s[-1] / f) ** 3 for f in (10, 40)]
    return [_spline(make_smoothing_spline(s, way.rotation, lam=lam)) for lam in spread]


def _constant(value: float) -> RotationLaw:
    return lambda s: np.full(np.shape(s), value)


def _spline(spline: Callable[[Array], Array]) -> RotationLaw:
    return lambda s: np.asarray(spline(s))


def _inside_box(model: Model, followed: Followed, target: JointTarget) -> None:
    s = followed.joints.knots
    fine = np.concatenate([s, (s[:-1] + s[1:]) / 2])
    u = np.concatenate([followed.u, (followed.u[:-1] + followed.u[1:]) / 2])
    q = followed.joints(fine)
    excess = np.maximum(model.robot.q_min - q, q - model.robot.q_max)
    worst = int(np.argmax(excess.max(axis=1)))
    axis = int(np.argmax(excess[worst]))
    if excess[worst, axis] > 0:
        low, high = np.degrees([model.robot.q_min[axis], model.robot.q_max[axis]])
        raise UnreachableError(
            f"near point {target.point(u[worst])} axis {axis + 1} would need "
            f"{np.degrees(q[worst, axis]):.1f} deg, "
            f"{np.degrees(excess[worst, axis]):.1f} deg beyond its range {low:.0f} to {high:.0f} "
            "deg"
        )


def _cutting_at(curve: TaskCurve, moves: npt.NDArray[np.bool_], u: Array) -> npt.NDArray[np.bool_]:
    """Whether the tool may cut at curve parameters u, and right before and after, shape (n,)."""
    last = curve.segments - 1
    before = curve.origin[np.clip(np.ceil(u).astype(int) - 1, 0, last)]
    after = curve.origin[np.clip(np.floor(u).astype(int), 0, last)]
    return np.asarray(moves[before] | moves[after])


def _cutting_between(
    curve: TaskCurve, moves: npt.NDArray[np.bool_], u: Array
) -> npt.NDArray[np.bool_]:
    """Whether the tool may cut all the way between neighbouring parameters u, shape (n - 1,)."""
    allowed = moves[curve.origin]
    refused = np.concatenate([[0], np.cumsum(~allowed)])
    first = np.clip(np.floor(u[:-1] + 1e-9).astype(int), 0, curve.segments)
    last = np.clip(np.ceil(u[1:] - 1e-9).astype(int), 0, curve.segments)
    return np.asarray(refused[last] == refused[first])


def _clear(
    scene: Scene | None, followed: Followed, target: JointTarget, moves: npt.NDArray[np.bool_]
) -> Clearance | None:
    """How far a joint path stays from everything; refuses one that cannot be shown free."""
    if scene is None:
        return None
    cutting = _cutting_between(target.curve, moves, followed.u)
    found = continuous_clearance(scene, followed.joints, cutting)
    if found.free:
        return found
    u = float(np.interp(found.s, followed.joints.knots, followed.u))
    first, other = found.pair
    near = "touch" if found.value <= 0 else f"come within {1e3 * found.value:.2f} mm"
    wanted = f", {1e3 * scene.keep:g} mm are to be kept" if scene.keep else ""
    raise CollisionError(
        f"near point {target.point(u)} {first} and {other} {near}{wanted}; move the work "
        "frame, free the tool rotation, or change the cell"
    )
