"""Whether angles that are stated in degrees look like radians."""

from __future__ import annotations

import math
from collections.abc import Iterator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.description import Cell
from irb2400_ctrl.robot.shape import place_and_turn

# how far from a quarter turn a typed number of radians may be: 1.57, 3.14, 6.28
_DIGITS = 6e-4


def radians_typed(cell: Cell | None, frame: Array | None) -> str | None:
    """What to ask where an angle is the number of a quarter turn or more in radians; None where
    none is.

    Args:
        cell: its shapes, its work object, its positioner.
        frame: X_BW that a program is planned in, shape (4, 4).
    """
    for what, angles in _stated(cell, frame):
        for angle in angles:
            quarters = round(abs(angle) / (math.pi / 2))
            if 1 <= quarters <= 4 and math.isclose(
                abs(angle), quarters * math.pi / 2, rel_tol=_DIGITS
            ):
                return (
                    f"{what} has an angle of {angle:.6g} degrees, which are {90 * quarters} "
                    "degrees as radians: state it in degrees"
                )
    return None


def _stated(cell: Cell | None, frame: Array | None) -> Iterator[tuple[str, tuple[float, ...]]]:
    if frame is not None:
        yield "the work frame", place_and_turn(frame)[1]
    if cell is None:
        return
    for thing in cell.things:
        for shape in thing.shapes:
            yield thing.name, getattr(shape, "turn_deg", ())
    if cell.positioner is not None:
        plate = cell.positioner
        stated = [plate.position_deg, *plate.operations.values()]
        yield "the positioner", tuple(a for s in stated if not isinstance(s, str) for a in s)
        for axis in (plate.tilt, plate.turn):
            yield "the positioner", axis.range_deg
