"""The chain as groups of parallel axes.

Links whose joints have parallel axes keep the same plane: link i of such a group stands in the
group's frame G, turned about z by phi_i alone, whatever the links between do. So the dynamics are
written in

    phi = B q + offset,    tau = B^T tau_phi,

the angle of each link in its group's frame. For the IRB 2400 axes 2 and 3 are parallel and the
parallelogram makes q3 absolute: theta2 + theta3 = q3 - pi/2, B is the unit matrix, and no sine of a
difference is left.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.robot import Robot

CosSin = tuple[ca.SX, ca.SX]

PARALLEL = 1e-12
"""axes are parallel when the sine between them is smaller than this [-]"""


@dataclass(frozen=True)
class LinkGroup:
    """Consecutive links with parallel joint axes, zero-based, and where they are mounted."""

    links: range
    R: Array
    """rotation of the group's frame G in the link before, its z along the axes, shape (3, 3)"""
    p: Array
    """origin of the first link in the link before [m], shape (3,)"""
    steps: tuple[Array, ...]
    """origin of the next link in each link but the last [m], shape (3,) each"""


@dataclass(frozen=True)
class Chain:
    """All groups from the base to the flange."""

    groups: tuple[LinkGroup, ...]
    B: Array
    offset: Array

    def cos_sin(self, q: ca.SX) -> list[CosSin]:
        """(cos, sin) of each phi."""
        return cos_sin(self.B, self.offset, q)


def chain_of(robot: Robot) -> Chain:
    """The chain of a robot, for any mixture of modified DH and explicit transforms."""
    groups: list[LinkGroup] = []
    total = np.eye(robot.n)
    offset = np.array(robot.offset)
    for i, link in enumerate(robot.links):
        X = link.frame.matrix()
        R = X[:3, :3]
        p = X[:3, 3]
        if groups and R[2, 2] > 0 and np.hypot(R[0, 2], R[1, 2]) < PARALLEL:
            last = groups[-1]
            groups[-1] = LinkGroup(range(last.links.start, i + 1), last.R, last.p, (*last.steps, p))
            total[i] += total[i - 1]
            offset[i] += offset[i - 1] + np.arctan2(R[1, 0], R[0, 0])
        else:
            groups.append(LinkGroup(range(i, i + 1), R, p, ()))
    return Chain(tuple(groups), total @ robot.A, offset)


def cos_sin(matrix: Array, offset: Array, q: ca.SX) -> list[CosSin]:
    """(cos, sin) of matrix @ q + offset.

    An offset of a multiple of 90 degrees is taken out of the argument, as in eqs. 3-8: the
    generated code then holds exact zeros and ones and no rounding of pi.

    Args:
        matrix: from angles of the actuators to angles of the joints, shape (k, n) [-].
        offset: of the joints [rad], shape (k,).
        q: angles of the axes [rad], shape (n,), symbols.
    """
    angles = ca.DM(matrix) @ q
    pairs: list[CosSin] = []
    for i, value in enumerate(offset):
        quarter = value / (ca.pi / 2)
        turns = round(quarter)
        if abs(quarter - turns) < 1e-12:
            c = ca.cos(angles[i])
            s = ca.sin(angles[i])
            pairs.append([(c, s), (-s, c), (-c, -s), (s, -c)][turns % 4])
        else:
            pairs.append((ca.cos(angles[i] + value), ca.sin(angles[i] + value)))
    return pairs


def turned(pair: CosSin, v: ca.SX) -> ca.SX:
    """Rz v: a vector of the link, in the group's frame."""
    c, s = pair
    return ca.vertcat(c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def turned_back(pair: CosSin, v: ca.SX) -> ca.SX:
    """Rz^T v: a vector of the group's frame, in the link."""
    c, s = pair
    return ca.vertcat(c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])
