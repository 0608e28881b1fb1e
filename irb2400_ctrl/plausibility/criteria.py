"""When a reading of a log is taken: what explains it well, what does so clearly better."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Mask
from irb2400_ctrl.plausibility.evidence import Fit

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


def sound(fit: Fit, n: int) -> bool:
    """Whether a reading of n joints is explained so well that no other needs to be tried."""
    return fit.price < SOUND_PRICE * n / 6.0 and bool(fit.left.max() < SOUND_LEFT)


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
