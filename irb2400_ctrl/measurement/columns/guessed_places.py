"""The column map that a table without names probably needs, from the numbers alone.

A time rises evenly; angles are columns side by side whose changes other columns side by side are
the rates of. What else stands there in such a block may be a torque, a current or a command: which
of them, nothing in the file says. What is found is shown to be checked, never used by itself.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.measurement.columns.recorder_names import unit_by_step
from irb2400_ctrl.measurement.columns.suggested_map import DEGREES

MOST_ROWS = 20_000
"""that are looked at"""
WIDTH = 8
"""rows over which changes are taken"""
STRAIGHT = 0.01
"""of its span, that a time may be off the straight line"""
GOES_WITH = 0.9
"""correlation of a change and its rate"""
ALIKE = 1.5
"""most that the ratios of joints differ by: of a speed they are one, of friction not"""
STILL = 1e-3
"""travel of a joint that is at rest"""
LEAST = 3
"""joints that must move"""
COUNTS = (6, 7)
"""joints of an arm that is not known"""


def guessed_places(columns: Mapping[str, Array], joints: Sequence[str] | None) -> str:
    """The end of a message: a column map to be checked; empty where the numbers do not tell.

    Args:
        columns: of the file by name, `column 1`… or the places of a matrix, `data[1]`….
        joints: names of the robot's joints, where they are known.
    """
    form, names = _counted(columns)
    if len(names) < 2 * LEAST:
        return ""
    table = np.column_stack([columns[name][:MOST_ROWS] for name in names])
    if len(table) < 10 * WIDTH or not np.isfinite(table).all():
        return ""
    clock = _clock(table)
    for n in (len(joints),) if joints else COUNTS:
        found = _angles(table, n, clock)
        if found is not None:
            return _map(form, table, clock, (n, *found))
    return ""


def _counted(columns: Mapping[str, Array]) -> tuple[str, list[str]]:
    """The form of the names that most columns have, `{}` in the place of their number, and these in
    order."""
    forms: dict[str, list[str]] = {}
    for name in columns:
        form = re.sub(r"\d+(?=\D*$)", "{}", name, count=1)
        forms.setdefault(form, []).append(name)
    form = max(forms, key=lambda one: len(forms[one]), default="")
    names = [form.format(k + 1) for k in range(len(forms.get(form, ())))] if "{}" in form else []
    return form, names if all(name in columns for name in names) else []


def _clock(table: Array) -> int | None:
    """The column of the time; one that counts rows only where there is no other."""
    times = [k for k in range(table.shape[1]) if _is_time(table[:, k])]
    counts = [k for k in times if (np.diff(table[:, k]) == 1.0).all()]
    return next((k for k in times if k not in counts), counts[0] if counts else None)


def _is_time(values: Array) -> bool:
    """Whether it rises all along, and along a straight line."""
    span = float(values[-1] - values[0])
    line = values[0] + span * np.linspace(0.0, 1.0, len(values))
    rises = bool((np.diff(values) >= 0.0).all()) and span > 0.0
    return rises and bool(np.abs(values - line).max() < STRAIGHT * span)


def _angles(table: Array, n: int, clock: int | None) -> tuple[int, int, float] | None:
    """Where n angles begin, where the speeds that go with them do, and the change of an angle in a
    row over its speed."""
    changes = table[WIDTH:] - table[:-WIDTH]
    sums = np.cumsum(table, axis=0)
    rates = sums[WIDTH:] - sums[:-WIDTH]
    moves = np.ptp(table, axis=0) > STILL
    if clock is not None:
        moves[clock] = False
    goes = _correlation(changes, rates, moves)
    power = np.sum(rates**2, axis=0)
    starts = range(table.shape[1] - n + 1)
    for angle in starts:
        inside = np.flatnonzero(moves[angle : angle + n])
        if len(inside) < LEAST or (clock is not None and angle <= clock < angle + n):
            continue
        for speed in starts:
            apart = abs(speed - angle) >= n
            if apart and goes[angle + inside, speed + inside].min() > GOES_WITH:
                products = np.sum(changes[:, angle + inside] * rates[:, speed + inside], axis=0)
                ratios = products / power[speed + inside]
                if ratios.max() < ALIKE * ratios.min():
                    return angle, speed, float(np.median(ratios))
    return None


def _correlation(changes: Array, rates: Array, moves: Mask) -> Array:
    """Of the changes of each column with the rates of each, shape (k, k); 0 where one is still."""
    a = (changes - changes.mean(axis=0)) * moves
    b = (rates - rates.mean(axis=0)) * moves
    size = np.outer(np.linalg.norm(a, axis=0), np.linalg.norm(b, axis=0))
    return np.asarray(a.T @ b / np.where(size > 0.0, size, np.inf))


def _map(form: str, table: Array, clock: int | None, found: tuple[int, int, int, float]) -> str:
    """The map as text.

    Args:
        form: of the names; table: columns in their order; clock: which is the time.
        found: joints, first angle, first speed, columns from 0; change of an angle in a row over
            its speed.
    """
    n, angle, speed, ratio = found
    turns = np.abs(table[:, angle : angle + n]).max() > DEGREES
    taken = {*range(angle, angle + n), *range(speed, speed + n), clock}
    free = _free(table.shape[1], n, taken)
    lines = ["[time]", "rate_Hz = nan   # samples a second: no column rises as a time does", ""]
    rate = "deg_s" if turns else "rad_s"
    if clock is not None:
        scale = unit_by_step(table[:, clock]) or 1.0
        unit = {1e-3: "ms", 1e-6: "us", 1e-9: "ns"}.get(scale, "s")
        step = scale * float(table[-1, clock] - table[0, clock]) / (len(table) - 1)
        if turns and 1.0 / ALIKE < np.radians(ratio) / step < ALIKE:
            rate = "rad_s"
        lines = ["[time]", f'column = "{form.format(clock + 1)}"', f'unit = "{unit}"', ""]
    lines += _entry(form, n, angle, ("q", "deg" if turns else "rad"))
    lines += _entry(form, n, speed, ("qd", rate))
    if free:
        others = ", ".join(form.format(f"{{j+{first}}}") for first in free[1:])
        lines += _entry(form, n, free[0], ("tau", "Nm"))
        lines[-1:] = [
            "# or a current (A, with Nm_per_A), a command, a computed torque: nothing says it"
            + (f"; further such columns: {others}" if others else ""),
            "",
        ]
    return (
        ". By the numbers alone it may be this map (--columns map.toml); check all of it:\n\n"
        + "\n".join(lines)
    )


def _free(count: int, n: int, taken: Collection[int | None]) -> list[int]:
    """Where blocks of n columns of none of the known begin; those before all known ones end there,
    the others begin behind one."""
    found = []
    first = next(k for k in range(count + 1) if k in taken or k == count)
    before = range(first - n, -1, -n)
    k = first
    while k + n <= count:
        if any(place in taken for place in range(k, k + n)):
            k += 1
        else:
            found.append(k)
            k += n
    return [*reversed(before), *found]


def _entry(form: str, n: int, first: int, told: tuple[str, str]) -> list[str]:
    """One table of the map.

    Args:
        form: of the names; n: joints; first: column from 0; told: quantity and unit.
    """
    place = f"{{j+{first}}}" if first else "{j}"
    return [
        "[[columns]]",
        f'file = "{form.format(place)}"',
        f"joints = {n}",
        f'quantity = "{told[0]}"',
        f'unit = "{told[1]}"',
        "",
    ]
