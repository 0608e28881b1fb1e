"""Numpy's arrays: names for their types, one for each kind of element, and algebra with them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Integers = npt.NDArray[np.int64]


def inner_products(a: Array, b: Array) -> Array:
    """Of the vectors in the last axis; numpy's sum over a short axis takes several times as
    long."""
    return np.asarray(np.einsum("...k,...k->...", a, b))


def norms(a: Array) -> Array:
    """Lengths of the vectors in the last axis."""
    return np.sqrt(inner_products(a, a))


def rms(values: Array) -> Array:
    """Of each column (m, n): shape (n,)."""
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


def true_stretches(mask: Mask) -> Integers:
    """[start, stop) of every stretch in which a mask (m,) is true, shape (k, 2)."""
    edges = np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8))
    return np.flatnonzero(edges).reshape(-1, 2)


def less_turns(angle: Array) -> Array:
    """The same angles less whole turns, within half a turn of zero [rad]."""
    return np.asarray(angle - 2 * np.pi * np.round(angle / (2 * np.pi)))


def cross_matrices(v: Array) -> Array:
    """[v x] of vectors (k, 3): [v x] a is their cross product with a, shape (k, 3, 3)."""
    K = np.zeros((len(v), 3, 3))
    K[:, 0, 1] = -v[:, 2]
    K[:, 0, 2] = v[:, 1]
    K[:, 1, 2] = -v[:, 0]
    return K - np.swapaxes(K, 1, 2)


def rotation_about(index: int, angle: float) -> Array:
    """The rotation about x, y or z (0, 1, 2) by an angle [rad], shape (3, 3)."""
    a = (index + 1) % 3
    b = (index + 2) % 3
    R = np.eye(3)
    R[a, a] = R[b, b] = np.cos(angle)
    R[a, b] = -np.sin(angle)
    R[b, a] = np.sin(angle)
    return R


def rotations_about(axis: Array, angle: Array | float) -> Array:
    """Rotations about a unit vector (3,) by angles (...,) [rad] (Rodrigues), shape (..., 3, 3)."""
    K = np.cross(np.eye(3), axis)
    a = np.asarray(angle)[..., None, None]
    return np.asarray(np.eye(3) + np.sin(a) * K + (1 - np.cos(a)) * (K @ K))


def rotation_onto(a: Array, b: Array) -> Array:
    """The smallest rotation of a unit vector onto another, not its opposite, shape (3, 3)."""
    K = np.cross(np.eye(3), np.cross(a, b))
    return np.asarray(np.eye(3) + K + K @ K / (1 + float(a @ b)))


def are_rotations(R: Array, within: float = 1e-6) -> Mask:
    """Which of the matrices (..., 3, 3) are rotations: R R^T = 1, det R = 1."""
    square = np.abs(R @ np.swapaxes(R, -1, -2) - np.eye(3)).max(axis=(-2, -1)) <= within
    return np.asarray(square & (np.linalg.det(R) > 0))


def is_pose(X: Array) -> bool:
    """Whether an array is a finite pose [[R, p], [0, 0, 0, 1]] of shape (4, 4)."""
    if X.shape != (4, 4) or not np.isfinite(X).all():
        return False
    return bool(are_rotations(X[:3, :3]) and np.abs(X[3] - (0, 0, 0, 1)).max() <= 1e-9)


@contextmanager
def one_thread() -> Iterator[None]:
    """Linear algebra on one thread: the matrices of an arm are small, and threads would only wait
    for each other (a plan takes twice the time on a busy machine)."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
