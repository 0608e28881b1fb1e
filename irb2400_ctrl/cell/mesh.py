"""Triangles of a file as a `Surface`; trimesh reads the file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell.description import Mesh
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import triangles_of
from irb2400_ctrl.robot.shape import pose

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 0.0254}
"""[m]"""
# no thing in a cell is smaller or larger than this: its unit is wrong [m]
SMALLEST = 1e-3
LARGEST = 50.0
# one without a stated unit that would be smaller is likelier one of metres [m]
SMALLEST_UNSTATED = 0.02


@dataclass(frozen=True, eq=False)
class Surface:
    """A closed or open surface of triangles, about its own centre."""

    points: Array
    """[m], shape (k, 3)"""
    triangles: Integers
    """numbers of points, shape (m, 3)"""
    X: Array
    """pose of the centre in the stated frame, shape (4, 4)"""
    closed: bool
    """it has an inside"""

    @cached_property
    def half_size(self) -> Array:
        """Half the edges of the box around it [m], shape (3,)."""
        return np.asarray(np.abs(self.points).max(axis=0))

    @cached_property
    def seeds(self) -> Array:
        """A point of each of its separate pieces [m], shape (k, 3)."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        first, other, third = self.triangles.T
        rows = np.concatenate([first, other])
        columns = np.concatenate([other, third])
        size = len(self.points)
        links = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(size, size))
        _, piece = connected_components(links, directed=False)
        used = np.unique(self.triangles)
        return np.asarray(self.points[used[np.unique(piece[used], return_index=True)[1]]])

    def place(self) -> Array:
        """Pose of its own frame in the stated one, shape (4, 4)."""
        return self.X

    def capsule(self) -> tuple[Array, float]:
        """Both ends (2, 3) and the radius of a capsule around it, in the stated frame [m]."""
        axis = int(np.argmax(self.half_size))
        reach = self.X[:3, axis] * self.half_size[axis]
        across = np.delete(self.half_size, axis)
        return np.array([self.X[:3, 3] - reach, self.X[:3, 3] + reach]), float(
            np.linalg.norm(across)
        )

    def holds(self, point: Array) -> bool:
        """Whether a point (3,) in its own frame lies inside; never inside an open surface.

        The triangles' solid angles seen from the point add up to 4 pi inside and to zero outside
        (van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
        """
        if not self.closed or (np.abs(point) > self.half_size).any():
            return False
        a, b, c = ((self.points - point)[self.triangles[:, k]] for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=1)
        flat = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        return bool(abs(2 * np.arctan2(volume, flat).sum()) > 2 * np.pi)


def read_mesh(mesh: Mesh, folder: Path) -> Surface:
    """The surface of a mesh of a cell.

    Raises:
        InputError: trimesh is not installed, no such file, or nothing in it but air.
    """
    path = folder / mesh.file
    if not path.is_file():
        raise InputError(
            f"mesh {path}: found nothing, expected an STL file; its place is relative to the cell "
            "file"
        )
    points, triangles, closed = triangles_of(path)
    points = UNITS[mesh.unit] * points
    _look_at_size(mesh, path, float(np.ptp(points, axis=0).max()))
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    X = pose(mesh.place_mm, mesh.turn_deg)
    X[:3, 3] += X[:3, :3] @ centre
    return Surface(points - centre, triangles, X, closed)


def _look_at_size(mesh: Mesh, path: Path, size: float) -> None:
    """Whether a thing of this size [m] is one that stands in a cell."""
    if not SMALLEST <= size <= LARGEST:
        raise InputError(
            f"mesh {path}: found a thing of {1e3 * size:.3g} mm with unit = {mesh.unit!r}, "
            f"expected one of {1e3 * SMALLEST:g} mm to {LARGEST:g} m; STL states no unit: is it "
            f"another of {', '.join(UNITS)}?"
        )
    if "unit" not in mesh.model_fields_set and size < SMALLEST_UNSTATED:
        raise InputError(
            f"mesh {path}: found a thing of {1e3 * size:.3g} mm, taken for millimetres because no "
            f"unit is stated, expected {1e3 * SMALLEST_UNSTATED:g} mm or more; STL knows no unit: "
            'write unit = "inch" or "m" beside its file, or unit = "mm" where it is so small'
        )
