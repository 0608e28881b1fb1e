"""`slowing`: how much slower a motion has to be, only around the rows that swing over a limit."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array

# rows before and after one above a limit that are slowed as much, and over which the motion comes
# back to its own speed
_BESIDE = 2
_RAMP = 5
_ROUNDING = 1e-12


def slowing(wanted: Array) -> Array:
    """A factor at every row that is at least the one wanted in the interval after it and those
    around, changes smoothly, and is 1 farther away.

    Args:
        wanted: factors of at least 1 between rows, shape (k - 1,).

    Returns:
        shape (k,); constant near both ends.
    """
    reach = _BESIDE + _RAMP
    at_rows = np.maximum(np.append(wanted, 1.0), np.insert(wanted, 0, 1.0))
    near = reach + 2 * _RAMP
    # no ramp where the motion starts and stops
    at_rows[:near] = at_rows[:near].max()
    at_rows[-near:] = at_rows[-near:].max()
    padded = np.pad(at_rows, reach, mode="edge")
    widest = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).max(axis=1)
    window = np.hanning(2 * _RAMP + 3)[1:-1]
    smooth = np.convolve(np.pad(widest, _RAMP, mode="edge"), window / window.sum(), mode="valid")
    # the mean of ones may be more by its rounding
    return np.where(smooth > 1 + _ROUNDING, smooth, 1.0)
