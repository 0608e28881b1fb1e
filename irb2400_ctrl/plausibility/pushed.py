"""A force at the tool during a log: cutting, a contact. It is the process's, and no other robot's.

tau = ... - a(t) J(q)^T (w_B + R_BT(q) w_T),    a(t) 0 or 1
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects.base import STANDARD_GRAVITY
from irb2400_ctrl.plausibility.criteria import sound
from irb2400_ctrl.plausibility.evidence import Account, Nominal
from irb2400_ctrl.plausibility.rows import Rows

FORCE = 0.5
"""standard deviation of the force over the weight of the moved arm"""
LEVER = 0.2
"""of its moment about the tool's tip, over the arm's reach"""
BLOCK = 0.25
"""[s] during which it acts, or not"""
PER_BLOCK = 0.25
"""twice the log evidence that it must bring there"""
ROUNDS = 8
PARTS = 5
"""of a log, of which each run is where it may act at first"""


def pushed(nominal: Nominal, rows: Rows, columns: tuple[Array, Array]) -> bool:
    """Whether a log is sound beside a force and a moment on the tool, steady along the axes of the
    base or of the tool while they act.

    Args:
        nominal: the robot as a yardstick.
        rows: of the log as labelled.
        columns: of their motion.
    """
    wrenches = _wrenches(nominal, rows)
    block = (np.arange(len(rows.q)) * rows.seconds / len(rows.q) / BLOCK).astype(np.intp)

    def beside(acts: Mask) -> Account:
        return nominal.account(rows, columns, wrenches * acts[block][:, None, None])

    acts = min(_stretches(block[-1] + 1), key=lambda acts: beside(acts).fit.cost)
    for _ in range(ROUNDS):
        on = acts[block][:, None]
        account = beside(acts)
        torque = (wrenches @ account.numbers) * account.weight
        without = account.rest + torque * on
        gained = np.sum(without**2 - (without - torque) ** 2, axis=1)
        again = np.bincount(block, gained) > PER_BLOCK
        if (again == acts).all():
            break
        acts = again
    return sound(account.fit, nominal.robot.n)


def _stretches(blocks: int) -> list[Mask]:
    """Every run of parts of a log, as blocks in which the force acts: one that acts for half of a
    log is not found from one that always does."""
    place = np.arange(blocks) * PARTS // blocks
    return [
        (place >= first) & (place < last)
        for first in range(PARTS)
        for last in range(first + 1, PARTS + 1)
    ]


def _wrenches(nominal: Nominal, rows: Rows) -> Array:
    """Torques of forces and moments along the axes of base and tool, (m, n, 12) [Nm]."""
    J = np.asarray(nominal.model.tcp_jacobian(rows.q))
    R = np.asarray(nominal.model.tcp_pose(rows.q))[:, :3, :3]
    moved = sum(link.body.mass_kg for link in nominal.robot.links[1:])
    force = FORCE * STANDARD_GRAVITY * moved
    sizes = np.repeat([force, force * LEVER * nominal.robot.reach], 3)
    turned = np.zeros((len(R), 6, 6))
    turned[:, :3, :3] = R
    turned[:, 3:, 3:] = R
    held = -np.swapaxes(J, 1, 2) * sizes
    return np.concatenate([held, held @ turned], axis=2)
