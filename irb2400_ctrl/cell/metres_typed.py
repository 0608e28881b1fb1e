"""Whether places that are stated in millimetres look like metres."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.description import Cell

# a place that is stated, and no farther than this, has the numbers of one in metres [m]
_NEAR = 5e-3
# and so has a tip; one that was measured may differ by less [m]
_TIPS = (1e-5, 1e-3)


def metres_typed(cell: Cell | None, frame: Array | None) -> str | None:
    """What to ask where a place or a tool's tip has the numbers of metres; None where none has.

    Args:
        cell: its tools.
        frame: X_BW that a program is planned in, shape (4, 4).
    """
    for what, place, least, most in _stated(cell, frame):
        far = float(np.abs(place).max())
        if least < far < most:
            numbers = ", ".join(f"{1e3 * v:.4g}" for v in place)
            return (
                f"{what} at {numbers} mm, which is next to nothing: if these are metres, state "
                f"{', '.join(f'{1e6 * v:.4g}' for v in place)}"
            )
    return None


def _stated(cell: Cell | None, frame: Array | None) -> Iterator[tuple[str, Array, float, float]]:
    """Names, places [m], and between which distances they are asked for [m]."""
    if frame is not None:
        yield "the work frame stands", frame[:3, 3], 0.0, _NEAR
    for tool in () if cell is None else cell.tools:
        yield f"tool {tool.name} has its tip (offset_mm)", np.array(tool.offset_mm) / 1e3, *_TIPS
