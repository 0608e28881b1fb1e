"""`Nested`: whether a body and a mesh that do not cross lie one inside the other."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.mesh import Surface
from irb2400_ctrl.robot.shape import Box, Cylinder, Hull, Solid


class Nested:
    """One body, and a mesh that stands still.

    To see whether a point is inside a mesh costs a sum over all triangles. So what was seen is
    kept: around a point whose distance to all triangles is known, the whole ball is on the same
    side.
    """

    def __init__(self, body: Solid | Surface, mesh: Surface, X: Array) -> None:
        self._body = body
        self._mesh = mesh
        self._X = X
        self._seeds = mesh.seeds @ X[:3, :3].T + X[:3, 3]
        self._centres = np.empty((0, 3))
        self._radii = np.empty(0)
        self._sides = np.empty(0, dtype=bool)

    def __call__(self, R: Array, p: Array, gap: float) -> bool:
        """For the body turned by R (3, 3) and at p (3,), its surface or axis `gap` away from all
        triangles."""
        return self._inside(self._X[:3, :3].T @ (p - self._X[:3, 3]), gap) or self._around(R, p)

    def _inside(self, point: Array, gap: float) -> bool:
        """The body in the mesh, by its centre."""
        half = self._mesh.half_size
        # nothing inside is further from the surface than half of the thinnest side
        if (np.abs(point) > half).any() or gap > half.min():
            return False
        known = ((self._centres - point) ** 2).sum(axis=1) < self._radii**2
        if known.any():
            return bool(self._sides[int(np.argmax(known))])
        side = self._mesh.holds(point)
        self._centres = np.vstack([self._centres, point])
        self._radii = np.append(self._radii, gap)
        self._sides = np.append(self._sides, side)
        return side

    def _around(self, R: Array, p: Array) -> bool:
        """A piece of the mesh in the body. Capsules have no inside: their axis alone is compared
        with the triangles."""
        local = (self._seeds - p) @ R
        if isinstance(self._body, Cylinder):
            along = np.abs(local[:, 2]) < self._body.length / 2
            return bool((along & (np.hypot(local[:, 0], local[:, 1]) < self._body.radius)).any())
        if isinstance(self._body, Box):
            return bool((np.abs(local) < self._body.size / 2).all(axis=1).any())
        if isinstance(self._body, Hull):
            faces = self._body.faces
            return bool((local @ faces[:, :3].T + faces[:, 3] < 0).all(axis=1).any())
        return False
