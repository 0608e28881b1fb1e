"""`Geometry`: one shape that a file of another format draws on a link, and what it takes up."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import triangles_of
from irb2400_ctrl.robot.capsule_fit import half_sphere
from irb2400_ctrl.robot.importing.few_corners import few_corners
from irb2400_ctrl.robot.importing.mesh_file import found_mesh
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Hull, Solid, Sphere, place_and_turn

_HEAD = 100_000
"""bytes of a COLLADA file in which its unit stands"""
_BALL = 60
"""directions on half a ball"""
_LARGEST = 20.0
"""no link of an arm is as large [m]"""
_TOO_LARGE = (
    f"found it larger than {_LARGEST:g} m, expected metres; a mesh in millimetres needs "
    'scale="0.001 0.001 0.001"'
)


@dataclass(frozen=True, eq=False)
class Geometry:
    """A shape in the frame of its link."""

    kind: str
    """box, sphere, cylinder, capsule, ellipsoid, points, mesh, or what else the file says"""
    X: Array
    """pose of its frame in that of the link, shape (4, 4)"""
    size: tuple[float, ...] = ()
    """box: edges; sphere: radius; cylinder, capsule: radius, length of the axis (along z);
    ellipsoid: half axes [m]"""
    points: Array | None = None
    """corners that the file itself lists [m], shape (k, 3)"""
    file: str = ""
    """of a mesh, as the file names it"""
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)

    def shape(self, X: Array, folders: Sequence[Path]) -> Solid:
        """What it takes up, as a shape of the robot file: a mesh as a convex body around it.

        Args:
            X: pose of its link in the frame that the shape is stated in, shape (4, 4).
            folders: where meshes are looked for.

        Raises:
            InputError: a kind that is not known, a size that is none, a mesh that cannot be read.
        """
        X = X @ self.X
        if self.kind in {"mesh", "points", "ellipsoid"}:
            return _hull(self._points(folders) @ X[:3, :3].T + X[:3, 3], self.file or self.kind)
        if self.kind not in {"box", "sphere", "cylinder", "capsule"}:
            raise InputError(f"{self.kind or 'a shape without a kind'} is not read")
        size = 1e3 * np.array(self._size({"box": 3, "sphere": 1}.get(self.kind, 2)))
        place, turn = place_and_turn(X)
        if self.kind == "box":
            edges = tuple(size.tolist())
            return Box(kind="box", centre_mm=place, size_mm=edges, turn_deg=turn)
        if self.kind == "sphere":
            return Sphere(kind="sphere", centre_mm=place, radius_mm=size[0])
        half = X[:3, 2] * size[1] / 2
        first = tuple(place - half)
        last = tuple(place + half)
        of_kind = Cylinder if self.kind == "cylinder" else Capsule
        return of_kind.model_validate(
            {"kind": self.kind, "from_mm": first, "to_mm": last, "radius_mm": size[0]}
        )

    def _points(self, folders: Sequence[Path]) -> Array:
        """Points in its own frame [m], shape (k, 3)."""
        if self.kind == "mesh":
            path = found_mesh(self.file, folders)
            return triangles_of(path)[0] * _unit(path) * self.scale
        if self.kind == "points" and self.points is not None:
            return self.points * self.scale
        # an icosphere would do, too: the points of a ball that is 4 % larger
        half = half_sphere(_BALL)
        return 1.04 * np.concatenate([half, -half]) * self._size(3)

    def _size(self, count: int) -> tuple[float, ...]:
        size = np.array(self.size)
        if len(size) != count or not (np.isfinite(size) & (size > 0)).all():
            found = ", ".join(f"{value:g}" for value in size)
            raise InputError(f"{self.kind}: found the size ({found}) m, expected lengths above 0")
        if size.max() > _LARGEST:
            raise InputError(f"{self.kind}: {_TOO_LARGE}")
        return self.size


def _unit(path: Path) -> float:
    """Of a mesh [m]: COLLADA states it, the other formats of ROS are in metres."""
    if path.suffix.lower() != ".dae":
        return 1.0
    with path.open("rb") as file:
        found = re.search(rb'<unit[^>]*\bmeter="([^"]*)"', file.read(_HEAD))
    stated = b"1" if found is None else found[1]
    try:
        return float(stated)
    except ValueError as error:
        raise InputError(f"mesh {path}: found the unit {stated!r}, expected a number") from error


def _hull(points: Array, name: str) -> Hull:
    if len(points) < 4 or not np.isfinite(points).all():
        raise InputError(f"{name}: found {len(points)} points, expected a body of finite ones")
    if np.ptp(points, axis=0).max() > _LARGEST:
        raise InputError(f"{name}: {_TOO_LARGE}")
    corners = 1e3 * few_corners(points)
    return Hull.model_validate({"kind": "hull", "points_mm": np.round(corners, 1).tolist()})
