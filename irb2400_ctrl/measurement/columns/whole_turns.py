"""Angles that a recorder keeps within one turn: 359 deg, then 1 deg."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.measurement.columns.column_map import TURN, UNITS, ColumnMap
from irb2400_ctrl.measurement.table import Table


def unwrapped(table: Table, given: ColumnMap) -> Table:
    """The table with the columns that the map calls wrapped going on beyond a turn; each begins
    within half a turn of zero.

    Args:
        table: as read; cells that are no numbers stay.
        given: the map.
    """
    columns = dict(table.columns)
    for column in given.of(table.columns):
        if column.wrapped and column.file in columns:
            turn = TURN / UNITS[column.quantity][column.unit]
            values = columns[column.file].copy()
            there = np.isfinite(values)
            going_on = np.unwrap(values[there], period=turn)
            start = going_on[:1].sum()
            values[there] = going_on - turn * np.round(start / turn)
            columns[column.file] = values
    return replace(table, columns=columns)
