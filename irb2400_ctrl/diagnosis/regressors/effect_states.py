"""States of effects with memory along a motion, for many nonlinear parameters at once.

The states follow dx/dt = A x + b with A, b given by the motion. From one sample to the next A and b
are taken as constant, the mean of both, and the step x+ = exp(A h) x + integral exp(A s) ds b is
exact: no resonance is shifted and no stiff friction blows up.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from scipy.linalg.lapack import dtbtrs

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.symbolic.vectorised import Vectorised


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

    def beginnings(self, count: int) -> list[list[int]]:
        """Of each of the first `count` states those that go another way where it begins
        elsewhere."""
        return [block for block in self._blocks for i in block if i < count]

    def states(
        self,
        inputs: list[Array],
        step: float,
        theta: list[Array],
        shape: tuple[int, int],
        beginnings: int,
    ) -> list[list[Array]]:
        """Trajectories of each state over samples and grid points, `shape` (m, g): begun in the
        steady state, then begun one unit off in each of the first `beginnings` states.

        Args:
            inputs: (m, 1); step: [s]; theta: (1, g).
        """
        values = self._evaluate(*inputs, *theta)
        inside = values[: -2 * self.n]
        b = values[-2 * self.n : -self.n]
        steady = values[-self.n :]
        begun: list[list[list[Array]]] = []
        for place, block in enumerate(self._blocks):
            n = len(block)
            own = inside[place * n * n : (place + 1) * n * n]
            A = [own[i * n : i * n + n] for i in range(n)]
            first = [np.broadcast_to(steady[i], shape)[0] for i in block]
            off = sum(i < beginnings for i in block)
            begun.append(_trajectories(A, [b[i] for i in block], first, step, shape, off))
        quiet = [x for block in begun for x in block[0]]
        trajectories = [quiet]
        for block, found in zip(self._blocks, begun, strict=True):
            for other in found[1:]:
                trajectories.append(
                    [other[block.index(i)] if i in block else quiet[i] for i in range(self.n)]
                )
        return trajectories


def _trajectories(
    A: list[list[Array]],
    b: list[Array],
    first: list[Array],
    step: float,
    shape: tuple[int, int],
    off: int,
) -> list[list[Array]]:
    """One or two states that depend on each other: begun in the steady state, then one unit off in
    each of the first.

    Args:
        A, b: of any shape that broadcasts to `shape`: what does not change is not spread out.
        first: the steady state; step: [s].
        shape: samples, grid points.
        off: in how many states.
    """
    n = len(b)
    inside = (shape[0] - 1, shape[1])
    # between two samples: their mean, or everything would come half a sample late
    A = [[_between(a) for a in row] for row in A]
    b = [_between(v) for v in b]
    E, add = _scalar(A[0][0], b[0], step) if n == 1 else _pair(A, b, step)
    starts = [first]
    for k in range(off):
        # one unit of a rate is small against one of its state: give it the size of a swing
        swing = np.sqrt(np.abs(np.broadcast_to(A[1][0], inside)[0]) + 1e-12) if k else 1.0
        starts.append([first[i] + (swing if i == k else 0.0) for i in range(n)])
    return _followed(E, add, starts, shape)


def _between(v: Array) -> Array:
    return np.asarray(0.5 * (v[:-1] + v[1:])) if v.ndim and len(v) > 1 else v


def _followed(
    E: list[list[Array]], c: list[Array], starts: list[list[Array]], shape: tuple[int, int]
) -> list[list[Array]]:
    """x[k + 1] = E[k] x[k] + c[k] from several starts (g,): a banded triangle of equations for each
    point of the grid, found[start][state] (m, g)."""
    n = len(c)
    m, points = shape
    inside = (m - 1, points)
    steps = [[np.broadcast_to(e, inside) for e in row] for row in E]
    add = [np.broadcast_to(v, inside) for v in c]
    found = np.empty((len(starts), n, m, points))
    # column by column below a diagonal of ones, as LAPACK keeps a band
    band = np.zeros((m, n, 2 * n))
    right = np.zeros((len(starts), m, n))
    for point in range(points):
        for i in range(n):
            for k in range(n):
                # numpy 2.4.6 negates every eighth number of an array wrongly into such a place
                np.multiply(steps[i][k][:, point], -1.0, out=band[:-1, k, n + i - k])
            right[:, 1:, i] = add[i][:, point]
            right[:, 0, i] = [start[i][point] for start in starts]
        x, _ = dtbtrs(
            band.reshape(-1, 2 * n).T, right.reshape(len(starts), -1).T, uplo="L", diag="U"
        )
        found[..., point] = x.T.reshape(len(starts), m, n).transpose(0, 2, 1)
    return [list(begun) for begun in found]


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
