"""Angles that a recorder counts from elsewhere than the joint's zero: 2048 pulses of a servo."""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.measurement.columns.column_map import ColumnMap
from irb2400_ctrl.measurement.table import Table


def from_zero(table: Table, given: ColumnMap) -> Table:
    """The table with the angles counted from the zeros that the map states."""
    columns = dict(table.columns)
    for column in given.of(table.columns):
        if column.zero and column.file in columns:
            columns[column.file] = columns[column.file] - column.zero
    return replace(table, columns=columns)
