"""All configurations of a general arm of six axes, as roots of its characteristic polynomial.

Axis 6, as a line, does not see joint 6: turned by joints 5, 4, 3 it lies where the pose puts it,
turned back by joints 1 and 2. A point p on a line and its direction d give fourteen numbers that
any motion of space maps linearly (Raghavan and Roth 1993),

    p, d, p.p, p.d, p x d, (p.p) d - 2 (p.d) p,

so that both sides are linear in 1, cos and sin of each of their angles. Six combinations are free
of joints 1 and 2. Written in x4 and x5, tangents of half the angles, and taken once as they are and
once times x4, they are twelve equations in the twelve products x4^i x5^j, whose coefficients are
quadratic in x3: an eigenvalue problem (Manocha and Canny 1994). Its real solutions are the
branches, sixteen at most.

Where axes meet or are parallel the problem is singular; that of an arm a hair displaced is not, and
its roots lie close to the true ones.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, rotations_about
from irb2400_ctrl.robot import Robot

IMAGINARY = 0.2
"""of the angle of joint 3, up to which a root counts as real: two branches about to meet may come
out as a complex pair [rad]"""
_ANGLES: Array = np.array([0.0, 2.0, 4.0]) * (np.pi / 3)
_FROM_SAMPLES = np.linalg.inv(np.column_stack([np.ones(3), np.cos(_ANGLES), np.sin(_ANGLES)]))
"""values at three angles -> coefficients of 1, cos, sin"""
_OF_HALF = np.array([[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 2.0, 0.0]])
"""rows 1, cos, sin times 1 + x^2, columns powers of x = tan(angle / 2)"""
_ZEROS = (0.7, -0.4, 1.1)
"""from where the halved angles of joints 3, 4, 5 count: half a turn from there is infinite, so no
usual angle may be there [rad]"""


class CharacteristicRoots:
    """Of one robot of six axes.

    Args:
        size: unit of length [m].
        displaced: each direction and point of an axis by so much, drawn [-]; nothing by default.
        seed: of that draw.
    """

    def __init__(self, robot: Robot, size: float, displaced: float = 0.0, seed: int = 0) -> None:
        self.robot: Robot = robot
        self.size: float = size
        X = np.eye(4)
        frames = []
        for link in robot.links:
            X = X @ link.frame.matrix()
            frames.append(X)
        drawn = displaced * np.random.default_rng(seed).normal(size=(2, 6, 3))
        z = np.array([frame[:3, 2] for frame in frames]) + drawn[0]
        p = np.array([frame[:3, 3] for frame in frames])
        self._origin: Array = p[2]
        self._z: Array = np.asarray(z / np.linalg.norm(z, axis=1, keepdims=True))
        """direction of each axis at theta = 0 in the base, shape (6, 3)"""
        self._p: Array = self._scaled(p) + drawn[1]
        """a point of each, from one of axis 3 and over the size, shape (6, 3)"""
        X_BF = X @ robot.flange.matrix()
        X_BF[:3, 3] = self._scaled(X_BF[:3, 3])
        self._back: Array = np.asarray(np.linalg.inv(X_BF))
        a, b, c = (self._turned(2 + k, _ANGLES + zero) for k, zero in enumerate(_ZEROS))
        self._wrist: Array = np.einsum(
            "ia,jb,kc,abcm->mijk",
            _FROM_SAMPLES,
            _FROM_SAMPLES,
            _FROM_SAMPLES,
            self._of_last_axis(a[:, None, None] @ b[:, None] @ c),
        )
        """the fourteen numbers, linear in 1, cos, sin of joints 3, 4, 5, shape (14, 3, 3, 3)"""
        arm = self._turned(0, _ANGLES)[:, None] @ self._turned(1, _ANGLES)
        self._base: Array = np.asarray(np.linalg.inv(arm))
        """back through joints 1 and 2, at three angles of each, shape (3, 3, 4, 4)"""

    def _scaled(self, p: Array) -> Array:
        return np.asarray((p - self._origin) / self.size)

    def _turned(self, joint: int, angle: Array) -> Array:
        """The motion of space by turns about an axis at theta = 0, shape (..., 4, 4)."""
        R = rotations_about(self._z[joint], angle)
        X = np.zeros((*R.shape[:-2], 4, 4))
        X[..., :3, :3] = R
        X[..., :3, 3] = self._p[joint] - R @ self._p[joint]
        X[..., 3, 3] = 1.0
        return X

    def _of_last_axis(self, X: Array) -> Array:
        """The fourteen numbers of axis 6 moved by X (..., 4, 4), shape (..., 14)."""
        d = X[..., :3, :3] @ self._z[5]
        p = X[..., :3, :3] @ self._p[5] + X[..., :3, 3]
        pp = (p * p).sum(axis=-1, keepdims=True)
        pd = (p * d).sum(axis=-1, keepdims=True)
        return np.concatenate([p, d, pp, pd, np.cross(p, d), pp * d - 2 * pd * p], axis=-1)

    def starts(self, X_BF: Array) -> tuple[Array, Integers]:
        """(q (k, 6), owner (k,)): configurations near the branches of poses (n, 4, 4), and of which
        pose; some lead nowhere.

        Raises:
            numpy.linalg.LinAlgError: the problem is singular.
        """
        to_go = np.array(X_BF, dtype=float)
        to_go[:, :3, 3] = self._scaled(to_go[:, :3, 3])
        to_go = to_go @ self._back
        pose = np.einsum(
            "ia,jb,nabm->nmij",
            _FROM_SAMPLES,
            _FROM_SAMPLES,
            self._of_last_axis(self._base @ to_go[:, None, None]),
        ).reshape(len(to_go), 14, 9)
        ranges, value, products = np.linalg.svd(pose[:, :, 1:])
        root, vector = _solved(self._without_arm(ranges[:, :, 8:], pose[:, :, 0]))
        # two angles of poles: half a turn and i, which is no angle
        angle = 2 * np.arctan(np.where(np.abs(root * root + 1) > 1e-9, root, 1e-3 + 1j))
        owner, number = np.nonzero(np.abs(angle.imag) < IMAGINARY)
        v = vector[owner, :12, number].reshape(-1, 4, 3)
        theta = np.zeros((len(owner), 6))
        theta[:, 2] = angle[owner, number].real
        theta[:, 3] = _half_tangent(v[:, :-1], v[:, 1:])
        theta[:, 4] = _half_tangent(v[:, :, :-1], v[:, :, 1:])
        theta[:, 2:5] += _ZEROS
        left = np.eye(4)
        for joint in (2, 3, 4):
            left = left @ self._turned(joint, theta[:, joint])
        # the products of cos and sin of joints 1 and 2, least squares
        rest = self._of_last_axis(left) - pose[owner, :, 0]
        rest = np.einsum("nm,nmk->nk", rest, ranges[owner, :, :8]) / (value[owner] + 1e-12)
        c2, s2, c1, _, _, s1 = np.einsum("nk,nkj->jn", rest, products[owner])[:6]
        theta[:, 0] = np.arctan2(s1, c1)
        theta[:, 1] = np.arctan2(s2, c2)
        arm = self._turned(0, theta[:, 0]) @ self._turned(1, theta[:, 1]) @ left
        R = (np.linalg.inv(arm) @ to_go[owner])[:, :3, :3]
        K = np.cross(np.eye(3), self._z[5])
        sine = np.einsum("nij,ij->n", R, K)
        theta[:, 5] = np.arctan2(sine, np.trace(R, axis1=1, axis2=2) - 1)
        q: Array = np.asarray(np.linalg.solve(self.robot.A, (theta - self.robot.offset).T).T)
        return q, np.asarray(owner, dtype=np.int64)

    def _without_arm(self, free: Array, constant: Array) -> Array:
        """Coefficients of 1, x3, x3^2 of the twelve equations, from the combinations free of joints
        1 and 2 (n, 14, 6) and the pose's constant (n, 14); shape (n, 3, 12, 12)."""
        A = np.einsum("nme,mijk->neijk", free, self._wrist)
        A[:, :, 0, 0, 0] -= np.einsum("nme,nm->ne", free, constant)
        powers = np.einsum("neijk,ia,jb,kc->naebc", A, _OF_HALF, _OF_HALF, _OF_HALF)
        M = np.zeros((len(free), 3, 12, 4, 3))
        M[:, :, :6, :3] = powers
        M[:, :, 6:, 1:] = powers
        return M.reshape(len(free), 3, 12, 12)


def _solved(M: Array) -> tuple[Array, Array]:
    """Roots x and vectors (v, x v) of (M0 + x M1 + x^2 M2) v = 0, shapes (n, 24) and (n, 24,
    24)."""
    companion = np.zeros((len(M), 24, 24))
    companion[:, :12, 12:] = np.eye(12)
    companion[:, 12:, :12] = -np.linalg.solve(M[:, 2], M[:, 0])
    companion[:, 12:, 12:] = -np.linalg.solve(M[:, 2], M[:, 1])
    return np.linalg.eig(companion)


def _half_tangent(a: Array, b: Array) -> Array:
    """The angle whose half has the tangent b / a, the best of all entries (n, i, j)."""
    along = 2 * (a * b.conj()).real.sum(axis=(1, 2))
    return np.asarray(np.arctan2(along, (np.abs(a) ** 2 - np.abs(b) ** 2).sum(axis=(1, 2))))
