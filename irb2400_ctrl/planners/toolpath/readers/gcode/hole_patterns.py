"""Rows and circles of holes as calls (Siemens 840D): `HOLES1(SPCA, SPCO, STA1, FDIS, DBH, NUM)`,
`HOLES2(CPA, CPO, RAD, STA1, INDA, NUM)`, which drill as the `MCALL` before them says.

Source: Siemens, SINUMERIK 840D/840Di/810D User Manual Cycles, "Drilling pattern cycles".
"""

from __future__ import annotations

import math

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.hole_calls import HoleCall, number

PATTERNS = {
    "HOLES1": ("SPCA", "SPCO", "STA1", "FDIS", "DBH", "NUM"),
    "HOLES2": ("CPA", "CPO", "RAD", "STA1", "INDA", "NUM"),
}
MOST_HOLES = 10_000


def places(call: HoleCall) -> Array:
    """The holes in the order of the statement, in its plane and unit, shape (k, 2).

    Raises:
        InputError: an argument is missing, or one is stated that is not read.
    """
    names = PATTERNS[call.name]
    at = [number(text, call.name) for text in call.arguments[: len(names)]]
    at += [None] * (len(names) - len(at))
    count = round(at[-1] or 0)
    if at[0] is None or at[1] is None or not 0 < count <= MOST_HOLES:
        raise InputError(
            f"{call.name}({', '.join(call.arguments)}): expected {', '.join(names)}, NUM "
            f"from 1 to {MOST_HOLES:,}"
        )
    # _VARI and _HIDE of newer controls: another pattern, places that are left out
    more = [text for text in call.arguments[len(names) :] if text.strip('0." ')]
    if more:
        raise InputError(
            f"{call.name} with {more[0]} behind NUM is not read; expected {', '.join(names)} alone"
        )
    first, second, third, fourth, fifth = (value or 0.0 for value in at[:-1])
    k = np.arange(count)
    if call.name == "HOLES1":
        along = fourth + fifth * k
        angle = np.full(count, math.radians(third))
    else:
        if third <= 0:
            raise InputError(f"HOLES2 with RAD {third:g}, expected a positive radius")
        along = np.full(count, third)
        angle = np.radians(fourth + (fifth or 360 / count) * k)
    return np.stack([first + along * np.cos(angle), second + along * np.sin(angle)], axis=1)
