"""When a reading of a log is taken: what explains it well, what does so clearly better."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.rows import Rows

SOUND_PRICE = 35.0
"""of six joints: below this, with no joint badly explained, nothing else is tried"""
SOUND_LEFT = 0.4
"""share of a joint's torque left that is still well explained"""
MARGIN = 30.0
"""twice the log evidence by which another reading must be better"""
SHARE = 0.2
"""and over the cost of the reading before it"""
HALF = 0.5
"""of what is left, joint by joint in its own size, is the most that it may leave"""
BEYOND = 200.0
"""a price that only numbers far from the robot's reach: then a good fit proves nothing"""
FITS_PRICE = 150.0
"""of six joints: a reading that leaves more than this does not fit either"""

FEWEST_OTHERS = 3
"""joints that tell that a log is this robot's, whatever one more has"""


def sound(fit: Fit, n: int) -> bool:
    """Whether a reading of n joints is explained so well that no other needs to be tried."""
    return fit.price < SOUND_PRICE * n / 6.0 and bool(fit.left.max() < SOUND_LEFT)


def only_one_off(
    nominal: Nominal, rows: Rows, columns: tuple[Array, Array], labelled: Fit
) -> int | None:
    """The joint (from 1) without which a log is sound as labelled: what that joint has is its own.

    A spring at the wrist was 0.6 of its joint's torque; what explained it best, and the other
    joints less, was the zero of the joint before, 90 degrees off.

    Args:
        nominal: the robot as a yardstick.
        rows: of the log as labelled.
        columns: of their motion.
        labelled: how well they explain it.
    """
    bad = np.flatnonzero(labelled.left >= SOUND_LEFT)
    n = len(labelled.left)
    if len(bad) != 1 or n <= FEWEST_OTHERS:
        return None
    joint = int(bad[0])
    others = nominal.beside(rows, columns, joint)
    told = Fit(others.cost, others.price, np.delete(others.left, joint))
    return joint + 1 if sound(told, n - 1) else None


def clearly_better(
    one: Fit, other: Fit, hidden: bool = False, on: Mask | slice = slice(None)
) -> bool:
    """Whether a reading is so much better than another that the log is not what the other says.

    Args:
        one: the reading; other: what it is held against.
        hidden: whether bodies far from the file's would leave as little without it: a scale of the
            torques, which they make up for.
        on: joints of which little must be left; default all, shape (n,).
    """
    gain = other.cost - one.cost
    less = np.sum(one.left[on] ** 2) < HALF * np.sum(other.left[on] ** 2)
    return gain > max(MARGIN, SHARE * other.cost) and bool(hidden or less or other.price > BEYOND)
