"""Base parameters: the smallest set of inertial parameters that the torque depends on, for any
robot."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.regressor import regressor
from irb2400_ctrl.robot import Robot

NAMES = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
# kept first in every link; m, mz and Iyy follow: they look the same at every joint angle, so the
# link before has them
PREFERENCE = ((9, 1, 2, 4, 5, 6, 8), (7, 3, 0))
TOLERANCE = 1e-9
"""a column of the regressor is dependent when this fraction of it is left after projection [-]"""
SAMPLES = 100


@dataclass(frozen=True)
class BaseParameters:
    """Which standard parameters are kept, and what each absorbs of the others."""

    kept: tuple[int, ...]
    """positions of the kept parameters in phi (10 per link, one link after another)"""
    matrix: Array
    """values = matrix @ phi, shape (base, 10 n): the unit matrix in the kept columns, the
    regrouping in the others"""
    values: Array
    """base parameters of the robot [kg, kg m, kg m2], shape (base,)"""

    @property
    def count(self) -> int:
        """Number of base parameters."""
        return len(self.kept)

    @property
    def names(self) -> list[str]:
        """Name of each: `Ixx_3` is I_xx of link 3 with what it absorbs."""
        return [f"{NAMES[k % 10]}_{k // 10 + 1}" for k in self.kept]

    @property
    def unseen(self) -> Array:
        """Orthonormal changes of phi that no torque shows, shape (10 n - base, 10 n)."""
        return np.asarray(np.linalg.svd(self.matrix)[2][self.count :])

    def explain(self, position: int) -> str:
        """A base parameter as the sum of standard parameters it stands for."""
        text = ""
        for k in np.flatnonzero(np.abs(self.matrix[position]) > TOLERANCE):
            factor = self.matrix[position, k]
            size = "" if abs(abs(factor) - 1) < TOLERANCE else f"{abs(factor):.6g} "
            text += f" {'-' if factor < 0 else '+'} {size}{NAMES[k % 10]}_{k // 10 + 1}"
        return text.removeprefix(" + ").strip()


def base_parameters(robot: Robot, phi: Array) -> BaseParameters:
    """Base parameters of a robot with link parameters phi (n, 10).

    The regressor is sampled over random motions; column by column, in the order of PREFERENCE, a
    parameter is kept when its column is not a combination of those kept before (Gautier 1991, by
    orthogonal projection). The factors of the combinations are the map.
    """
    n = robot.n
    W = _sampled_regressor(robot)
    scale = np.linalg.norm(W, axis=0)
    kept: list[int] = []
    Q = np.empty((W.shape[0], 0))
    order = [10 * link + p for some in PREFERENCE for link in reversed(range(n)) for p in some]
    for k in order:
        rest = W[:, k]
        for _ in range(2):  # projecting twice keeps the basis orthogonal to rounding
            rest = rest - Q @ (Q.T @ rest)
        if np.linalg.norm(rest) > TOLERANCE * max(scale[k], 1.0):
            kept.append(k)
            Q = np.column_stack([Q, rest / np.linalg.norm(rest)])
    kept.sort()
    matrix = np.linalg.lstsq(W[:, kept] / scale[kept], W, rcond=None)[0] / scale[kept][:, None]
    matrix[np.abs(matrix) < TOLERANCE] = 0.0
    matrix[:, kept] = np.eye(len(kept))
    values = matrix @ phi.ravel()
    for array in (matrix, values):
        array.setflags(write=False)
    return BaseParameters(tuple(kept), matrix, values)


def with_masses(robot: Robot, phi: Array, masses: Array) -> Array:
    """Link parameters (n, 10) of the same torque in every motion with other masses; masses that a
    torque shows stay as they are.

    Args:
        robot: whose bodies they are.
        phi: link parameters to be nearest to, shape (n, 10).
        masses: wanted [kg], shape (n,).
    """
    unseen = base_parameters(robot, phi).unseen
    shift = np.linalg.pinv(unseen[:, ::10].T, rcond=TOLERANCE) @ (masses - phi[:, 0])
    return np.asarray(phi + (shift @ unseen).reshape(phi.shape))


def _sampled_regressor(robot: Robot) -> Array:
    """Regressors of random motions one below the other, shape (SAMPLES n, 10 n)."""
    n = robot.n
    symbols = [ca.SX.sym(name, n) for name in ("q", "qd", "qdd")]
    Y = ca.Function("Y", symbols, [ca.densify(regressor(robot, *symbols))])
    rng = np.random.default_rng(0)
    q = rng.uniform(-np.pi, np.pi, (n, SAMPLES))
    qd, qdd = rng.normal(size=(2, n, SAMPLES))
    flat = np.asarray(Y(q, 2 * qd, 5 * qdd))
    return np.ascontiguousarray(
        flat.reshape(n, SAMPLES, 10 * n).transpose(1, 0, 2).reshape(-1, 10 * n)
    )
