"""CATIA's (and Creo's "APT format") arcs: `INDIRV/…` and `TLON,GOFWD/ (CIRCLE/…),ON,(LINE/…)`.

`INDIRV` is the direction of the tool at the start. `CIRCLE/xc,yc,zc,r` lies in the plane across z,
`CYLNDR/xc,yc,zc,i,j,k,r` about any axis. The motion ends where it meets `LINE/xc,yc,zc,xe,ye,ze`
(from the centre to the end point), at the second meeting with `ON,2,INTOF`; or at the last
`POINT/` of a `PLANE/`.
"""

from __future__ import annotations

import math
import re

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, number, split_arguments
from irb2400_ctrl.planners.toolpath.readers.expansion import arcs
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc

Array = npt.NDArray[np.float64]
GEOMETRY = re.compile(r"(CIRCLE|CYLNDR|LINE|POINT)\s*/\s*([^()]*)", re.IGNORECASE)


def arc_and_end(
    statement: Statement, start: Array, direction: Array | None, unit: float, place: str
) -> tuple[Arc, Array]:
    """The arc of a `TLON,GOFWD/` statement and where it ends [m].

    Raises:
        InputError: no circle or cylinder with an end, or no direction to go in.
    """
    found: dict[str, list[list[float]]] = {}
    for word, values in GEOMETRY.findall(statement.text):
        numbers = [number(v, f"{place}, {word.upper()}") for v in split_arguments(values) if v]
        found.setdefault(word.upper(), []).append(numbers)
    centre, normal, radius = _circle(found, unit, place)
    end = _end(found, centre, normal, radius, start, unit, place)
    second = re.search(r"ON\s*,\s*2\s*,\s*INTOF", statement.text, re.IGNORECASE) is not None
    return _turned(Arc(centre, normal, radius), start, end, direction, second, place), end


def _circle(
    found: dict[str, list[list[float]]], unit: float, place: str
) -> tuple[Array, Array, float]:
    shapes = found.get("CIRCLE", []) + found.get("CYLNDR", [])
    if len(shapes) != 1 or len(shapes[0]) not in {4, 7}:
        raise InputError(
            f"{place}: TLON,GOFWD/ is read along (CIRCLE/x,y,z,r) or (CYLNDR/x,y,z,i,j,k,r); "
            f"found {sorted(found)}"
        )
    values = shapes[0]
    centre = unit * np.array(values[:3])
    normal = np.array(values[3:6]) if len(values) == 7 else np.array([0.0, 0.0, 1.0])
    if not np.linalg.norm(normal) > 1e-6 or values[-1] <= 0:
        raise InputError(f"{place}: the circle has no axis or no positive radius")
    return centre, normal / np.linalg.norm(normal), unit * values[-1]


def _end(
    found: dict[str, list[list[float]]],
    centre: Array,
    normal: Array,
    radius: float,
    start: Array,
    unit: float,
    place: str,
) -> Array:
    lines = [values for values in found.get("LINE", []) if len(values) == 6]
    stated = [values for values in found.get("POINT", []) if len(values) == 3]
    if lines:
        a = unit * np.array(lines[-1][:3])
        b = unit * np.array(lines[-1][3:])
        side = b - a
        side = side - (side @ normal) * normal
        if np.linalg.norm(a - centre) < 1e-5 and np.linalg.norm(side) > 1e-9:
            # from the centre through the end; rounding of the stated point does not matter
            level = b if abs(np.linalg.norm(side) - radius) < 1e-4 else start
            foot = centre + radius * side / np.linalg.norm(side)
            return np.asarray(foot + ((level - foot) @ normal) * normal)
    elif stated:
        return np.asarray(unit * np.array(stated[-1]))
    raise InputError(
        f"{place}: no end of the arc; expected ON,(LINE/centre,end) or a last (POINT/end)"
    )


def _turned(
    arc: Arc, start: Array, end: Array, direction: Array | None, second: bool, place: str
) -> Arc:
    """The arc about its axis or against it, whichever goes in the stated direction."""
    other = Arc(arc.centre, -arc.normal, arc.radius)
    if direction is not None:
        tangent = np.cross(arc.normal, start - arc.centre)
        share = float(tangent @ direction)
        if abs(share) < 1e-3 * float(np.linalg.norm(tangent) * np.linalg.norm(direction)):
            raise InputError(
                f"{place}: the direction INDIRV/ points across the circle at the start of the arc; "
                "expected its tangent"
            )
        return arc if share > 0 else other
    # without a direction: the end is the second meeting with the diameter beyond half a turn
    longer = arcs.sweep(arc, start, end) > math.pi
    if abs(arcs.sweep(arc, start, end) - math.pi) < 1e-3:
        raise InputError(f"{place}: half a circle without INDIRV/; which way round is not known")
    return arc if longer == second else other
