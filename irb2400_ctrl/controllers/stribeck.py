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
"""largest distance of `faded_bell`'s bell from the exponential, as a share of its height"""
# minimax over all speeds, with the value at rest held
_RAISE = 1.75284075
_WIDEN = 0.33632957


def faded_bell(
    speed: ca.SX,
    width: NDArray[np.float64] | ca.SX,
    height: NDArray[np.float64] | ca.SX,
    reference: ca.SX,
    fade_width: ca.SX,
) -> ca.SX:
    """height exp(-x^2) fade(reference), x = speed / width, with one division for both and the bell
    as height ((b + 1) / (b + (1 + a x^2)^2))^4: no exponential, no branch.

    The bell is within `BELL_ERROR` everywhere. Like the exponential it is `height` at rest, falls,
    and never changes its sign; not a number in, not a number out. Width and height may be symbols.

    Args:
        speed: [rad/s], shape (n,).
        width: speed at which it has fallen to 1/e [rad/s], shape (n,).
        height: at rest, in the unit of the result, shape (n,).
        reference: speed of the reference [rad/s], shape (n,).
        fade_width: speed of the reference within which it is faded [rad/s].
    """
    square = reference**2
    if isinstance(height, ca.SX) or isinstance(width, ca.SX):
        root = 1 + (1 + _WIDEN * (speed / width) ** 2) ** 2 / _RAISE
        fall = ((root * (_RAISE / (_RAISE + 1))) ** 2) ** 2
        return ca.SX(height) * square / ((square + fade_width**2) * fall)
    below = (square + fade_width**2) * _fall(speed, width, height)
    return ca.DM(np.sign(height)) * square / below


def _fall(speed: ca.SX, width: NDArray[np.float64], height: NDArray[np.float64]) -> ca.SX:
    """((b + (1 + a x^2)^2) / (b + 1))^4 / |height|, as the fourth power of a polynomial in
    speed^2."""
    # the height goes under the power, where it costs nothing; where there is none, it is multiplied
    # by zero later
    size = np.where(height == 0, 1.0, np.abs(height))
    scale = 1 / ((_RAISE + 1) * size**0.25)
    bend = _WIDEN / width**2
    square = speed**2
    root = ca.DM(scale * (_RAISE + 1)) + square * (
        ca.DM(scale * 2 * bend) + square * ca.DM(scale * bend**2)
    )
    return (root**2) ** 2


def fade(speed: ca.SX, width: ca.SX) -> ca.SX:
    """speed^2 / (speed^2 + width^2): 0 at rest, 1/2 at `width`, 1 far beyond."""
    return speed**2 / (speed**2 + width**2)
