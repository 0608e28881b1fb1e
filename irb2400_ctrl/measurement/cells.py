"""The cells of a table: rows that hold no sample or the same again, and cells that are no
numbers."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Mask
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import Table

_MARKED = re.compile(r"[+-]?\d{1,3}(?:[.,'’ \u00a0\u202f]\d{3})+(?:[.,]\d+)?")
"""a number with marks between its thousands"""


def without_blank_rows(table: Table, signals: set[str]) -> Table:
    """Without the rows that hold no sample of the arm (of another topic, another recorder)."""
    there = [name for name in signals if name in table.columns]
    if not there:
        return table
    blank = np.isnan(table.columns[there[0]])
    for name in there[1:]:
        if not blank.any():
            return table
        blank &= np.isnan(table.columns[name])
    if not blank.any() or blank.all():
        return table
    return _kept(table, ~blank)


def without_doubled_rows(table: Table, used: set[str]) -> Table:
    """Without the rows that say the same as the one before, the time included: a recorder that asks
    more often than the robot answers writes them."""
    doubled = np.ones(max(len(table.columns[next(iter(used))]) - 1, 0), dtype=bool)
    for name in used:
        doubled &= np.diff(table.columns[name]) == 0.0
        if not doubled.any():
            return table
    return _kept(table, np.concatenate([[True], ~doubled]))


def _kept(table: Table, keep: Mask) -> Table:
    """Some of its rows, which keep their numbers."""
    columns = {name: values[keep] for name, values in table.columns.items()}
    rows = np.arange(len(keep)) if table.rows is None else table.rows
    return replace(table, columns=columns, rows=rows[keep])


def without_zeros_behind(table: Table, used: set[str]) -> Table:
    """Without the last rows of nothing but zeros in the columns that matter, the time too, of an
    array that was longer than the record."""
    zero = np.all([table.columns[name] == 0.0 for name in used], axis=0)
    there = np.flatnonzero(~zero)
    if not zero[-1:].any() or not len(there):
        return table
    keep = slice(int(there[-1]) + 1)
    rows = None if table.rows is None else table.rows[keep]
    columns = {name: values[keep] for name, values in table.columns.items()}
    return replace(table, columns=columns, rows=rows)


def all_finite(table: Table, used: set[str]) -> None:
    """Refuse cells that are not finite numbers in the columns that matter, and say where they
    are."""
    names = [name for name in table.columns if name in used]
    bad = {name: np.flatnonzero(~np.isfinite(table.columns[name])) for name in names}
    count = sum(map(len, bad.values()))
    if count:
        row, _, name = min(
            (int(bad[name][0]), k, name) for k, name in enumerate(names) if len(bad[name])
        )
        first = row == 0 and (table.rows is None or table.rows[0] == 0)
        word = table.words.get(name, "") if first else ""
        marked = _MARKED.fullmatch(word) is not None
        wanted = "no mark between thousands" if marked else "numbers (a time in seconds)"
        raise InputError(
            f"{table.path}: {count} cells are not finite numbers, the first is {name} in "
            f"{table.place(row)}"
            + (
                f", where {word[:40]!r} stands; expected {wanted}"
                if word
                else f"; expected numbers everywhere: {_cure(table, names)}"
            )
        )


def _cure(table: Table, names: list[str]) -> str:
    """What to do about cells that hold nothing."""
    if np.isfinite([table.columns[name] for name in names]).all(axis=0).any():
        return "delete the rows of lost samples"
    return (
        "no row holds all signals, as where each stands at times of its own: put them at the times "
        "of one (pandas: table.set_index(time).interpolate('index'), then keep the rows of that "
        "one)"
    )
