"""`ExternalAxes`: turning axes beside the arm that carry the part, and move while the arm works.

The first axis stands on the floor, each further one on the one before, the part on the last:

    X_BW(e) = A_1(e_1) … A_k(e_k) X_BW(0),   A_i the turn about a line stated at zero angles.

For the part the arm stands on the floor of a chain whose joints are these axes, the last one first:
what is seen from it is X = (A_1 … A_k)^-1 X_B.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array


@dataclass(frozen=True, eq=False)
class ExternalAxes:
    """k axes; limits are those of the cell file, inf where it states none."""

    names: tuple[str, ...]
    direction: Array
    """unit vectors in the robot base, at zero angles, shape (k, 3)"""
    point: Array
    """a place on each axis, at zero angles [m], shape (k, 3)"""
    low: Array
    high: Array
    """[rad], shape (k,)"""
    speed: Array
    """[rad/s], shape (k,)"""
    acceleration: Array
    """[rad/s2], shape (k,)"""
    jerk: Array
    """[rad/s3], shape (k,)"""

    def __len__(self) -> int:
        return len(self.names)

    @property
    def plate(self) -> Array:
        """Frame of the plate at zero angles in the base: its origin the stated place of the last
        axis, z along it, x as near to that of the base (or y) as may be, shape (4, 4)."""
        z = self.direction[-1]
        x = np.eye(3)[0] if abs(z[0]) < 0.9 else np.eye(3)[1]
        x = x - (x @ z) * z
        x /= np.linalg.norm(x)
        X = np.eye(4)
        X[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
        X[:3, 3] = self.point[-1]
        return X

    def turned(self, e: Array) -> Array:
        """A_1 … A_k at angles e (m, k) [rad]: what they do to a pose at zero angles, shape (m, 4,
        4)."""
        X = np.tile(np.eye(4), (len(e), 1, 1))
        for i in range(len(self)):
            X = X @ self._turn(i, e[:, i])
        return X

    def seen(self, e: Array, X: Array) -> Array:
        """Poses in the base (m, 4, 4) as the part sees them, where it was at zero angles."""
        M = self.turned(e)
        found = X.copy()
        R = M[:, :3, :3].transpose(0, 2, 1)
        found[:, :3, :3] = R @ X[:, :3, :3]
        found[:, :3, 3] = np.einsum("mij,mj->mi", R, X[:, :3, 3] - M[:, :3, 3])
        return found

    def velocity_seen(self, e: Array, de: Array, place: Array, velocity: Array) -> Array:
        """Velocity, as the part sees it, of what is at `place` and moves with `velocity` in the
        base while the axes turn by de; all of shape (m, 3), angles (m, k)."""
        p = place
        v = velocity
        for i in range(len(self)):
            R = self._turn(i, e[:, i])[:, :3, :3].transpose(0, 2, 1)
            arm = p - self.point[i]
            v = v - de[:, i : i + 1] * np.cross(self.direction[i], arm)
            p = self.point[i] + np.einsum("mij,mj->mi", R, arm)
            v = np.einsum("mij,mj->mi", R, v)
        return v

    def levers(self, reach: float) -> Array:
        """How far from each axis a point can be that is at most `reach` [m] from the origin of the
        base, wherever the other axes stand, shape (k,) [m]."""
        return np.array([self._away(np.zeros(3), 0, i) + reach for i in range(len(self))])

    def _away(self, place: Array, j: int, i: int) -> float:
        """Largest distance of a place from axis i, wherever axes j … i - 1 have taken it: the foot
        of the place on axis j stays where it is when that one turns."""
        offset = place - self.point[j]
        foot = self.point[j] + (offset @ self.direction[j]) * self.direction[j]
        gap = float(np.linalg.norm(place - foot))
        return gap if j == i else gap + self._away(foot, j + 1, i)

    def _turn(self, i: int, angle: Array) -> Array:
        """Turns about one axis, shape (m, 4, 4) (Rodrigues)."""
        k = self.direction[i]
        K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        X = np.zeros((len(angle), 4, 4))
        s = np.sin(angle)[:, None, None]
        c = np.cos(angle)[:, None, None]
        X[:, :3, :3] = np.eye(3) + s * K + (1 - c) * (K @ K)
        X[:, :3, 3] = self.point[i] - X[:, :3, :3] @ self.point[i]
        X[:, 3, 3] = 1.0
        return X
