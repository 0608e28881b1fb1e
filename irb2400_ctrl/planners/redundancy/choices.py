"""The joint path of a tool path: branch and tool rotation chosen, candidates compared."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import cutting_moves
from irb2400_ctrl.planners.redundancy.choice import (
    LONG,
    Choice,
    RotationLaw,
    clear,
    continuous_margins,
    given_way,
    stay_inside,
)
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.follow import (
    JointTarget,
    arc_length,
    follow,
    station_parameters,
)
from irb2400_ctrl.planners.redundancy.ladder_graph import (
    BOX_INSET,
    FREE_SHIFTS,
    ROOM,
    Ladder,
    LadderWay,
)
from irb2400_ctrl.planners.redundancy.ladder_refusal import refusal
from irb2400_ctrl.planners.redundancy.way_out import WayOut
from irb2400_ctrl.planners.redundancy.wrist_passage import Passing, passings
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

GRID = np.radians(np.arange(0.0, 360.0, 5.0))
MAX_STATIONS = 600
SMOOTH = (10.0, 40.0)
"""lengths over which a varying rotation is smoothed, as the whole path over them"""
ROUGH = (160.0, 640.0)
"""the same where the others leave the joint box"""


def choices(
    model: Model,
    orientation: Orientation,
    free: bool,
    keep: int = 3,
    scene: Scene | None = None,
    way_out: WayOut | None = None,
    load: CuttingLoad | None = None,
) -> Iterator[Choice]:
    """Joint paths inside the joint box that touch nothing, the most promising of each kind first.

    Args:
        orientation: the tool path, placed and smoothed.
        free: whether the tool may turn about its axis.
        keep: how many of each kind; of a path of more than LONG segments one, and no further kind
            once one is comfortable.
        scene: the arm in its cell; None where nothing is known of the space that it takes up.
        way_out: lines from its ends that the arm must reach along, too.
        load: a force on the tip that the choice should give way to little.

    Raises:
        UnreachableError: no way leads through; says at which point, which axis, by how much, or
            (CollisionError) what touches what.
    """
    curve = orientation.curve
    held = curve.full and not free
    u = stations(orientation)
    s = arc_length(curve, u)
    moves = cutting_moves(curve.path, orientation.spindle)
    ladder = Ladder.of(model, orientation, u, np.zeros(1) if held else GRID)
    if way_out is not None:
        ladder = way_out.kept(ladder, orientation)
    ladder = ladder.priced(scene, cutting_at(curve, moves, u), load)
    problem: UnreachableError | None = None
    count: Counter[str] = Counter()
    most = np.inf if held or curve.segments <= LONG else 1
    ways = _turned(_ways(ladder, free, keep), orientation, s, SMOOTH)
    options = _held(model, orientation, ladder) if held else ways
    if free and not held:
        # a rotation that has to change often may leave the box when it is smoothed
        roomy = _roomy(ladder, orientation, s, keep)
        options = itertools.chain(options, _unless(lambda: bool(count), roomy))
    for option in options:
        if count[option[0]] >= most:
            continue
        try:
            choice = _tried(model, option, scene, moves, load)
            if way_out is not None:
                way_out.check(model, orientation, choice.followed, scene)
        except UnreachableError as error:
            # its traceback would keep the ladder alive
            problem = problem or error.with_traceback(None)
            continue
        count[choice.kind] += 1
        yield choice
        if most == 1 and choice.comfortable:
            return
    if not count:
        raise problem or refusal(ladder, _names(curve, u))


def _tried(
    model: Model, option: _Option, scene: Scene | None, moves: Mask, load: CuttingLoad | None
) -> Choice:
    """The joint path of an option.

    Raises:
        UnreachableError: it leaves the joint box or, a CollisionError, touches something.
    """
    kind, branch, law, target, q_start, passing = option
    followed = follow(model, target, q_start)
    stay_inside(model, followed, target)
    clearance = clear(scene, followed, target, moves)
    margins = continuous_margins(model, followed)
    given = given_way(model, followed, load)
    return Choice(kind, branch, law, followed, margins, clearance, passing, given)


def _names(curve: TaskCurve, u: Array) -> Integers:
    """Way-point that each station leads to, the first to itself."""
    names = curve.origin[np.minimum(u.astype(int), curve.segments - 1)].copy()
    names[0] = 0
    return np.asarray(names)


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


def _unless(found: Callable[[], bool], options: Iterator[_Option]) -> Iterator[_Option]:
    """Further options, looked for as long as nothing is found."""
    while not found():
        option = next(options, None)
        if option is None:
            return
        yield option


def _roomy(ladder: Ladder, orientation: Orientation, s: Array, keep: int) -> Iterator[_Option]:
    """Varying rotations that keep away from the ends of the joint box, so that smoothing has room;
    less and less smoothed."""
    for inset in (ROOM, ladder.inset):
        found = replace(ladder, inset=inset).best(FREE_SHIFTS, keep=keep)
        ways = [("free rotation", way) for way in found]
        for part in (*SMOOTH, *ROUGH):
            yield from _turned(ways, orientation, s, (part,))


def _ways(ladder: Ladder, free: bool, keep: int) -> Iterator[tuple[str, LadderWay]]:
    """The best constant rotations and, if the rotation is free, the best varying ones."""
    for way in ladder.best((0,), per_rotation=True, keep=keep):
        yield "constant rotation", way
    for way in ladder.best(FREE_SHIFTS, keep=keep) if free else ():
        yield "free rotation", way


def _turned(
    ways: Iterable[tuple[str, LadderWay]],
    orientation: Orientation,
    s: Array,
    parts: tuple[float, ...],
) -> Iterator[_Option]:
    """Ways through the ladder, smoothed over these parts of the path."""
    for kind, way in ways:
        for law in _laws(s, way, kind, parts):
            branch = int(way.branch[0])
            yield kind, branch, law, JointTarget.of(orientation, law, branch), way.q_start, None


def stations(orientation: Orientation) -> Array:
    """Evenly spread stations, at most MAX_STATIONS, ends included."""
    curve = orientation.curve
    u = station_parameters(curve, 0.02)
    s = arc_length(curve, u)
    count = int(np.clip(np.ceil(s[-1] / 0.01), 40, MAX_STATIONS))
    even = np.interp(np.linspace(0, s[-1], count), s, u)
    even[0] = 0.0
    even[-1] = float(curve.segments)
    return even


def _laws(s: Array, way: LadderWay, kind: str, parts: tuple[float, ...]) -> list[RotationLaw]:
    """The rotation as a smooth function of the length: strongly, then more lightly smoothed."""
    if kind != "free rotation" or np.ptp(way.rotation) < 1e-9:
        return [_constant(float(way.rotation[0]))]
    from scipy.interpolate import make_smoothing_spline

    # penalty on the curvature of the rotation, by its length scale
    spread = [(s[-1] / f) ** 3 for f in parts]
    return [_spline(make_smoothing_spline(s, way.rotation, lam=lam)) for lam in spread]


def _constant(value: float) -> RotationLaw:
    return lambda s: np.full(np.shape(s), value)


def _spline(spline: Callable[[Array], Array]) -> RotationLaw:
    return lambda s: np.asarray(spline(s))


def cutting_at(curve: TaskCurve, moves: npt.NDArray[np.bool_], u: Array) -> npt.NDArray[np.bool_]:
    """Whether the tool may cut at curve parameters u, and right before and after, shape (n,)."""
    last = curve.segments - 1
    before = curve.origin[np.clip(np.ceil(u).astype(int) - 1, 0, last)]
    after = curve.origin[np.clip(np.floor(u).astype(int), 0, last)]
    return np.asarray(moves[before] | moves[after])
