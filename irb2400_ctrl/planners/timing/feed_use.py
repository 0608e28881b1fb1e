"""`FeedUse`: where a motion holds the programmed feed, and what keeps it below elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, true_stretches
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.passing_times import passing_times, point_lengths
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.task_curve import SMOOTH_BEND, TaskCurve

# the feed counts as held from this part of it on [-]
HELD = 0.99
# a limit counts as reached from this part of it on [-]
_REACHED = 0.9
# places of a stretch at which the limits are looked at
_LOOKED_AT = 24
# stretches that are closer are told as one, and a corner so near makes a stretch its own [m]
_GAP = 5e-4
# stretches that are listed one by one
LISTED = 50


@dataclass(frozen=True)
class FeedStretch:
    """A stretch of the path that is driven below the programmed feed."""

    begin: float
    end: float
    """TCP's way from the start [m]"""
    time: tuple[float, float]
    """[s]"""
    point: int
    """number 1… of the way-point nearest to its slowest place"""
    slowest: float
    """TCP's speed there [m/s]"""
    feed: float
    """programmed there [m/s]"""
    limit: str
    """what is reached: "torque of axis 3", "speed of axis 4", "acceleration of axis 1", or
    "torque rate, jerk or the rows" """
    place: str
    """"start", "end", "corner" or "path" """

    def summary(self) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        return {
            "from_mm": 1e3 * self.begin,
            "to_mm": 1e3 * self.end,
            "from_s": self.time[0],
            "to_s": self.time[1],
            "point": self.point,
            "slowest_mm_s": 1e3 * self.slowest,
            "feed_mm_s": 1e3 * self.feed,
            "limit": self.limit,
            "place": self.place,
        }


@dataclass(frozen=True)
class FeedUse:
    """The programmed feed of a whole path."""

    programmed: float
    """length of the TCP's way with a programmed feed [m]"""
    held: float
    """length of it that is driven at the feed [m]"""
    stretches: tuple[FeedStretch, ...]
    """all others, in the order of the path"""

    @property
    def share(self) -> float:
        """Part of the programmed way that is driven at the feed [-]."""
        return self.held / self.programmed

    def lengths(self, of: str) -> dict[str, float]:
        """Length below the feed for each `limit` or `place` [m], longest first."""
        total: dict[str, float] = {}
        for stretch in self.stretches:
            name = str(getattr(stretch, of))
            total[name] = total.get(name, 0.0) + stretch.end - stretch.begin
        return dict(sorted(total.items(), key=lambda item: -item[1]))

    def summary(self) -> dict[str, Any]:
        """For `plan.json`; the slowest stretches one by one."""
        slowest = sorted(self.stretches, key=lambda part: part.slowest / part.feed)[:LISTED]
        listed = sorted(slowest, key=lambda part: part.begin)
        return {
            "programmed_mm": 1e3 * self.programmed,
            "share_at_feed": self.share,
            "below_by_limit_mm": {k: 1e3 * v for k, v in self.lengths("limit").items()},
            "below_by_place_mm": {k: 1e3 * v for k, v in self.lengths("place").items()},
            "stretches": [part.summary() for part in listed],
            "stretches_left_out": len(self.stretches) - len(listed),
        }


def _squared(law: TimeLaw, s: Array) -> tuple[Array, Array]:
    """Squared rate and acceleration of the parameter; near rest a spline may dip below zero by its
    rounding."""
    x, u = law.on(s)
    return np.maximum(x, 0.0), u


def feed_use(
    dynamics: PathDynamics, curve: TaskCurve, path: TaskPath, law: TimeLaw, limits: MotionLimits
) -> FeedUse | None:
    """Compare the TCP's speed with the feed in the middle of every cell of the law; None where no
    feed is programmed.

    What keeps a stretch below the feed is the limit that is used most on it.

    Args:
        dynamics: the arm's torque along the path.
        curve: with its programmed feed.
        path: the TCP along the joints.
        law: when the path is where.
        limits: of torque [Nm], speed and acceleration, and of their rates.
    """
    # in the middle of a cell the bound is the mean of those at its ends
    most = np.atleast_2d(path.feed(law.s)).mean(axis=0)
    stated = np.isfinite(most)
    if not stated.any():
        return None
    middle = (law.s[:-1] + law.s[1:]) / 2
    ratio = np.zeros(len(middle))
    ratio[stated] = np.sqrt(_squared(law, middle[stated])[0] / most[stated])
    length = np.diff(path.tcp.way(law.s))
    held = stated & (ratio >= HELD)
    parts = _joined(true_stretches(stated & ~held), np.concatenate([[0.0], np.cumsum(length)]))
    finder = _Finder(curve, path, law, middle, ratio)
    limit = _limits(dynamics, path, law, limits, middle, parts)
    stretches = [finder.stretch(a, b, k) for (a, b), k in zip(parts, limit, strict=True)]
    return FeedUse(float(length[stated].sum()), float(length[held].sum()), tuple(stretches))


@dataclass(frozen=True)
class _Finder:
    """What is known of the cells."""

    curve: TaskCurve
    path: TaskPath
    law: TimeLaw
    middle: Array
    ratio: Array
    """speed over feed in the middle of each cell"""

    def stretch(self, first: int, last: int, limit: str) -> FeedStretch:
        """Cells first to last - 1."""
        at = first + int(np.argmin(self.ratio[first:last]))
        speed = float(self._speeds[at])
        return FeedStretch(
            begin=float(self._way[first]),
            end=float(self._way[last]),
            time=(float(self.law.time[first]), float(self.law.time[last])),
            point=int(self._nearest[at]) + 1,
            slowest=speed,
            feed=float(self._feeds[at]),
            limit=limit,
            place=self._place(first, last),
        )

    @cached_property
    def _way(self) -> Array:
        """TCP's way at the grid points [m]."""
        return self.path.tcp.way(self.law.s)

    @cached_property
    def _speeds(self) -> Array:
        """Of the TCP in the middle of each cell [m/s]."""
        rate = self.path.tcp.velocity(self.middle, self.path.joints.piece(self.middle))
        return np.asarray(
            np.linalg.norm(rate, axis=1) * np.sqrt(_squared(self.law, self.middle)[0])
        )

    @cached_property
    def _feeds(self) -> Array:
        """Programmed in the middle of each cell [m/s]."""
        followed = self.path.followed
        u = np.interp(self.middle, followed.joints.knots, followed.u)
        segment = np.minimum(u.astype(int), self.curve.segments - 1)
        return np.asarray(self.curve.path.feed[self.curve.origin[segment]])

    @cached_property
    def _places(self) -> Array:
        """Where the way-points are passed [m]."""
        return point_lengths(self.curve, self.path.followed)

    @cached_property
    def _nearest(self) -> Integers:
        """Index of the way-point nearest to the middle of each cell."""
        after = np.clip(np.searchsorted(self._places, self.middle), 1, len(self._places) - 1)
        gaps = [np.abs(self._places[after - k] - self.middle) for k in (1, 0)]
        return np.where(gaps[0] < gaps[1], after - 1, after)

    @cached_property
    def _turns(self) -> Array:
        """Where the path leads round corners [m]."""
        return self._places[_corners(self.curve)]

    def _place(self, first: int, last: int) -> str:
        """Whether the stretch starts or ends the motion, or leads round a corner."""
        if first == 0:
            return "start"
        if last == len(self.middle):
            return "end"
        ends = self.law.s[[first, last]] + np.array([-_GAP, _GAP])
        low, high = np.searchsorted(self._turns, ends)
        return "corner" if high > low else "path"


def _limits(
    dynamics: PathDynamics,
    path: TaskPath,
    law: TimeLaw,
    limits: MotionLimits,
    middle: Array,
    parts: list[tuple[int, int]],
) -> list[str]:
    """Of each stretch the limit, and the axis, of which most is used."""
    if not parts:
        return []
    # two dozen places tell as much as all of them
    cells = [np.unique(np.linspace(a, b - 1, min(b - a, _LOOKED_AT)).astype(int)) for a, b in parts]
    first = np.concatenate([[0], np.cumsum([len(c) for c in cells])[:-1]])
    at = middle[np.concatenate(cells)]
    x, u = _squared(law, at)
    rate = path.joints(at, 1)
    qd = rate * np.sqrt(x)[:, None]
    qdd = path.joints(at, 2) * x[:, None] + rate * u[:, None]
    tau = dynamics.torque(path.joints(at), qd, qdd, passing_times(law, at))
    used = np.stack(
        [
            np.abs(tau) / limits.tau_max,
            np.abs(qd) / limits.qd_max,
            np.abs(qdd) / limits.qdd_max,
        ],
        axis=1,
    )
    most = np.maximum.reduceat(used, first, axis=0)
    return [_named(row, limits.smooth, dynamics) for row in most]


def _named(used: Array, smooth: bool, dynamics: PathDynamics) -> str:
    """The largest of the shares (torque, speed, acceleration) x axes."""
    if smooth and used.max() < _REACHED:
        return "torque rate, jerk or the rows"
    kind, axis = np.unravel_index(int(np.argmax(used)), used.shape)
    own = axis < dynamics.model.robot.n
    kinds = ("torque" if own else "acceleration", "speed", "acceleration")
    return f"{kinds[int(kind)]} of {dynamics.axis(int(axis))}"


def _joined(parts: Integers, way: Array) -> list[tuple[int, int]]:
    """Stretches (k, 2) of cells, of the first and the one after the last, with less than `_GAP`
    between them as one."""
    found: list[tuple[int, int]] = []
    for first, last in parts.tolist():
        if found and way[first] - way[found[-1][1]] < _GAP:
            found[-1] = (found[-1][0], last)
        else:
            found.append((first, last))
    return found


def _corners(curve: TaskCurve) -> Integers:
    """Way-points at which the path turns by more than what counts as smooth."""
    position = curve.path.position
    side = np.diff(position, axis=0)
    length = np.linalg.norm(side, axis=1)
    moved = np.flatnonzero(length > 1e-7)
    way = side[moved] / length[moved, None]
    bend = np.linalg.norm(np.diff(way, axis=0), axis=1)
    return np.asarray(moved[1:][bend > SMOOTH_BEND])
