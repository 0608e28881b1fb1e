"""A joint path between two configurations whose TCP stays above the clearance plane."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import CollisionError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import Clearance, continuous_clearance
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.joint_box import outside_box
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.way_around import ways_around

# how far below the plane the TCP may come [m]
_SAG = 1e-3
_SAMPLES = 65
# bends of the path: how often they are tried, and by how much they grow
_TRIES = 14
_GROWTH = 1.35
# first lift of a line that is high enough, but not free [m]
_LIFT = 0.02
# usual room on a way around, twice [m]
_ROOM = 0.02
# cells in which the height is enclosed
_CELLS = 64


def raised_path(
    model: Model,
    q_from: Array,
    q_to: Array,
    plane: ClearancePlane,
    scene: Scene | None = None,
) -> JointPath:
    """The straight line in joint space, or the least bent parabola over it that stays above, or
    else a way around what is touched (`ways_around`).

        q(t) = q_from + t (q_to - q_from) + 4 t (1 - t) bend,   0 <= t <= 1

    The bend is along what raises the TCP most at the line's lowest place, with the first three axes
    (the arm), or with all.

    Args:
        scene: the arm in its cell, which the path may not touch, either.

    Raises:
        UnreachableError: all that was tried leaves the joint box or stays too low.
        CollisionError: what does not touches something.
    """
    floor = _floor(model, q_from, q_to, plane)
    line = _parabola(q_from, q_to, np.zeros_like(q_from))
    touched: Clearance | None = None
    if _lowest_sample(model, line, plane) >= floor:
        touched = touching(scene, line)
        if touched is None:
            return line
    for moved in (3, len(q_from)):
        bend = _raising(model, line, plane, floor, moved)
        for _ in range(_TRIES):
            path = _parabola(q_from, q_to, bend)
            if outside_box(model, path(path.length * _places())) is not None:
                break
            if _lowest_sample(model, path, plane) >= floor:
                touched = touching(scene, path)
                if touched is None:
                    return path
            bend = _GROWTH * bend
    _stands_free(scene, q_from, q_to)
    room = _Room.between(model, q_from, q_to, plane, scene)
    for path in ways_around(q_from, q_to, (model.robot.q_min, model.robot.q_max), room.free):
        if _lowest_sample(model, path, plane) >= floor and touching(scene, path) is None:
            return path
    if touched is not None:
        first, other = touched.pair
        raise CollisionError(
            f"the move of the joints between two operations brings {first} and {other} together, "
            "no bent one stays free, and no way around was found; move the work frame, or give "
            "another --clearance or --start"
        )
    depth = 1e3 * (floor - _lowest_sample(model, line, plane))
    raise UnreachableError(
        f"the move of the joints between two operations would bring the tool {depth:.0f} mm below "
        "the clearance plane, and no other one inside the joint box stays above it; move the work "
        "frame, or give another --clearance or --start"
    )


@dataclass(frozen=True)
class _Room:
    """Where an arm may stand on its way around."""

    model: Model
    plane: ClearancePlane
    floor: float
    scene: Scene | None
    room: float
    """kept free beyond what is asked for, for what lies between the places looked at [m]"""

    @classmethod
    def between(
        cls, model: Model, q_from: Array, q_to: Array, plane: ClearancePlane, scene: Scene | None
    ) -> _Room:
        """With half the room of the ends, where that is less than usual."""
        some = cls(model, plane, _floor(model, q_from, q_to, plane), scene, _ROOM)
        return replace(some, room=min(some.left(np.array([q_from, q_to])), _ROOM) / 2)

    def left(self, q: Array) -> float:
        """Least room at q (m, n), as far as it is of interest [m]."""
        if self.scene is None:
            return np.inf
        kept = np.full(self.scene.pairs, self.scene.keep)
        still = np.zeros(len(q), dtype=bool)
        return float(self.scene.clearance(q, still, 2 * self.room, None, kept).min())

    def free(self, q: Array) -> bool:
        """Whether all of q (m, n) are above the plane and have the room."""
        heights = self.plane.above(self.model.tcp_pose(q)[:, :3, 3])
        return bool(heights.min() >= self.floor) and self.left(q) > self.room


def _stands_free(scene: Scene | None, *ends: Array) -> None:
    """Raise a CollisionError where the arm touches something before it moves at all."""
    for q in ends:
        touched = touching(scene, _parabola(q, q, np.zeros_like(q)))
        if touched is not None:
            first, other = touched.pair
            angles = ", ".join(f"{angle:.4g}" for angle in np.degrees(q))
            raise CollisionError(
                f"{first} and {other} touch where a move of the joints begins or ends, at {angles} "
                "deg; give another --start, or look whether the cell is where it should be"
            )


def touching(scene: Scene | None, path: JointPath) -> Clearance | None:
    """What a joint path cannot be shown free of; None where it is free, or nothing is known."""
    found = clearance_of(scene, path)
    return None if found is None or found.free else found


def clearance_of(scene: Scene | None, path: JointPath) -> Clearance | None:
    """How far a joint path stays from everything, the tool's cutting part included; None where that
    is not known."""
    if scene is None:
        return None
    return continuous_clearance(scene, path, None)


def lowest(tcp: TcpPath, plane: ClearancePlane) -> float:
    """Lower bound of the TCP's height over the plane along a whole joint path [m]."""
    knots = tcp.joints.knots
    s = np.linspace(knots[0], knots[-1], _CELLS + 1)
    place = tcp.enclosed(np.stack([s[:-1], s[1:]]))[0]
    return float(((place.points @ plane.up).min(axis=1) - place.miss).min()) - plane.height


def _floor(model: Model, q_from: Array, q_to: Array, plane: ClearancePlane) -> float:
    """Height over the plane that the path may not fall below: zero, or that of its lower end."""
    ends = plane.above(model.tcp_pose(np.array([q_from, q_to]))[:, :3, 3])
    return min(0.0, float(ends.min())) - _SAG


def _parabola(q_from: Array, q_to: Array, bend: Array) -> JointPath:
    """Over s from 0 to the joints' distance (1 m for 1 rad)."""
    length = max(float(np.linalg.norm(q_to - q_from)), 1e-6)
    step = q_to - q_from
    coefficients = [q_from, (step + 4 * bend) / length, -4 * bend / length**2, 0 * bend]
    return JointPath(np.array([0.0, length]), np.array(coefficients)[:, None])


def _places() -> Array:
    return np.linspace(0.0, 1.0, _SAMPLES)


def _heights(model: Model, path: JointPath, plane: ClearancePlane) -> Array:
    return plane.above(model.tcp_pose(path(path.length * _places()))[:, :3, 3])


def _lowest_sample(model: Model, path: JointPath, plane: ClearancePlane) -> float:
    return float(_heights(model, path, plane).min())


def _raising(
    model: Model, line: JointPath, plane: ClearancePlane, floor: float, moved: int
) -> Array:
    """Change of the joints that lifts the line's lowest place to the floor, with the first `moved`
    axes."""
    heights = _heights(model, line, plane)
    at = int(np.argmin(heights))
    q = line(line.length * _places()[at : at + 1])[0]
    slope = plane.up @ model.tcp_jacobian(q)[:3]
    slope[moved:] = 0.0
    # a line that is high enough is bent because it touches something
    depth = max(floor - heights[at], _LIFT)
    return np.asarray(1.1 * depth * slope / max(float(slope @ slope), 1e-9))
