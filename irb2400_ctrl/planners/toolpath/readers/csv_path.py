"""CSV tool paths: `x_mm,y_mm,z_mm` with a tool axis or an orientation, and a feed; with
semicolons or tabs between the cells the decimal sign may be a comma."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Note, Operation
from irb2400_ctrl.planners.toolpath.readers.apt.statements import number
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.reading import looks_like

POINT = ["x_mm", "y_mm", "z_mm"]
AXIS = ["i", "j", "k"]
QUATERNION = ["qw", "qx", "qy", "qz"]
FEED = "feed_mm_s"
LENGTH = re.compile(r"[\W_]*(mm|cm|m|in|inch)?\W*$")
"""the unit behind the name of a place"""
MOST_NAMED = 8
"""columns that a message repeats"""
# a column that sounds like motion and is not read would change the motion in silence
MOTION = re.compile(
    r"(feed|fedrat|speed|vel|rapid|time|t_|f$|f_|[xyzabcuvwijk]$|[xyzabcuvw]_|r[xyz]|q[wxyz]|roll"
    r"|pitch|yaw|tool|spindle)",
    re.IGNORECASE,
)


def read_csv(text: str, name: str, unit: float) -> CamProgram:
    """A program of one operation from CSV with a header; lines that begin with # are comments.

    Args:
        text: of the file.
        name: of the file, for messages.
        unit: of the places, against the header [m].

    Raises:
        InputError: a column is missing or not known although it sounds like motion, or a value is
            wrong; the message has its line.
    """
    lines = [
        (line, row) for line, row in enumerate(text.split("\n"), 1) if row.strip() and row[0] != "#"
    ]
    if not lines:
        raise InputError(
            f"{name} is empty: expected a header x_mm,y_mm,z_mm,i,j,k and one row per point"
        )
    separator = max((",", ";", "\t"), key=lines[0][1].count)
    first = _cells(lines[0][1], f"{name}, line {lines[0][0]}", separator)
    header = [cell.strip() for cell in first]
    full, others = _columns(header, name, lines[0][0])
    wanted = POINT + (QUATERNION if full else AXIS) + ([FEED] if FEED in header else [])
    table = _table(lines[1:], header, wanted, name, separator)
    numbers = [line for line, _ in lines[1:]]
    path = _path(table, full, FEED in header, name, numbers, unit)
    notes = [Note("ignored", lines[0][0], f"column {column}") for column in others]
    if not np.isfinite(path.feed).any():
        says = f"the column {FEED} is empty" if FEED in header else f"no column {FEED}"
        says += ": no feed is stated, and the moves are as fast as the limits of the arm allow"
        notes.append(Note("assumed", lines[0][0], says))
    operation = Operation(
        1, path.name, path, ~np.isfinite(path.feed), np.array(numbers, dtype=np.int64)
    )
    return CamProgram(Path(name).name, "CSV", (operation,), tuple(notes), units_stated=False)


def _columns(header: list[str], name: str, line: int) -> tuple[bool, list[str]]:
    """Whether the orientation is full, and the columns that are left aside."""
    missing = [key for key in POINT if key not in header]
    if missing:
        told = ",".join(header[:MOST_NAMED]) + ",…" * (len(header) > MOST_NAMED)
        raise InputError(
            f"{name}, line {line}: no column {', '.join(missing)} in the header "
            f"{told}{_renamed(header, missing)}"
        )
    twice = sorted({key for key in header if header.count(key) > 1})
    if twice:
        raise InputError(f"{name}, line {line}: found the column {twice[0]} twice, expected once")
    if set(AXIS) <= set(header) and set(QUATERNION) <= set(header):
        raise InputError(f"{name}: found both i,j,k and qw,qx,qy,qz; expected one of the two")
    full = set(QUATERNION) <= set(header)
    if not full and not set(AXIS) <= set(header):
        raise InputError(
            f"{name}: no orientation; expected columns i,j,k (tool axis) or qw,qx,qy,qz"
        )
    known = {*POINT, *(QUATERNION if full else AXIS), FEED}
    others = [key for key in header if key not in known]
    motion = [key for key in others if MOTION.match(key)]
    if motion:
        raise InputError(
            f"{name}, line {line}: the column {motion[0]!r} is not read; expected "
            f"{', '.join([*POINT, *AXIS])} (or {', '.join(QUATERNION)}) and {FEED} [mm/s]; rename "
            "or remove it"
        )
    return full, others


def _renamed(header: list[str], missing: list[str]) -> str:
    """What to write for the places, where they are there without their unit or in another one; else
    what the columns are of."""
    there = {LENGTH.sub("", key.lower()): key for key in header}
    if not {key.removesuffix("_mm") for key in missing} <= there.keys():
        return looks_like(header, "path")
    key = there[missing[0][0]]
    example = f"write the unit into the names: {missing[0]} for {key}"
    unit = LENGTH.search(key.lower())
    if unit is None or unit[1] in {None, "mm"}:
        return f"; {example}"
    return f"; places are in mm: write {missing[0]} for {key}, and their numbers in mm"


def _table(
    lines: list[tuple[int, str]], header: list[str], wanted: list[str], name: str, separator: str
) -> Array:
    columns = [header.index(key) for key in wanted]
    rows = []
    for line, text in lines:
        cells = _cells(text, f"{name}, line {line}", separator)
        if separator != ",":
            cells = [cell.replace(",", ".") for cell in cells]
        if len(cells) != len(header):
            raise InputError(
                f"{name}, line {line}: found {len(cells)} values, expected {len(header)}"
            )
        row = []
        for key, column in zip(wanted, columns, strict=True):
            cell = cells[column]
            blank_feed = key == FEED and not cell.strip()
            place = f"{name}, line {line}, column {key}"
            row.append(math.inf if blank_feed else _number(cell, place))
        rows.append(row)
    if len(rows) < 2:
        raise InputError(f"{name}: found {len(rows)} point(s), expected at least 2")
    return np.array(rows)


def _cells(text: str, place: str, separator: str) -> list[str]:
    """The cells of one line: a quoted one may hold commas, but no end of line."""
    try:
        (cells,) = csv.reader([text], strict=True, delimiter=separator, skipinitialspace=True)
    except csv.Error as error:
        raise InputError(
            f"{place}: the quotes do not fit or a cell is too long ({error}), expected one "
            "value for each column"
        ) from error
    return cells


def _number(cell: str, place: str) -> float:
    try:
        return number(cell, place)
    except InputError:
        # as written, not in APT's capitals
        wrong = f"{place}: found {cell.strip()!r}, expected a number"
        try:
            value = float(cell)
        except ValueError:
            raise InputError(wrong) from None
        raise InputError(f"{place}: found {value}, expected a finite number") from None


def _path(
    table: Array, full: bool, fed: bool, name: str, lines: list[int], unit_m: float
) -> ToolPath:
    feed = table[:, -1] / 1e3 if fed else np.full(len(table), np.inf)
    _check_rows(name, lines, feed <= 0, "feed_mm_s is not positive")
    directions = table[:, 3:7] if full else table[:, 3:6]
    norm = np.linalg.norm(directions, axis=1)
    # CAM rounds to a few digits; a norm far from 1 means the columns hold something else
    what, such = ("quaternion", "1,0,0,0") if full else ("tool axis i,j,k", "0,0,1")
    wrong = f"the {what} does not have length 1; expected a direction such as {such}"
    _check_rows(name, lines, np.abs(norm - 1) > 0.02, wrong)
    unit = directions / norm[:, None]
    stem = Path(name).stem
    if full:
        return ToolPath(unit_m * table[:, :3], None, quaternion_matrix(unit), feed, stem)
    return ToolPath(unit_m * table[:, :3], unit, None, feed, stem)


def quaternion_matrix(q: Array) -> Array:
    """Rotation matrices (n, 3, 3) of unit quaternions w, x, y, z (n, 4)."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _check_rows(name: str, lines: list[int], wrong: npt.NDArray[np.bool_], what: str) -> None:
    if wrong.any():
        raise InputError(f"{name}, line {lines[int(np.argmax(wrong))]}: {what}")
