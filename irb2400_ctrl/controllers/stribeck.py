"""Dry friction in arithmetic: what a controller has time for where the model has exponentials.

Plant, `Model` and diagnosis keep exp(-(qd / omega_st)^2) of eq. 55. On a small processor an
exponential costs three times as much as what is here, and the friction of an arm is known to some
per cent at best.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

BELL_ERROR = 2.5e-3
"""largest distance of `bell` from the exponential, as a share of its height"""
# minimax over all speeds, with the value at rest held
_RAISE = 1.75284075
_WIDEN = 0.33632957


def bell(speed: ca.SX, width: NDArray[np.float64], height: NDArray[np.float64]) -> ca.SX:
    """height exp(-x^2), x = speed / width, as height ((b + 1) / (b + (1 + a x^2)^2))^4: one
    division, no branch.

    Within `BELL_ERROR` everywhere. Like the exponential it is `height` at rest, falls, and never
    changes its sign; not a number in, not a number out.
    """
    # the height goes under the power, where it costs nothing
    root = ca.DM((_RAISE + 1) * np.abs(height) ** 0.25)
    share = root / (_RAISE + (1 + (speed * ca.DM(np.sqrt(_WIDEN) / width)) ** 2) ** 2)
    return ca.DM(np.sign(height)) * (share**2) ** 2


def fade(speed: ca.SX, width: ca.SX) -> ca.SX:
    """speed^2 / (speed^2 + width^2): 0 at rest, 1/2 at `width`, 1 far beyond."""
    return speed**2 / (speed**2 + width**2)
