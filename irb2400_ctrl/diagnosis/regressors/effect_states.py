"""States of effects with memory along a motion, for many nonlinear parameters at once.

The states follow dx/dt = A x + b with A, b given by the motion. From one sample to the next A and b
are taken as constant, the mean of both, and the step x+ = exp(A h) x + integral exp(A s) ds b is
exact: no resonance is shifted and no stiff friction blows up.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.vectorised import Vectorised


class Memory:
    """States with a rate linear in them, each alone or in pairs that do not touch each other."""

    def __init__(
        self, scalars: list[ca.SX], state: ca.SX, theta: list[ca.SX], rate: ca.SX, steady: ca.SX
    ) -> None:
        self.n = state.numel()
        width = 1 if self.n == 1 else 2
        self._blocks = [list(range(i, i + width)) for i in range(0, self.n, width)]
        A = ca.jacobian(rate, state)
        touching = [
            A[i, k].nnz()
            for block in self._blocks
            for i in block
            for k in range(self.n)
            if k not in block
        ]
        if self.n % width or any(touching):
            raise NotImplementedError("effects with more than two states that depend on each other")
        b = ca.substitute(rate, state, ca.SX.zeros(self.n))
        inside = [ca.densify(A[i, k]) for block in self._blocks for i in block for k in block]
        self._evaluate = Vectorised([*scalars, *theta], ca.vertcat(*inside, b, steady))

    def states(
        self, inputs: list[Array], step: float, theta: list[Array], shape: tuple[int, int]
    ) -> list[list[Array]]:
        """Trajectories (g, m) of each state: begun in the steady state, then begun one unit off in
        each state."""
        values = [np.broadcast_to(v, shape) for v in self._evaluate(*inputs, *theta)]
        inside = values[: -2 * self.n]
        b = values[-2 * self.n : -self.n]
        steady = values[-self.n :]
        begun: list[list[list[Array]]] = []
        for place, block in enumerate(self._blocks):
            n = len(block)
            own = inside[place * n * n : (place + 1) * n * n]
            A = [own[i * n : i * n + n] for i in range(n)]
            begun.append(_trajectories(A, [b[i] for i in block], [steady[i] for i in block], step))
        quiet = [x for block in begun for x in block[0]]
        trajectories = [quiet]
        for block, found in zip(self._blocks, begun, strict=True):
            for other in found[1:]:
                trajectories.append(
                    [other[block.index(i)] if i in block else quiet[i] for i in range(self.n)]
                )
        return trajectories


def _trajectories(
    A: list[list[Array]], b: list[Array], steady: list[Array], step: float
) -> list[list[Array]]:
    """One or two states that depend on each other: begun in the steady state, then one unit off in
    each."""
    n = len(b)
    # between two samples: their mean, or everything would come half a sample late
    A = [[_between(a) for a in row] for row in A]
    b = [_between(v) for v in b]
    E, add = _scalar(A[0][0], b[0], step) if n == 1 else _pair(A, b, step)
    # x[k + 1] = E x[k] + add as one affine map from the first sample, for all samples at once
    P, c = _composed(E, add)
    trajectories = []
    for begun in range(n + 1):
        x0 = [steady[i][:, :1].copy() for i in range(n)]
        if begun:
            # one unit of a rate is small against one of its state: give it the size of a swing
            x0[begun - 1] = x0[begun - 1] + (
                1.0 if begun == 1 else np.sqrt(np.abs(A[1][0][:, :1]) + 1e-12)
            )
        later = [sum((P[i][k] * x0[k] for k in range(n)), c[i]) for i in range(n)]
        trajectories.append([np.concatenate([x0[i], later[i]], axis=1) for i in range(n)])
    return trajectories


def _between(v: Array) -> Array:
    return np.asarray(0.5 * (v[:, :-1] + v[:, 1:]))


def _composed(E: list[list[Array]], c: list[Array]) -> tuple[list[list[Array]], list[Array]]:
    """Affine maps from the first sample to every later one: within blocks of about sqrt(m) samples
    for all blocks at once, then from block to block."""
    n = len(c)
    points, m = c[0].shape
    length = math.isqrt(m) + 1
    count = -(-m // length)
    # maps and what they add side by side, the samples of a block first
    steps = np.zeros((n, n + 1, points, count * length))
    for i in range(n):
        steps[i, i] = 1.0  # beyond the end nothing moves
        for k in range(n):
            steps[i, k, :, :m] = E[i][k]
        steps[i, n, :, :m] = c[i]
    steps = steps.reshape(n, n + 1, points, count, length)
    maps = np.ascontiguousarray(steps.transpose(4, 0, 1, 2, 3))
    for place in range(1, length):
        maps[place] = _after(maps[place], maps[place - 1])
    whole = np.ascontiguousarray(maps[-1].transpose(3, 0, 1, 2))
    begin = np.zeros_like(whole)
    begin[0, range(n), range(n)] = 1.0
    for block in range(1, count):
        begin[block] = _after(whole[block - 1], begin[block - 1])
    before = begin.transpose(1, 2, 3, 0)
    found = [
        [
            sum(maps[:, i, k] * before[k, j] for k in range(n)) + (maps[:, i, n] if j == n else 0.0)
            for j in range(n + 1)
        ]
        for i in range(n)
    ]
    flat = [[part.transpose(1, 2, 0).reshape(points, -1)[:, :m] for part in row] for row in found]
    return [row[:n] for row in flat], [row[n] for row in flat]


def _after(later: Array, earlier: Array) -> Array:
    """An affine map after another one, both (n, n + 1, ...)."""
    n = len(later)
    found = np.asarray(np.sum(later[:, :n, None] * earlier[None], axis=1))
    found[:, n] += later[:, n]
    return found


def _scalar(a: Array, b: Array, h: float) -> tuple[list[list[Array]], list[Array]]:
    factor = np.exp(np.minimum(a * h, 0.0))
    small = np.abs(a * h) < 1e-9
    growth = np.where(small, h, (factor - 1.0) / np.where(small, 1.0, a))
    return [[factor]], [growth * b]


def _pair(A: list[list[Array]], b: list[Array], h: float) -> tuple[list[list[Array]], list[Array]]:
    """exp(A h) by Cayley-Hamilton, and A^-1 (exp(A h) - 1) b."""
    (a11, a12), (a21, a22) = A
    mean = (a11 + a22) / 2
    determinant = a11 * a22 - a12 * a21
    squared = mean**2 - determinant
    if (squared < 0.0).all():  # it swings: real numbers do, at a quarter of the time
        turn = np.sqrt(-squared)
        c = np.cos(turn * h)
        s = np.sin(turn * h) / turn
    else:
        root = np.sqrt(squared.astype(complex)) * h
        c = np.cosh(root).real
        s = np.where(
            np.abs(root) < 1e-9,
            h,
            (np.sinh(root) / np.where(np.abs(root) < 1e-9, 1.0, root)).real * h,
        )
    decay = np.exp(np.minimum(mean * h, 0.0))
    E = [
        [decay * (c + s * (a11 - mean)), decay * s * a12],
        [decay * s * a21, decay * (c + s * (a22 - mean))],
    ]
    r1 = (E[0][0] - 1.0) * b[0] + E[0][1] * b[1]
    r2 = E[1][0] * b[0] + (E[1][1] - 1.0) * b[1]
    safe = np.where(np.abs(determinant) < 1e-12, 1.0, determinant)
    return E, [(a22 * r1 - a12 * r2) / safe, (a11 * r2 - a21 * r1) / safe]
