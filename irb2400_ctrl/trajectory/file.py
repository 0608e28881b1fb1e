"""The file of a trajectory: CSV or `.csv.gz`, the unit in every header name."""

from __future__ import annotations

import gzip
import math
import re
from array import array
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.reading import looks_like, text_blocks
from irb2400_ctrl.trajectory.trajectory import Trajectory, from_angles
from irb2400_ctrl.typed import typed

MOST_NUMBERS = 26_000_000
"""of one file: a million rows with everything, 67 minutes at 4 ms"""

_UNITS = {"deg": math.pi / 180, "rad": 1.0}
_ANGLE = re.compile(r"q(\d{1,2})_(?:deg|rad)")
_NAME = re.compile(r"(time|q|qd|qdd|e|ed|edd|tau|s)\d*(_\w{1,20})?")


@typed
def save_trajectory(trajectory: Trajectory, path: Path | str) -> Path:
    """Write `trajectory.csv` (degrees), packed if the name ends in `.gz`."""
    path = Path(path)
    text = trajectory.csv()
    return write_atomic(
        path, gzip.compress(text.encode(), mtime=0) if path.suffix == ".gz" else text
    )


@typed
def load_trajectory(path: Path | str, axes: int | None = None) -> Trajectory:
    """Read `trajectory.csv` (`time_s, q1_deg…`, optionally `qd1_deg_s…, qdd1_deg_s2…, tau1_Nm…, s`,
    `e1_deg…, ed1_deg_s…, edd1_deg_s2…` of external axes, `e1_mm…` of a rail, which comes first; rad
    also), `.csv` or `.csv.gz`. It has as many axes as the file has angles `q1_deg…`; `axes` is how
    many are expected, where that is known.

    Raises:
        InputError: no such file, missing columns (which), another number of axes, or values that
        are not numbers (which row).
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"no trajectory file {path}; expected a CSV with time_s, q1_deg, q2_deg …")
    header, table = _table(path)
    axes = _axes(path, header, axes)
    doubled = sorted({name for name in header if header.count(name) > 1 and _NAME.fullmatch(name)})
    if doubled:
        raise InputError(f"{path}: found the column {doubled[0]} more than once, expected one")
    time = _columns(path, header, table, ["time_s"])
    q = _angles(path, header, table, "q", "", axes)
    if time is None or q is None:
        known = ", ".join(name for name in header if _NAME.fullmatch(name)) or "none of a motion"
        angles = f"q1_deg … q{axes}_deg" if axes > 1 else "q1_deg, q2_deg …"
        raise InputError(
            f"{path} lacks time_s or {angles} (or _rad); its columns are {known}"
            + looks_like(header, "motion")
        )
    qd = _angles(path, header, table, "qd", "_s", axes)
    qdd = _angles(path, header, table, "qdd", "_s2", axes)
    if qd is None or qdd is None:
        return from_angles(time[:, 0], q)
    tau = _columns(path, header, table, [f"tau{j + 1}_Nm" for j in range(axes)])
    s = _columns(path, header, table, ["s"])
    external = _external(path, header, table, time[:, 0])
    way = None if s is None else s[:, 0]
    motion = Trajectory(time[:, 0], q, qd, qdd, tau, way, external=external)
    motion.check_moves()
    return motion


def _axes(path: Path, header: list[str], expected: int | None) -> int:
    """The highest number of an angle in the header, 1 where there is none."""
    numbers = [match[1] for name in header if (match := _ANGLE.fullmatch(name))]
    if "0" in numbers:
        raise InputError(f"{path}: found q0, expected angles that count from q1")
    found = max(map(int, numbers), default=expected or 1)
    if expected not in (None, found):
        raise InputError(f"{path}: found q1 … q{found}, expected {expected} axes")
    return found


def _external(path: Path, header: list[str], table: Array, time: Array) -> Trajectory | None:
    """Axes beside the arm; None where the file has none."""
    count = sum(bool(re.fullmatch(r"e\d+_(deg|rad|mm)", name)) for name in header)
    slides = int("e1_mm" in header)
    parts = ("e", ""), ("ed", "_s"), ("edd", "_s2")
    found = [
        _further(path, header, table, name, per, count, slides) for name, per in parts if count
    ]
    if any(values is None for values in found):
        unit = "mm" if slides else "deg"
        raise InputError(
            f"{path}: found e1 … e{count}, expected their speeds ed1_{unit}_s … and accelerations "
            f"edd1_{unit}_s2 … beside them; the first one may be a rail (mm), not a later one"
        )
    moves = [values for values in found if values is not None]
    return Trajectory(time, *moves, lengths=(0,) * slides) if moves else None


def _further(
    path: Path, header: list[str], table: Array, name: str, per: str, count: int, slides: int
) -> Array | None:
    """Columns of axes beside the arm: a rail where there is one, then those that turn."""
    turning = (
        _angles(path, header, table, name, per, count, 1 + slides)
        if count > slides
        else np.empty((len(table), 0))
    )
    if not slides or turning is None:
        return turning
    rail = _columns(path, header, table, [f"{name}1_mm{per}"])
    return None if rail is None else np.hstack([1e-3 * rail, turning])


def _table(path: Path) -> tuple[list[str], Array]:
    """Names and numbers (m, k) of a CSV.

    What stands in a line that is no number is not repeated: a study names any file.
    """
    lines = (line for block in text_blocks(path) for line in block.decode().split("\n")[:-1])
    header: list[str] = []
    values = array("d")
    separator = ","
    for number, line in enumerate(lines, 1):
        if not header:
            # as a spreadsheet saves it where the comma is that of decimals
            separator = max((",", ";", "\t"), key=line.count)
        pointed = line if separator == "," else line.replace(",", ".")
        cells = [cell.strip().strip('"') for cell in pointed.split(separator)]
        if not header:
            header = cells if line.strip() else []
        elif line.strip():
            if len(cells) != len(header):
                raise InputError(
                    f"{path}, line {number}: found {len(cells)} cells, expected {len(header)} as "
                    "in the header"
                )
            try:
                values.extend(map(float, cells))
            except ValueError as error:
                raise InputError(
                    f"{path}, line {number}: a cell is not a number, expected a motion: one number "
                    "per column of the header"
                ) from error
        if len(values) > MOST_NUMBERS:
            raise InputError(
                f"{path}: more than {MOST_NUMBERS:,} numbers, expected a motion; cut it into parts"
            )
    if not header:
        raise InputError(f"{path} is empty; expected a header and rows of numbers")
    return header, np.array(values).reshape(-1, len(header))


def _angles(
    path: Path, header: list[str], table: Array, name: str, per: str, axes: int, first: int = 1
) -> Array | None:
    numbers = range(first, axes + 1)
    found = {
        unit: _columns(path, header, table, [f"{name}{j}_{unit}{per}" for j in numbers])
        for unit in _UNITS
    }
    given = {unit: values for unit, values in found.items() if values is not None}
    if len(given) > 1:
        raise InputError(
            f"{path}: found {name}1_deg{per} and {name}1_rad{per}, expected angles in one unit"
        )
    return next((_UNITS[unit] * values for unit, values in given.items()), None)


def _columns(path: Path, header: list[str], table: Array, names: list[str]) -> Array | None:
    present = [name in header for name in names]
    if any(present) and not all(present):
        missing = [name for name, there in zip(names, present, strict=True) if not there]
        raise InputError(f"{path} lacks the columns {', '.join(missing)}")
    return table[:, [header.index(name) for name in names]] if all(present) else None
