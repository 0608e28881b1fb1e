"""The column map that a table without names probably needs, from the numbers alone.

A time rises evenly; angles are columns side by side whose changes other columns side by side are
the rates of, and accelerations the rates of these. What else stands there in such a block may be a
torque, a current or a command: which of them, nothing in the file says. Of two blocks alone the
smooth one are the angles, where the other depends on them. What is found is shown to be checked,
never used by itself.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.columns.rates import (
    ALIKE,
    GOES_WITH,
    LEAST,
    MOST_ROWS,
    STILL,
    WIDTH,
    correlation,
    rates,
)
from irb2400_ctrl.measurement.columns.recorder_names import unit_by_step
from irb2400_ctrl.measurement.columns.suggested_map import DEGREES

STRAIGHT = 0.01
"""of its span, that a time may be off the straight line"""
SMOOTHER = 5.0
"""times that angles are smoother than torques"""
EXPLAINED = 0.5
"""of the variance of torques, by the weight of bodies and the direction of motion"""
COUNTS = (6, 7)
"""joints of an arm that is not known"""


class Blocks(NamedTuple):
    """What is known of columns side by side.

    Args:
        joints: how many columns a block has.
        angle: first column of the angles, from 0.
        rates: that of the speeds, then that of the accelerations, as far as they are there.
        speed_ratio: change of an angle in a row over its speed.
    """

    joints: int
    angle: int
    rates: Sequence[int]
    speed_ratio: float = 0.0


def guessed_places(columns: Mapping[str, Array], joints: Sequence[str] | None) -> str:
    """The end of a message: a column map to be checked; empty where the numbers do not tell.

    Args:
        columns: of the file by name, `column 1`… or the places of a matrix, `data[1]`….
        joints: names of the robot's joints, where they are known.
    """
    form, names = _counted(columns)
    if joints and len(columns) < 2 * len(joints):
        return (
            f"; {len(columns)} columns cannot hold angles and torques of {len(joints)} joints, and "
            "a log needs both (of signals in files of their own, put the columns into one)"
        )
    if len(names) < 2 * LEAST:
        return ""
    table = np.column_stack([columns[name][:MOST_ROWS] for name in names])
    if len(table) < 10 * WIDTH or not np.isfinite(table).all():
        return ""
    clock = _clock(table)
    for n in (len(joints),) if joints else COUNTS:
        found = _rates(table, n, clock) or _smooth_beside_rough(table, n)
        if found is not None:
            return _map(form, table, clock, found)
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


def _rates(table: Array, n: int, clock: int | None) -> Blocks | None:
    """Angles with the speeds that go with them; and accelerations, where these are there."""
    pairs = _pairs(table, n, clock)
    if not pairs:
        return None
    speeds = {speed for _, speed, _ in pairs}
    angle, speed, ratio = next((pair for pair in pairs if pair[0] not in speeds), pairs[0])
    known = [speed, *[rate for of, rate, _ in pairs if of == speed][:1]]
    return Blocks(n, angle, known, speed_ratio=ratio)


def _pairs(table: Array, n: int, clock: int | None) -> list[tuple[int, int, float]]:
    """Where blocks of n columns begin whose changes go with the n columns of another one, where
    that begins, and the change in a row over its rate."""
    known = rates(table)
    if clock is not None:
        known.moves[clock] = False
    goes = correlation(known)
    power = np.sum(known.sums**2, axis=0)
    starts = range(table.shape[1] - n + 1)
    pairs = []
    for angle in starts:
        inside = np.flatnonzero(known.moves[angle : angle + n])
        if len(inside) < LEAST or (clock is not None and angle <= clock < angle + n):
            continue
        for speed in starts:
            apart = abs(speed - angle) >= n
            if apart and goes[angle + inside, speed + inside].min() > GOES_WITH:
                changes = known.changes[:, angle + inside]
                products = np.sum(changes * known.sums[:, speed + inside], axis=0)
                ratios = products / power[speed + inside]
                if ratios.max() < ALIKE * ratios.min():
                    pairs.append((angle, speed, float(np.median(ratios))))
    return pairs


def _smooth_beside_rough(table: Array, n: int) -> Blocks | None:
    """Angles beside torques alone: one of two blocks of n columns is smooth, and the other goes
    with it."""
    free = [k for k in range(table.shape[1]) if not _is_time(table[:, k])]
    if len(free) != 2 * n or free[n - 1] - free[0] != n - 1 or free[-1] - free[n] != n - 1:
        return None
    travel = np.ptp(table[:, free], axis=0).reshape(2, n)
    moves = (travel > STILL).all(axis=0)
    if np.count_nonzero(moves) < LEAST:
        return None
    jerks = np.std(np.diff(table[:, free], 2, axis=0), axis=0).reshape(2, n)[:, moves]
    rough, other = jerks / travel[:, moves]
    times = float(np.median(rough / other))
    if 1.0 / SMOOTHER < times < SMOOTHER:
        return None
    angle, torque = (free[0], free[n]) if times < 1.0 else (free[n], free[0])
    q = table[:, angle : angle + n]
    tau = table[:, torque : torque + n][:, moves]
    explained = _explained(q * (np.pi / 180 if np.abs(q).max() > DEGREES else 1.0), tau)
    return Blocks(n, angle, []) if explained > EXPLAINED else None


def _explained(q: Array, tau: Array) -> float:
    """Share of the variance of torques that goes with angles [rad] and the direction of motion, in
    the median."""
    moved = q[WIDTH:] - q[:-WIDTH]
    there = q[WIDTH // 2 : WIDTH // 2 - WIDTH]
    columns = [np.ones((len(there), 1)), np.sin(there), np.cos(there), np.sign(moved)]
    wanted = tau[WIDTH // 2 : WIDTH // 2 - WIDTH]
    basis = np.hstack(columns)
    left = wanted - basis @ np.linalg.lstsq(basis, wanted, rcond=None)[0]
    return float(np.median(1.0 - np.var(left, axis=0) / np.var(wanted, axis=0)))


def _map(form: str, table: Array, clock: int | None, found: Blocks) -> str:
    """The map as text."""
    n = found.joints
    turns = bool(np.abs(table[:, found.angle : found.angle + n]).max() > DEGREES)
    taken = {k for first in (found.angle, *found.rates) for k in range(first, first + n)}
    free = _free(table.shape[1], n, {*taken, clock})
    lines = ["[time]", "rate_Hz = nan   # samples a second: no column rises as a time does", ""]
    rate = "deg_s" if turns else "rad_s"
    if clock is not None:
        scale = unit_by_step(table[:, clock]) or 1.0
        unit = {1e-3: "ms", 1e-6: "us", 1e-9: "ns"}.get(scale, "s")
        step = scale * float(table[-1, clock] - table[0, clock]) / (len(table) - 1)
        if turns and 1.0 / ALIKE < np.radians(found.speed_ratio) / step < ALIKE:
            rate = "rad_s"
        lines = ["[time]", f'column = "{form.format(clock + 1)}"', f'unit = "{unit}"', ""]
    lines += _entry(form, n, found.angle, ("q", "deg" if turns else "rad"))
    if found.rates:
        lines += _entry(form, n, found.rates[0], ("qd", rate))
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
    """One table of the map."""
    place = f"{{j+{first}}}" if first else "{j}"
    return [
        "[[columns]]",
        f'file = "{form.format(place)}"',
        f"joints = {n}",
        f'quantity = "{told[0]}"',
        f'unit = "{told[1]}"',
        "",
    ]
