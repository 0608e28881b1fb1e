"""`read_log`: a recorded motion from any file the field writes.

Names carry the unit: `time_s`, `q1_deg`… or `q1_rad`…, optionally `qd1_deg_s`… or `qd1_rad_s`…,
`tau1_Nm`…, optionally `q1_ref_deg`… or `q1_ref_rad`…; any order; other columns are kept aside. A
column map says what columns of other names are. Where no column is called so, names of signal
recorders with the unit in brackets are understood too (`signal_names`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.binary_table import (
    read_hdf5_table,
    read_mat_table,
    read_npz_table,
    read_parquet_table,
)
from irb2400_ctrl.measurement.cells import (
    all_finite,
    without_blank_rows,
    without_doubled_rows,
    without_zeros_behind,
)
from irb2400_ctrl.measurement.columns.column_map import ColumnMap, load_column_map
from irb2400_ctrl.measurement.columns.understood import clock_of, understood
from irb2400_ctrl.measurement.csv_table import read_csv_table
from irb2400_ctrl.measurement.instants.grouped_stamps import stamps_apart
from irb2400_ctrl.measurement.instants.time_base import vouched_for
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.other_files import refuse_other_files
from irb2400_ctrl.measurement.ros_table import read_ros_table
from irb2400_ctrl.measurement.stretch import Cut, Stretch
from irb2400_ctrl.measurement.table import Table
from irb2400_ctrl.reading import lvm_blocks, refuse_stand_in, sheet_blocks, text_blocks
from irb2400_ctrl.typed import typed

READERS = {
    ".mat": read_mat_table,
    ".parquet": read_parquet_table,
    ".npz": read_npz_table,
    ".h5": read_hdf5_table,
    ".hdf5": read_hdf5_table,
}
"""by suffix; anything else is lines of text, but for"""
BAGS = (".db3", ".mcap")
"""whose joints have names"""

TEXTS = {".lvm": lvm_blocks, ".xlsx": sheet_blocks, ".xlsm": sheet_blocks}
"""by suffix, where the lines come from; of any other file they are its own"""
ROBOTS = (".toml", ".urdf", ".xacro")
"""suffixes of what is given by mistake in the place of a log"""


@typed
def read_log(
    path: Path | str,
    joints: int | None = None,
    columns: Path | str | ColumnMap | None = None,
    *,
    names: Sequence[str] | None = None,
    between: Stretch | tuple[float, float] | None = None,
    progress: Callable[[int], None] = lambda rows: None,
) -> Log:
    """The log of a file, or a stretch of it.

    Args:
        path: `.csv`, `.csv.gz` (comma, semicolon or tab; decimal comma), `.xlsx`, `.lvm`, `.mat`,
            `.parquet`, `.npz`, `.h5`, ROS 2 bag `.db3` or `.mcap`.
        joints: number of joints to expect; default as many as the names tell.
        columns: what the file's columns are, where their names do not say it.
        names: of the robot's joints in their order (`robot.joint_names`): a ROS bag names its
            joints and orders them as it likes.
        between: start <= time - time of the file's first row < end [s], default all; a CSV is read
            in a stream of which only these rows are kept. The log's clock stays that of the file.
        progress: called now and then with the number of rows of a CSV read so far.

    Raises:
        InputError: no such file, columns or units missing or contradictory, cells that are not
            numbers, time that does not rise, a rate below 10 Hz, too many rows, nothing in the
            stretch; says where and what was expected.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"no log file {path}: expected a .csv or .csv.gz with time_s, q1_deg…, tau1_Nm…"
        )
    given = (
        columns if columns is None or isinstance(columns, ColumnMap) else load_column_map(columns)
    )
    if path.suffix.lower() in ROBOTS:
        raise InputError(
            f"{path}: found a robot or a map of columns, expected a log; a robot is given with "
            "--robot, a map with --columns"
        )
    refuse_stand_in(path)
    refuse_other_files(path)
    cut = None
    if between is not None:
        stretch = between if isinstance(between, Stretch) else Stretch(*between)
        cut = Cut(stretch, lambda table: clock_of(table, given, names, joints))
    if path.suffix.lower() in BAGS:
        table = read_ros_table(path, names, ordered=given is None)
    elif path.suffix.lower() in READERS:
        table = READERS[path.suffix.lower()](path, None if given is None else given.named)
    else:
        text = TEXTS.get(path.suffix.lower(), text_blocks)
        return _named(log_of(read_csv_table(path, progress, cut, text), given, names, joints), cut)
    return _named(log_of(table if cut is None else cut.of(table), given, names, joints), cut)


def _named(log: Log, cut: Cut | None) -> Log:
    """What messages and reports call it says which stretch was taken."""
    return log if cut is None else replace(log, name=f"{log.name} ({cut.stretch})")


def log_of(
    table: Table, given: ColumnMap | None, names: Sequence[str] | None, joints: int | None = None
) -> Log:
    """The log that the columns of a table are; its arrays are taken out of the table.

    Args:
        table: by the names of its source; given, names, joints: as those of `read_log`.

    Raises:
        InputError: as `read_log`.
    """
    table, time, found, scales, n = understood(table, given, names, joints)
    used = {time[0], *(name for places in found.values() for name in places.values())}
    table = without_blank_rows(table, used - {time[0]})
    all_finite(table, used)
    table = without_doubled_rows(without_zeros_behind(table, used), used)
    found = {signal: places for signal, places in found.items() if places}
    signals = {signal: _stacked(table, places, scales, n) for signal, places in found.items()}
    stamps = _frozen(table.columns.pop(time[0]) * time[1])
    apart = stamps_apart(stamps)
    if apart is not stamps:
        # one stamp of several samples is that of a group or of a coarse clock, if the angles say so
        tried = Log(apart, signals["q"], signals["tau"], name=str(table.path))
        stamps = _frozen(apart) if vouched_for(tried) else stamps
    extra = dict(table.columns)
    return Log(
        stamps, signals.pop("q"), signals.pop("tau"), extra=extra, name=str(table.path), **signals
    )


def _stacked(table: Table, names: dict[int, str], scales: dict[str, float], n: int) -> Array:
    # each column is given up once it is in the array: a long log stands in memory once
    stacked = np.empty((len(table.columns[names[1]]), n))
    for j in range(1, n + 1):
        np.multiply(table.columns.pop(names[j]), scales[names[j]], out=stacked[:, j - 1])
    return _frozen(stacked)


def _frozen(values: Array) -> Array:
    values.setflags(write=False)
    return values
