"""The joint path of a tool path: branch and tool rotation chosen, candidates compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.follow import Followed, RotationLaw, arc_length, follow, station_parameters
from irb2400_ctrl.planners.ladder import FREE_SHIFTS, Candidate, Ladder
from irb2400_ctrl.planners.margins import relative_margins
from irb2400_ctrl.planners.orientation import Orientation

Array = npt.NDArray[np.float64]

GRID = np.radians(np.arange(0.0, 360.0, 5.0))
MAX_STATIONS = 600


@dataclass(frozen=True)
class Choice:
    """A joint path and the way through the ladder it came from."""

    kind: str
    """"given orientation", "constant rotation" or "free rotation" """
    branch: int
    rotation: RotationLaw
    followed: Followed
    margin: float
    """smallest relative singularity margin over the joint path [-]"""


def choices(model: Model, orientation: Orientation, free: bool, keep: int = 3) -> Iterator[Choice]:
    """Joint paths inside the joint box, the most promising of each kind first.

    Raises:
        UnreachableError: no way leads through; says at which point, which axis, by how much.
    """
    curve = orientation.curve
    u = _stations(orientation)
    s = arc_length_at(orientation, u)
    held = curve.full and not free
    ladder = Ladder.of(model, orientation, u, np.zeros(1) if held else GRID)
    ways: list[tuple[str, Candidate]] = []
    if held:
        ways += [("given orientation", c) for c in ladder.best((0,), keep=keep)]
    else:
        ways += [("constant rotation", c) for c in ladder.best((0,), per_rotation=True, keep=keep)]
        if free:
            ways += [("free rotation", c) for c in ladder.best(FREE_SHIFTS, keep=keep)]
    problem: UnreachableError | None = None
    found = False
    for kind, way in ways:
        for law in _laws(s, way, kind):
            try:
                followed = follow(model, orientation, law, int(way.branch[0]), way.q_start)
                _inside_box(model, followed, orientation)
            except UnreachableError as error:
                problem = error
                continue
            found = True
            yield Choice(kind, int(way.branch[0]), law, followed, continuous_margin(model, followed))
    if not found:
        names = curve.origin[np.minimum(u.astype(int), curve.segments - 1)].copy()
        names[0] = 0
        raise problem or ladder.explain(names)


def continuous_margin(model: Model, followed: Followed) -> float:
    """Smallest relative margin over the path, looked at four times between stations."""
    s = followed.joints.knots
    fine = np.unique(np.concatenate([s[:-1] + f * np.diff(s) for f in (0, 0.25, 0.5, 0.75)] + [s[-1:]]))
    return float(relative_margins(model, followed.joints(fine)).min())


def arc_length_at(orientation: Orientation, u: Array) -> Array:
    """Length along the curve at any sorted parameters u, shape (n,) [m]."""
    every = np.unique(np.concatenate([u, np.arange(orientation.curve.segments + 1.0)]))
    return np.asarray(arc_length(orientation.curve, every)[np.searchsorted(every, u)])


def _stations(orientation: Orientation) -> Array:
    """Evenly spread stations, at most MAX_STATIONS, ends included."""
    curve = orientation.curve
    u = station_parameters(curve, 0.02)
    s = arc_length(curve, u)
    count = int(np.clip(np.ceil(s[-1] / 0.01), 40, MAX_STATIONS))
    even = np.interp(np.linspace(0, s[-1], count), s, u)
    even[0], even[-1] = 0.0, float(curve.segments)
    return even


def _laws(s: Array, way: Candidate, kind: str) -> list[RotationLaw]:
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


def _inside_box(model: Model, followed: Followed, orientation: Orientation) -> None:
    s = followed.joints.knots
    fine = np.concatenate([s, (s[:-1] + s[1:]) / 2])
    u = np.concatenate([followed.u, (followed.u[:-1] + followed.u[1:]) / 2])
    q = followed.joints(fine)
    excess = np.maximum(model.robot.q_min - q, q - model.robot.q_max)
    worst = int(np.argmax(excess.max(axis=1)))
    axis = int(np.argmax(excess[worst]))
    if excess[worst, axis] > 0:
        curve = orientation.curve
        point = int(curve.origin[min(int(u[worst]), curve.segments - 1)])
        low, high = np.degrees([model.robot.q_min[axis], model.robot.q_max[axis]])
        raise UnreachableError(
            f"near point {point + 1} axis {axis + 1} would need {np.degrees(q[worst, axis]):.1f} deg, "
            f"{np.degrees(excess[worst, axis]):.1f} deg beyond its range {low:.0f} to {high:.0f} deg"
        )
