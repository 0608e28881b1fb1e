"""`Narrow`: the exact distance of one pair of pieces, by coal (https://github.com/coal-library/coal).

Against a mesh coal is given meshes only: the axis of a capsule as one degenerate triangle, whose
radius is taken off the distance, a cylinder as the prism around it. Its trees of boxes are then
as tight as the shapes, and a query of 50,000 triangles takes 20 µs where a capsule as primitive
takes 5 ms and more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell.mesh import Surface
from irb2400_ctrl.cell.nested import Nested
from irb2400_ctrl.cell.piece import Piece
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Hull, Solid, Sphere

# sides of the prism around a cylinder: it stands out by 1/cos(pi/48) - 1 = 0.2 % of the radius
_SIDES = 48


@dataclass(frozen=True, eq=False)
class Narrow:
    """Two geometries of coal, and what is taken off their distance."""

    query: Any
    shapes: tuple[Any, Any]
    """of coal; the query only points to them"""
    first: Any
    """coal's pose of the first one; kept, because filling it is dearer than the call"""
    other: Any
    request: Any
    result: Any
    radii: float
    nested: Nested | None
    """of a mesh: whether one of the two lies wholly inside the other"""

    @classmethod
    def of(cls, piece: Piece, other: Piece, made: dict[Any, Any]) -> Narrow:
        """For a piece that moves and one that stands still.

        Args:
            piece: the one that moves.
            other: the one that stands still.
            made: triangles of coal by shape, filled here: a large mesh is built once.

        Raises:
            InputError: coal is not installed.
        """
        coal = load_coal()
        if isinstance(piece.shape, Surface) or isinstance(other.shape, Surface):
            for each in (piece, other):
                if each.shape not in made:
                    made[each.shape] = _triangles(coal, each)
            one, radius = made[piece.shape]
            two, other_radius = made[other.shape]
        else:
            one, radius = _primitive(coal, piece.shape)
            two, other_radius = _primitive(coal, other.shape)
        X = other.pose()
        return cls(
            coal.ComputeDistance(one, two),
            (one, two),
            coal.Transform3s(),
            coal.Transform3s(X[:3, :3], X[:3, 3]),
            coal.DistanceRequest(),
            coal.DistanceResult(),
            radius + other_radius,
            Nested(piece.shape, other.shape, X) if isinstance(other.shape, Surface) else None,
        )

    def distance(self, R: Array, p: Array) -> float:
        """Between the bodies, with the first one turned by R (3, 3) and at p (3,); zero or less
        where they touch, or one lies inside the other [m]."""
        self.first.setRotation(R)
        self.first.setTranslation(p)
        self.result.clear()
        found = float(self.query(self.first, self.other, self.request, self.result))
        if self.nested is not None and found > 0 and self.nested(R, p, found):
            return -found - self.radii
        return found - self.radii


def load_coal() -> Any:
    """The module.

    Raises:
        InputError: it is not installed.
    """
    try:
        import coal
    except ImportError as error:
        raise InputError(
            "a cell is checked with coal, which is not installed; pip install "
            "'irb2400_ctrl[cell]' (Linux and macOS: on Windows use conda, conda install coal)"
        ) from error
    return coal


def _primitive(coal: Any, shape: Solid | Surface) -> tuple[Any, float]:
    """A geometry of coal and the radius around it."""
    if isinstance(shape, Sphere):
        return coal.Sphere(shape.radius), 0.0
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, shape.length), 0.0
    if isinstance(shape, Cylinder):
        return coal.Cylinder(shape.radius, shape.length), 0.0
    if isinstance(shape, Hull):
        corners = coal.StdVec_Vec3s()
        for point in shape.points:
            corners.append(point)
        return coal.ConvexBase.convexHull(corners, True, "Qt"), 0.0
    assert isinstance(shape, Box)
    return coal.Box(*shape.size), 0.0


def _triangles(coal: Any, piece: Piece) -> tuple[Any, float]:
    """The same as triangles, and the radius around them."""
    shape = piece.shape
    radius = 0.0
    if isinstance(shape, Surface):
        points = shape.points
        triangles = shape.triangles
    elif isinstance(shape, Sphere | Capsule):
        half = shape.length / 2 if isinstance(shape, Capsule) else 0.0
        points = np.array([[0.0, 0.0, -half], [0.0, 0.0, half], [0.0, 0.0, half]])
        triangles = np.array([[0, 1, 2]])
        radius = shape.radius
    elif isinstance(shape, Cylinder):
        points, triangles = _prism(shape)
    elif isinstance(shape, Hull):
        points, triangles = _hull(shape.points)
    else:
        assert isinstance(shape, Box)
        points, triangles = _hull(_corners(shape.size / 2))
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(triangles), len(points))
    model.addVertices(np.ascontiguousarray(points))
    model.addTriangles(np.ascontiguousarray(triangles, dtype=np.uint32))
    model.endModel()
    return model, radius


def _corners(half: Array) -> Array:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return np.asarray(half * signs)


def _prism(shape: Cylinder) -> tuple[Array, Integers]:
    """A prism around a cylinder."""
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    out = shape.radius / np.cos(np.pi / _SIDES)
    ring = np.stack([out * np.cos(angle), out * np.sin(angle), 0 * angle], axis=1)
    lift = np.array([0.0, 0.0, shape.length / 2])
    return _hull(np.concatenate([ring - lift, ring + lift]))


def _hull(points: Array) -> tuple[Array, Integers]:
    from scipy.spatial import ConvexHull

    return points, np.asarray(ConvexHull(points).simplices, dtype=np.int64)
