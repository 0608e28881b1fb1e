"""Chain and bodies as the recursions take them: regrouped, in the frames and the unit that cost the
fewest operations.

Three freedoms of the description that change no torque are used up:

- what part of a body rides on which link (`bodies.regrouped`);
- the angle at which the last link's frame stands on its axis: turned so that its first moment has
  no y component;
- the unit of length: with the first step of a group of parallel axes as the unit, its products with
  one vanish (mass goes with length^-2, so that torque and second moments keep their numbers).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.bodies import pseudo_inertia, regrouped
from irb2400_ctrl.model.chain import Chain, chain_of
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class Arm:
    """What the recursions need."""

    chain: Chain
    bodies: list[ca.SX]
    """pseudo-inertias of the links, (4, 4) each"""
    length: float
    """the unit of length [m]: lengths are divided by it, first moments multiplied, masses by its
    square"""


def arm_of(robot: Robot, phi: ca.SX | ca.DM | None = None) -> Arm:
    """Regrouped when phi (n, 10) are numbers; as they are when phi are symbols."""
    chain = chain_of(robot)
    if isinstance(phi, ca.SX) and not phi.is_constant():
        return Arm(chain, [pseudo_inertia(phi[i, :]) for i in range(robot.n)], 1.0)
    numbers = robot.inertial_parameters if phi is None else np.asarray(ca.DM(phi))
    bodies = regrouped(robot, numbers)
    chain, bodies[-1] = _last_turned(chain, bodies[-1])
    length = _unit(chain)
    scale = np.diag([1.0, 1.0, 1.0, length])
    return Arm(
        _scaled(chain, length),
        [ca.SX(ca.sparsify(ca.DM(scale @ J @ scale))) for J in bodies],
        length,
    )


def _last_turned(chain: Chain, J: Array) -> tuple[Chain, Array]:
    """The last link's frame turned about its axis until the body's m c_y is zero."""
    x = J[0, 3]
    y = J[1, 3]
    if y == 0.0:
        return chain, J
    r = np.hypot(x, y)
    X = np.eye(4)
    X[:2, :2] = np.array([[x, y], [-y, x]]) / r
    turned = X @ J @ X.T
    turned[:2, 3] = turned[3, :2] = r, 0.0
    offset = chain.offset.copy()
    offset[-1] += np.arctan2(y, x)
    return replace(chain, offset=offset), turned


def _unit(chain: Chain) -> float:
    """The step along x of the first group that has one, else a metre."""
    return next(
        (float(step[0]) for group in chain.groups for step in group.steps if step[0] != 0.0), 1.0
    )


def _scaled(chain: Chain, length: float) -> Chain:
    groups = [
        replace(group, p=group.p / length, steps=tuple(step / length for step in group.steps))
        for group in chain.groups
    ]
    return replace(chain, groups=tuple(groups))
