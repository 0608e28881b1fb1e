"""The file of a trajectory: CSV or `.csv.gz`, the unit in every header name."""

from __future__ import annotations

import csv
import gzip
import math
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.trajectory.trajectory import Trajectory, from_angles


def save_trajectory(trajectory: Trajectory, path: Path | str) -> Path:
    """Write `trajectory.csv` (degrees), packed if the name ends in `.gz`."""
    path = Path(path)
    text = trajectory.csv()
    return write_atomic(
        path, gzip.compress(text.encode(), mtime=0) if path.suffix == ".gz" else text
    )


def load_trajectory(path: Path | str, axes: int = 6) -> Trajectory:
    """Read `trajectory.csv` (`time_s, q1_deg…`, optionally `qd1_deg_s…, qdd1_deg_s2…, tau1_Nm…, s`;
    rad also), `.csv` or `.csv.gz`.

    Raises:
        InputError: no such file, missing columns (which), or values that are not numbers (which
        row).
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"no trajectory file {path}; expected a CSV with time_s, q1_deg … q{axes}_deg"
        )
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open(newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        raise InputError(f"{path} is empty; expected a header and rows of numbers")
    header = [name.strip() for name in rows[0]]
    table = np.full((len(rows) - 1, len(header)), np.nan)
    for i, row in enumerate(rows[1:]):
        try:
            table[i, : len(row)] = [float(cell) for cell in row]
        except ValueError as error:
            raise InputError(
                f"{path}, line {i + 2}: {error}; expected one number per column of the header"
            ) from error
    time = _columns(path, header, table, ["time_s"])
    q = _angles(path, header, table, "q", "", axes)
    if time is None or q is None:
        raise InputError(
            f"{path} lacks time_s or q1_deg … q{axes}_deg (or _rad); its columns are "
            f"{', '.join(header)}"
        )
    qd = _angles(path, header, table, "qd", "_s", axes)
    qdd = _angles(path, header, table, "qdd", "_s2", axes)
    if qd is None or qdd is None:
        return from_angles(time[:, 0], q)
    tau = _columns(path, header, table, [f"tau{j + 1}_Nm" for j in range(axes)])
    s = _columns(path, header, table, ["s"])
    motion = Trajectory(time[:, 0], q, qd, qdd, tau, None if s is None else s[:, 0])
    motion.check_moves()
    return motion


def _angles(
    path: Path, header: list[str], table: Array, name: str, per: str, axes: int
) -> Array | None:
    for unit, factor in (("deg", math.pi / 180), ("rad", 1.0)):
        found = _columns(path, header, table, [f"{name}{j + 1}_{unit}{per}" for j in range(axes)])
        if found is not None:
            return factor * found
    return None


def _columns(path: Path, header: list[str], table: Array, names: list[str]) -> Array | None:
    present = [name in header for name in names]
    if any(present) and not all(present):
        missing = [name for name, there in zip(names, present, strict=True) if not there]
        raise InputError(f"{path} lacks the columns {', '.join(missing)}")
    return table[:, [header.index(name) for name in names]] if all(present) else None
