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


def arm_of(robot: Robot, phi: ca.SX | ca.DM | None = None, added: ca.SX | None = None) -> Arm:
    """Regrouped when phi (n, 10) are numbers; as they are when phi are symbols.

    Args:
        added: symbols (m, m c, I_O) of a body more on each link, in its frame, shape (n, 10).
    """
    chain = chain_of(robot)
    if isinstance(phi, ca.SX) and not phi.is_constant():
        own = [pseudo_inertia(phi[i, :]) for i in range(robot.n)]
        if added is not None:
            own = [J + pseudo_inertia(added[i, :]) for i, J in enumerate(own)]
        return Arm(chain, own, 1.0)
    numbers = robot.inertial_parameters if phi is None else np.asarray(ca.DM(phi))
    bodies = regrouped(robot, numbers)
    turn = _last_turn(bodies[-1])
    bodies[-1] = turn @ bodies[-1] @ turn.T
    bodies[-1][1, 3] = bodies[-1][3, 1] = 0.0
    offset = chain.offset.copy()
    offset[-1] += np.arctan2(turn[0, 1], turn[0, 0])
    chain = replace(chain, offset=offset)
    length = _unit(chain)
    scale = np.diag([1.0, 1.0, 1.0, length])
    scaled = [ca.SX(ca.sparsify(ca.DM(scale @ J @ scale))) for J in bodies]
    if added is not None:
        frames = [ca.sparsify(ca.DM(X)) for X in [scale] * (robot.n - 1) + [scale @ turn]]
        more = [X @ pseudo_inertia(added[i, :]) @ X.T for i, X in enumerate(frames)]
        scaled = [J + extra for J, extra in zip(scaled, more, strict=True)]
    return Arm(_scaled(chain, length), scaled, length)


def _last_turn(J: Array) -> Array:
    """Turn of the last link's frame about its axis after which the body's m c_y is zero, (4, 4)."""
    x = J[0, 3]
    y = J[1, 3]
    X = np.eye(4)
    if y != 0.0:
        X[:2, :2] = np.array([[x, y], [-y, x]]) / np.hypot(x, y)
    return X


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
