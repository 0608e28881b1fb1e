"""`ExternalAxes`: axes beside the arm that carry the part, or the arm, and move while it works.

As the arm sees it the first axis stands on the floor, each further one on the one before, the part
on the last:

    X_BW(e) = A_1(e_1) … A_k(e_k) X_BW(0),   A_i the turn about a line stated at zero angles.

A rail under the arm is the first axis: all else slides the other way, A_1(e) p = p + e d with d
against the way of the carriage. For the part the arm stands on the floor of a chain whose joints
are these axes, the last one first: what is seen from it is X = (A_1 … A_k)^-1 X_B.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, rotations_about

RAIL = ("rail",)
TABLE = ("tilt", "turn")


def axis_names(count: int, slides: int) -> tuple[str, ...]:
    """Of so many axes, of which the first is a rail where `slides` is 1."""
    return RAIL[:slides] + TABLE[: count - slides]


@dataclass(frozen=True, eq=False)
class ExternalAxes:
    """k axes; limits are those of the cell file, inf where it states none. Where the first one is a
    rail, metres stand in place of its radians."""

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
    slides: int = 0
    """1 where the first axis is a rail under the arm, else 0"""

    def __len__(self) -> int:
        return len(self.names)

    @property
    def carriage(self) -> tuple[float, float, float] | None:
        """Where the base of the arm goes per metre of a rail; None without one."""
        if not self.slides:
            return None
        x, y, z = (-float(v) for v in self.direction[0])
        return x, y, z

    @property
    def turning(self) -> ExternalAxes:
        """Those that turn the part, with the carriage of a rail at zero."""
        return self._of(slice(self.slides, None), 0)

    @property
    def rail(self) -> ExternalAxes:
        """The rail alone; no axes where there is none."""
        return self._of(slice(0, self.slides), self.slides)

    def _of(self, which: slice, slides: int) -> ExternalAxes:
        """Some of the axes."""
        return ExternalAxes(
            names=self.names[which],
            direction=self.direction[which],
            point=self.point[which],
            low=self.low[which],
            high=self.high[which],
            speed=self.speed[which],
            acceleration=self.acceleration[which],
            jerk=self.jerk[which],
            slides=slides,
        )

    def behind(self, first: ExternalAxes | None) -> ExternalAxes:
        """These axes, carried by others."""
        if first is None:
            return self
        return ExternalAxes(
            names=first.names + self.names,
            direction=np.concatenate([first.direction, self.direction]),
            point=np.concatenate([first.point, self.point]),
            low=np.append(first.low, self.low),
            high=np.append(first.high, self.high),
            speed=np.append(first.speed, self.speed),
            acceleration=np.append(first.acceleration, self.acceleration),
            jerk=np.append(first.jerk, self.jerk),
            slides=first.slides,
        )

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

    def from_shown(self, values: Array) -> Array:
        """Degrees, and mm of a rail, (m, k) in radians and metres."""
        unit = np.full(len(self), np.pi / 180)
        unit[: self.slides] = 1e-3
        return np.asarray(values * unit)

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
        base while the axes turn by de; all of shape (m, 3), angles (m, k).

        Args:
            e: places of the axes [rad, m of a rail].
            de: their speeds [rad/s, m/s].
            place: in the base [m].
            velocity: in the base [m/s].
        """
        p = place
        v = velocity
        for i in range(len(self)):
            if i < self.slides:
                p = p - e[:, i : i + 1] * self.direction[i]
                v = v - de[:, i : i + 1] * self.direction[i]
                continue
            R = self._turn(i, e[:, i])[:, :3, :3].transpose(0, 2, 1)
            arm = p - self.point[i]
            v = v - de[:, i : i + 1] * np.cross(self.direction[i], arm)
            p = self.point[i] + np.einsum("mij,mj->mi", R, arm)
            v = np.einsum("mij,mj->mi", R, v)
        return v

    def levers(self, reach: float) -> Array:
        """How far from each axis a point can be that is at most `reach` [m] from the origin of the
        base, wherever the other axes stand, shape (k,) [m]; 1 of a rail, whose metres are metres
        of every point."""
        return np.array(
            [
                1.0 if i < self.slides else self._away(np.zeros(3), 0, i) + reach
                for i in range(len(self))
            ]
        )

    def _away(self, place: Array, j: int, i: int) -> float:
        """Largest distance of a place from axis i, wherever axes j … i - 1 have taken it: the foot
        of the place on axis j stays where it is when that one turns; a rail takes it from the
        middle of its way half of that."""
        if j < min(self.slides, i):
            middle = place - (self.low[j] + self.high[j]) / 2 * self.direction[j]
            return float(self.high[j] - self.low[j]) / 2 + self._away(middle, j + 1, i)
        offset = place - self.point[j]
        foot = self.point[j] + (offset @ self.direction[j]) * self.direction[j]
        gap = float(np.linalg.norm(place - foot))
        return gap if j == i else gap + self._away(foot, j + 1, i)

    def _turn(self, i: int, angle: Array) -> Array:
        """Turns about one axis, shape (m, 4, 4); shifts along a rail."""
        k = self.direction[i]
        if i < self.slides:
            shifted = np.tile(np.eye(4), (len(angle), 1, 1))
            shifted[:, :3, 3] = angle[:, None] * k
            return shifted
        X = np.zeros((len(angle), 4, 4))
        X[:, :3, :3] = rotations_about(k, angle)
        X[:, :3, 3] = self.point[i] - X[:, :3, :3] @ self.point[i]
        X[:, 3, 3] = 1.0
        return X
