"""The time of a table as a column map tells it: in one column, in two, or by the rate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.column_map import ColumnMap
from irb2400_ctrl.measurement.columns.two_part_time import joined
from irb2400_ctrl.measurement.table import Table


def with_time(table: Table, given: ColumnMap) -> Table:
    """The table with the time of the map in one column; `time_s` [s] where the map states a rate.

    Raises:
        InputError: no such columns.
    """
    time = given.time
    if time is None:
        return table
    if time.rate_Hz is not None:
        named = (column.file for column in given.of(table.columns))
        count = next((len(table.columns[name]) for name in named if name in table.columns), 0)
        rows = np.arange(count) if table.rows is None else table.rows
        return replace(table, columns={**table.columns, "time_s": rows / time.rate_Hz})
    pair = time.pair
    if pair is None:
        return table
    if pair.seconds in table.columns and pair.beyond in table.columns:
        return joined(table, pair, into=pair.seconds)
    raise InputError(
        f"{table.path}: no columns {pair.seconds!r} and {pair.beyond!r} that the column map names "
        f"as the time; found {table.some}"
    )
