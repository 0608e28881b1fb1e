"""CATIA's (and Creo's "APT format") arcs: `INDIRV/…` and `TLON,GOFWD/ (CIRCLE/…),ON,(LINE/…)`.

`INDIRV` is the direction of the tool at the start. `CIRCLE/xc,yc,zc,r` lies in the plane across z,
`CYLNDR/xc,yc,zc,i,j,k,r` about any axis. The motion ends where it meets `LINE/xc,yc,zc,xe,ye,ze`
(from the centre to the end point), at the second meeting with `ON,2,INTOF`; or at the last
`POINT/` of a `PLANE/`. `INDIRP/x,y,z` states a point instead of a direction, and
`CIRCLE/CANON,xc,yc,zc,i,j,k,r` an axis (PostWorks and others).
"""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, number, split_arguments
from irb2400_ctrl.planners.toolpath.readers.expansion import arcs
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc

GEOMETRY = re.compile(r"(CIRCLE|CYLNDR|LINE|POINT)\s*/\s*([^()]*)", re.IGNORECASE)


def arc_and_end(
    statement: Statement, start: Array, direction: Array | None, unit: float
) -> tuple[Arc, Array]:
    """The arc of a `TLON,GOFWD/` statement and where it ends [m].

    Raises:
        InputError: no circle or cylinder with an end, or no direction to go in.
    """
    found: dict[str, list[list[float]]] = {}
    for word, values in GEOMETRY.findall(statement.text):
        texts = [v for v in split_arguments(values) if v and v.upper() != "CANON"]
        numbers = [number(v, word.upper()) for v in texts]
        found.setdefault(word.upper(), []).append(numbers)
    arc = _circle(found, unit)
    second = re.search(r"ON\s*,\s*2\s*,\s*INTOF", statement.text, re.IGNORECASE) is not None
    stated = _stated_end(found, arc, start, unit)
    if stated is None:
        turned = _with_direction(arc, start, direction)
        return turned, _met(found, turned, start, second, unit)
    if direction is not None:
        return _with_direction(arc, start, direction), stated
    return _without_direction(arc, start, stated, second), stated


def _circle(found: dict[str, list[list[float]]], unit: float) -> Arc:
    shapes = found.get("CIRCLE", []) + found.get("CYLNDR", [])
    if len(shapes) != 1 or len(shapes[0]) not in {4, 7}:
        raise InputError(
            f"GOFWD/ is read along (CIRCLE/x,y,z,r) or (CYLNDR/x,y,z,i,j,k,r); found "
            f"{sorted(found)}"
        )
    values = shapes[0]
    normal = np.array(values[3:6]) if len(values) == 7 else np.array([0.0, 0.0, 1.0])
    if not np.linalg.norm(normal) > 1e-6 or values[-1] <= 0:
        raise InputError("the circle has no axis or no positive radius")
    centre = unit * np.array(values[:3])
    unit_normal = normal / np.linalg.norm(normal)
    return Arc(centre, unit_normal, unit * values[-1], closes=arcs.SAME_PLACE)


def _stated_end(
    found: dict[str, list[list[float]]], arc: Arc, start: Array, unit: float
) -> Array | None:
    """The last point of a plane, or the end of a line from the centre; its rounding is undone."""
    assert arc.radius is not None
    lines = [values for values in found.get("LINE", []) if len(values) == 6]
    points = [values for values in found.get("POINT", []) if len(values) == 3]
    if not lines:
        return np.asarray(unit * np.array(points[-1])) if points else None
    ends = unit * np.array(lines[-1]).reshape(2, 3)
    side = _across(ends[1] - ends[0], arc)
    length = float(np.linalg.norm(side))
    if np.linalg.norm(_across(ends[0] - arc.centre, arc)) > 1e-5 or length < 1e-9:
        return None
    level = ends[1] if abs(length - arc.radius) < 1e-4 else start
    foot = arc.centre + arc.radius * side / length
    return np.asarray(foot + ((level - foot) @ arc.normal) * arc.normal)


def _met(
    found: dict[str, list[list[float]]], arc: Arc, start: Array, second: bool, unit: float
) -> Array:
    """Where the motion meets any other line for the first or second time."""
    assert arc.radius is not None
    lines = [values for values in found.get("LINE", []) if len(values) == 6]
    if not lines:
        raise InputError("no end of the arc; expected ON,(LINE/centre,end) or a last (POINT/end)")
    ends = unit * np.array(lines[-1]).reshape(2, 3)
    way = _across(ends[1] - ends[0], arc)
    along = way / max(float(np.linalg.norm(way)), 1e-12)
    offset = _across(ends[0] - arc.centre, arc)
    foot = offset - (offset @ along) * along
    square = arc.radius**2 - float(foot @ foot)
    if square < 0:
        raise InputError("the line that shall end the arc does not meet its circle")
    height = float((start - arc.centre) @ arc.normal) * arc.normal
    both = [arc.centre + height + foot + s * math.sqrt(square) * along for s in (-1.0, 1.0)]
    both.sort(key=lambda end: arcs.sweep(arc, start, end))
    return np.asarray(both[1 if second else 0])


def _across(vector: Array, arc: Arc) -> Array:
    """The part of a vector in the plane of the arc."""
    return np.asarray(vector - (vector @ arc.normal) * arc.normal)


def _with_direction(arc: Arc, start: Array, direction: Array | None) -> Arc:
    """The arc about its axis or against it, as `INDIRV/` says."""
    if direction is None:
        raise InputError("an arc without INDIRV/ before it; which way is not known")
    tangent = np.cross(arc.normal, start - arc.centre)
    share = float(tangent @ direction)
    if abs(share) < 1e-3 * float(np.linalg.norm(tangent) * np.linalg.norm(direction)):
        raise InputError(
            "the direction INDIRV/ points across the circle at the start of the arc; "
            "expected its tangent"
        )
    return arc if share > 0 else replace(arc, normal=-arc.normal)


def _without_direction(arc: Arc, start: Array, end: Array, second: bool) -> Arc:
    """The end is the second meeting with the line through the centre beyond half a turn."""
    turn = arcs.sweep(arc, start, end)
    if abs(turn - math.pi) < 1e-3:
        raise InputError("half a circle without INDIRV/; which way round is not known")
    return arc if (turn > math.pi) == second else replace(arc, normal=-arc.normal)
