"""Which numbers of an arm a log speaks of: bodies, friction, offsets, rotors, couplings of joints.

    tau = Y(q, qd, qdd) phi + D beta,    D = [sgn qd | qd | 1 | qdd | stribeck | couplings]

phi are the ten inertial numbers of every link (m, m c, I_O), the tool folded into the last one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model

DRIVE_TERMS = ("coulomb", "viscous", "offset", "rotor", "stribeck")
COUPLING_TERMS = ("coulomb", "viscous", "inertia")


@dataclass(frozen=True)
class Coupling:
    """Torque on joint `on` (from 1) that follows the motion of joint `by`: gears of a wrist."""

    on: int
    by: int


@dataclass(frozen=True)
class ColumnLayout:
    """Names and places of the columns.

    Args:
        n: joints; terms: of the drives, in order; couplings: pairs of joints, three columns each.
    """

    n: int
    terms: tuple[str, ...]
    couplings: tuple[Coupling, ...] = ()

    @property
    def inertial(self) -> int:
        """Number of inertial columns."""
        return 10 * self.n

    @property
    def count(self) -> int:
        """Number of all columns."""
        return self.inertial + self.n * len(self.terms) + 3 * len(self.couplings)

    def drive(self, term: str) -> slice:
        """Columns of one term, joint by joint."""
        start = self.inertial + self.n * self.terms.index(term)
        return slice(start, start + self.n)

    def coupling(self, number: int) -> slice:
        """The three columns of one coupling."""
        start = self.inertial + self.n * len(self.terms) + 3 * number
        return slice(start, start + 3)

    def names(self) -> list[str]:
        """Name of every column, joints and links from 1."""
        body = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
        names = [f"{what}_{link + 1}" for link in range(self.n) for what in body]
        names += [f"{term}_{j + 1}" for term in self.terms for j in range(self.n)]
        for pair in self.couplings:
            names += [f"coupling_{term}_{pair.on}_by_{pair.by}" for term in COUPLING_TERMS]
        return names

    def without_couplings(self) -> ColumnLayout:
        """The same arm, joints for themselves."""
        return ColumnLayout(self.n, self.terms)


def columns(model: Model, layout: ColumnLayout, q: Array, qd: Array, qdd: Array) -> Array:
    """d tau / d (phi, beta) along a motion, shape (m, n, columns).

    Args:
        q, qd, qdd: [rad], [rad/s], [rad/s2], shape (m, n).
    """
    m, n = q.shape
    found = np.zeros((m, n, layout.count))
    found[:, :, : layout.inertial] = model.regressor(q, qd, qdd)
    sign = np.sign(qd)
    bell = np.exp(-((qd / model.robot.friction[:, 3]) ** 2))
    signals = {
        "coulomb": sign,
        "viscous": qd,
        "offset": np.ones_like(qd),
        "rotor": qdd,
        "stribeck": sign * bell,
    }
    joints = np.arange(n)
    for term in layout.terms:
        found[:, joints, layout.inertial + n * layout.terms.index(term) + joints] = signals[term]
    for number, pair in enumerate(layout.couplings):
        by = pair.by - 1
        block = np.column_stack([sign[:, by], qd[:, by], qdd[:, by]])
        found[:, pair.on - 1, layout.coupling(number)] = block
    return found
