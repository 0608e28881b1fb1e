"""A table as its column map tells it: its time, and its angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.column_map import TURN, UNITS, Column, ColumnMap
from irb2400_ctrl.measurement.columns.two_part_time import joined
from irb2400_ctrl.measurement.table import Table
from irb2400_ctrl.wording import numbered


def mapped(table: Table, given: ColumnMap) -> Table:
    """The table with the time of the map in one column, angles counted from the zeros that it
    states, those that it calls wrapped going on beyond a turn, and the sums that it makes.

    Raises:
        InputError: no such columns of the time, or of a sum.
    """
    table = _with_time(table, given)
    columns = dict(table.columns)
    for column in given.of(table.columns):
        if column.file in columns and column.zero:
            columns[column.file] = columns[column.file] - column.zero
        if column.file in columns and column.wrapped:
            turn = TURN / UNITS[column.quantity][column.unit]
            columns[column.file] = _unwrapped(columns[column.file], turn)
    return _summed(replace(table, columns=columns), given)


def _summed(table: Table, given: ColumnMap) -> Table:
    """With what a joint does in the place of a column that holds what others do as well."""
    there: dict[tuple[str, object], Column] = {
        (column.quantity, column.joint): column
        for column in given.of(table.columns)
        if column.file in table.columns
    }
    columns = dict(table.columns)
    for one in given.sums:
        for signal in one.signals:
            factors = {one.joint: 1.0, **one.plus}
            parts = {j: there[signal, j] for j in factors if (signal, j) in there}
            if not parts and signal != one.quantity:
                continue  # a log without speeds
            if len(parts) < len(factors):
                raise InputError(
                    f"{table.path}: the column map sums {signal} of joint {one.joint} and of "
                    f"{numbered('joint', list(one.plus))}, of which not all have a column"
                )
            own = parts[one.joint]
            total = np.zeros_like(table.columns[own.file])
            for j, column in parts.items():
                total += factors[j] * column.scale / own.scale * table.columns[column.file]
            columns[own.file] = total
    return replace(table, columns=columns)


def _unwrapped(values: Array, turn: float) -> Array:
    """Beginning within half a turn of zero; cells that are no numbers stay."""
    found = values.copy()
    there = np.isfinite(values)
    going_on = np.unwrap(values[there], period=turn)
    start = going_on[:1].sum()
    found[there] = going_on - turn * np.round(start / turn)
    return found


def _with_time(table: Table, given: ColumnMap) -> Table:
    """In one column; `time_s` [s] where the map states a rate."""
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
