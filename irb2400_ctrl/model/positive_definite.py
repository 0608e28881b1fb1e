"""Is the mass matrix positive definite everywhere? A proof, not a sample.

The kinetic energy is the sum over the bodies of m v^2 / 2 + w^T I w / 2. A body whose tensor about
its centre of mass is positive definite never takes energy away, so only the links up to the last
one with an indefinite tensor need a look, and their part of M depends on the few joints between
them. When that part is positive definite, M is: whatever moves must move one of those joints or
turn a later body.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.consistency import report
from irb2400_ctrl.model.mass_matrix import mass_matrix
from irb2400_ctrl.robot import Robot

DEGREE = 2
"""of M as a trigonometric polynomial in each actuator angle"""
MOST_CELLS = 2_000_000


@dataclass(frozen=True)
class DefinitenessProof:
    """What was shown about M(q)."""

    shown: bool
    """M(q) is positive definite in the whole joint box"""
    reason: str
    """in plain words"""


def certify(robot: Robot) -> DefinitenessProof:
    """Prove that M(q) is positive definite over the joint box, or say why it is not shown."""
    bodies = report(robot)
    # the tool rides on the last link
    carriers = [*range(robot.n), robot.n - 1][: len(bodies)]
    weak = [
        i
        for i, body in zip(carriers, bodies, strict=True)
        if body.principal_moments[0] < -body.tolerance
    ]
    first_sound = weak[-1] + 1 if weak else 0
    # I_zz about the joint's axis: a link whose joint alone moves must resist
    if not all(row[9] > 0.0 for row in robot.inertial_parameters[first_sound:]):
        return DefinitenessProof(False, "a link has no inertia about its own joint")
    if not weak:
        return DefinitenessProof(True, "no body has a negative principal moment")
    k = weak[-1] + 1
    if k > 3:
        reason = f"link {k} has an indefinite tensor: its part of M depends on more than two joints"
        return DefinitenessProof(False, reason)
    lower = _bound(robot, k)
    verdict = "is" if lower > 0.0 else "may not be"
    reason = (
        f"links behind link {k} only add energy; the part of M of links 1-{k} {verdict} positive "
        "definite over the "
        f"joint box (no eigenvalue below {lower:.3g} kg m2)"
    )
    return DefinitenessProof(lower > 0.0, reason)


def _bound(robot: Robot, k: int) -> float:
    """Lower bound of the eigenvalues of the part of M of links 1…k over the box of axes 2…k.

    M is a trigonometric polynomial, so its derivative by q_j is bounded by the sum of |frequency_j|
    times the spectral norm over its Fourier coefficients. Between grid points it cannot change by
    more than that times half a cell.
    """
    part = _Part(robot, k)
    slopes = _slopes(part, k)
    low = robot.q_min[1:k]
    high = robot.q_max[1:k]
    count = np.full(k - 1, 20)
    while True:
        half = (high - low) / (2 * count)
        axes = [lo + h * (2 * np.arange(c) + 1) for lo, h, c in zip(low, half, count, strict=True)]
        grid = np.array(np.meshgrid(*axes, indexing="ij")).reshape(k - 1, -1)
        smallest = np.linalg.eigvalsh(part(grid))[:, 0].min()
        lower = float(smallest - slopes @ half)
        if lower > 0.0 or smallest <= 0.0 or 4 * grid.shape[1] > MOST_CELLS:
            return lower
        count = 2 * count


class _Part:
    """M of links 1…k alone, vectorised: angles of axes 2…k (k - 1, m) -> (m, k, k)."""

    def __init__(self, robot: Robot, k: int) -> None:
        q = ca.SX.sym("q", robot.n)
        phi = robot.inertial_parameters.copy()
        phi[k:] = 0.0
        M = mass_matrix(robot, q, ca.DM(phi))[:k, :k]
        self.n = robot.n
        self.k = k
        self.function = ca.Function("part", [q], [ca.densify(M)])

    def __call__(self, angles: Array) -> Array:
        q = np.zeros((self.n, angles.shape[1]))
        q[1 : self.k] = angles
        flat = np.asarray(self.function(q))
        return np.ascontiguousarray(flat.reshape(self.k, -1, self.k).transpose(1, 0, 2))


def _slopes(part: _Part, k: int) -> Array:
    """Bound of the spectral norm of dM/dq_j for axes j = 2…k, shape (k - 1,)."""
    points = 2 * DEGREE + 5  # two more frequencies than M has: their coefficients must vanish
    angle = 2 * np.pi * np.arange(points) / points
    grid = np.array(np.meshgrid(*[angle] * (k - 1), indexing="ij")).reshape(k - 1, -1)
    values = part(grid).reshape(*[points] * (k - 1), k, k)
    coefficients = np.fft.fftn(values, axes=range(k - 1)) / points ** (k - 1)
    frequency = np.abs(np.round(np.fft.fftfreq(points) * points))
    norms = np.linalg.norm(coefficients, ord=2, axis=(-2, -1))
    slopes = np.empty(k - 1)
    for j in range(k - 1):
        shape = [1] * (k - 1)
        shape[j] = points
        along = np.broadcast_to(frequency.reshape(shape), norms.shape)
        if norms[along > DEGREE].max(initial=0.0) > 1e-9 * norms.max():
            return np.full(k - 1, np.inf)
        slopes[j] = float((along * norms).sum())
    return slopes
