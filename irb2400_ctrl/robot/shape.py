"""Solid shapes in millimetres: what links, tools and the things of a cell take up of space."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from irb2400_ctrl.arrays import Array, rotation_about
from irb2400_ctrl.robot.capsule_fit import capsule_around, half_sphere
from irb2400_ctrl.robot.numbers import Positive, Vector3
from irb2400_ctrl.table import Table

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull


class Solid(Table):
    """One convex body; in its own frame the axis of symmetry, if any, is z and the centre zero."""

    cuts: bool = False
    """of a tool: this part of it may touch part and stock while it cuts"""

    @abstractmethod
    def place(self) -> Array:
        """Pose of the shape's own frame in the frame that it is stated in [m], shape (4, 4)."""

    @abstractmethod
    def capsule(self) -> tuple[Array, float]:
        """Both ends (2, 3) and the radius of a capsule around it, in the stated frame [m]."""

    def corners(self) -> Array:
        """Points whose hull is around it, in the stated frame [m], shape (k, 3)."""
        (first, last), radius = self.capsule()
        half = half_sphere(60)
        ball = 1.04 * radius * np.concatenate([half, -half])
        return np.concatenate([first + ball, last + ball])

    @property
    def is_capsule(self) -> bool:
        """Whether `capsule` is the shape itself."""
        return False


class _Round(Solid):
    """Along a straight line, with a radius."""

    from_mm: Vector3
    to_mm: Vector3
    radius_mm: Positive

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if self.length < 1e-6:
            raise ValueError("from_mm and to_mm are the same point; expected a sphere, or a length")
        return self

    @property
    def ends(self) -> Array:
        """Both ends of the axis [m], shape (2, 3)."""
        return np.array([self.from_mm, self.to_mm]) / 1e3

    @property
    def length(self) -> float:
        """Of the axis [m]."""
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))

    @property
    def radius(self) -> float:
        """[m]"""
        return self.radius_mm / 1e3

    def place(self) -> Array:
        X = np.eye(4)
        X[:3, :3] = frame_along(self.ends[1] - self.ends[0])
        X[:3, 3] = self.ends.mean(axis=0)
        return X

    def capsule(self) -> tuple[Array, float]:
        return self.ends, self.radius


class Capsule(_Round):
    """All that is within a radius of the line from one point to the other."""

    kind: Literal["capsule"]

    @property
    def is_capsule(self) -> bool:
        return True


class Cylinder(_Round):
    """With flat ends at both points."""

    kind: Literal["cylinder"]


class Sphere(Solid):
    """All that is within a radius of a point."""

    kind: Literal["sphere"]
    centre_mm: Vector3 = (0.0, 0.0, 0.0)
    radius_mm: Positive

    @property
    def radius(self) -> float:
        """[m]"""
        return self.radius_mm / 1e3

    def place(self) -> Array:
        X = np.eye(4)
        X[:3, 3] = np.array(self.centre_mm) / 1e3
        return X

    def capsule(self) -> tuple[Array, float]:
        centre = np.array(self.centre_mm) / 1e3
        return np.array([centre, centre]), self.radius

    @property
    def is_capsule(self) -> bool:
        return True


class Box(Solid):
    """With its edges along x, y and z, turned about the fixed x, then y, then z."""

    kind: Literal["box"]
    centre_mm: Vector3
    size_mm: tuple[Positive, Positive, Positive]
    turn_deg: Vector3 = (0.0, 0.0, 0.0)

    @property
    def size(self) -> Array:
        """Lengths of the edges [m], shape (3,)."""
        return np.array(self.size_mm) / 1e3

    def place(self) -> Array:
        return pose(self.centre_mm, self.turn_deg)

    def corners(self) -> Array:
        signs = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T
        X = self.place()
        return np.asarray(signs * self.size @ X[:3, :3].T + X[:3, 3])

    def capsule(self) -> tuple[Array, float]:
        size = self.size
        axis = int(np.argmax(size))
        X = self.place()
        half = X[:3, axis] * size[axis] / 2
        across = np.delete(size, axis) / 2
        return np.array([X[:3, 3] - half, X[:3, 3] + half]), float(np.linalg.norm(across))


class Hull(Solid):
    """The convex hull of points."""

    kind: Literal["hull"]
    points_mm: tuple[Vector3, ...] = Field(min_length=4)

    @model_validator(mode="after")
    def _has_inside(self) -> Self:
        spread = np.linalg.svd(self.points, compute_uv=False)
        if spread[2] < 1e-6:
            raise ValueError("points_mm lie in a plane; expected a body")
        return self

    def __eq__(self, other: object) -> bool:
        """The same points; what was computed on the way does not count."""
        return isinstance(other, Hull) and self._stated == other._stated

    def __hash__(self) -> int:
        """Of the points."""
        return hash(self._stated)

    @property
    def _stated(self) -> tuple[tuple[Vector3, ...], bool]:
        return self.points_mm, self.cuts

    @cached_property
    def points(self) -> Array:
        """Its corners about the middle of the box around them [m], shape (k, 3)."""
        return np.array(self.points_mm) / 1e3 - self.place()[:3, 3]

    def place(self) -> Array:
        X = np.eye(4)
        stated = np.array(self.points_mm) / 1e3
        X[:3, 3] = (stated.min(axis=0) + stated.max(axis=0)) / 2
        return X

    def corners(self) -> Array:
        return self.points + self.place()[:3, 3]

    def capsule(self) -> tuple[Array, float]:
        ends, radius = self._around
        return ends + self.place()[:3, 3], radius

    @cached_property
    def faces(self) -> Array:
        """Outward normals and offsets: normal . x + offset <= 0 inside, shape (m, 4)."""
        return np.asarray(self._hull.equations)

    @cached_property
    def triangles(self) -> Array:
        """Corners of its surface, outwards, about the same middle [m], shape (m, 3, 3)."""
        corners = self.points[self._hull.simplices]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inwards = (across * self.faces[:, :3]).sum(axis=1) < 0
        corners[inwards] = corners[inwards][:, ::-1]
        return np.asarray(corners)

    @cached_property
    def _hull(self) -> ConvexHull:
        from scipy.spatial import ConvexHull

        return ConvexHull(self.points)

    @cached_property
    def _around(self) -> tuple[Array, float]:
        return capsule_around(self.points)


Shape = Annotated[Capsule | Cylinder | Sphere | Box | Hull, Field(discriminator="kind")]


def frame_along(direction: Array) -> Array:
    """A rotation whose third column points along a vector, shape (3, 3)."""
    z = direction / np.linalg.norm(direction)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def pose(place_mm: Sequence[float], turn_deg: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
    """(4, 4) [m]: moved by `place_mm`, turned about the fixed x, then y, then z."""
    X = np.eye(4)
    for axis, angle in enumerate(np.radians(turn_deg)):
        X[:3, :3] = rotation_about(axis, angle) @ X[:3, :3]
    X[:3, 3] = np.array(place_mm) / 1e3
    return X


def place_and_turn(X: Array) -> tuple[Vector3, Vector3]:
    """The (place [mm], turn [deg]) with `pose(place, turn)` = X, shape (4, 4)."""
    R = X[:3, :3]
    lift = np.hypot(R[0, 0], R[1, 0])
    if lift > 1e-9:
        turn = (np.arctan2(R[2, 1], R[2, 2]), np.arctan2(-R[2, 0], lift),
                np.arctan2(R[1, 0], R[0, 0]))  # fmt: skip
    else:  # x and z turn about the same axis: all of it to x
        turn = (np.arctan2(-R[1, 2], R[1, 1]), np.arctan2(-R[2, 0], lift), np.float64(0.0))
    x, y, z = (1e3 * X[:3, 3]).tolist()
    a, b, c = np.degrees(turn).tolist()
    return (x, y, z), (a, b, c)
