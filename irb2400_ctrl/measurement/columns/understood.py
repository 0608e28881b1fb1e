"""What the columns of a log are, by their names or by a column map: its time, and which signal of
which joint in which unit."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.clock import Clock
from irb2400_ctrl.measurement.columns.column_map import TIME, ColumnMap
from irb2400_ctrl.measurement.columns.column_words import meaning
from irb2400_ctrl.measurement.columns.guessed_places import guessed_places
from irb2400_ctrl.measurement.columns.mapped import mapped
from irb2400_ctrl.measurement.columns.recorder_names import (
    has_time,
    names_joints,
    recorder_columns,
    unit_by_size,
)
from irb2400_ctrl.measurement.columns.signal_names import (
    TIME_WORDS,
    joint_signal,
    strange_word,
    time_scale,
    without_source,
    without_unit,
)
from irb2400_ctrl.measurement.columns.suggested_map import suggested_map
from irb2400_ctrl.measurement.columns.two_part_time import (
    joined_time,
    stamped,
    time_pair,
)
from irb2400_ctrl.measurement.table import Table, said_of_copies, said_of_joint_rows
from irb2400_ctrl.reading import looks_like

Found = dict[str, dict[int, str]]
"""signal -> joint -> name of the column in the file"""

_COLUMN = re.compile(r"(?P<signal>qd|q|tau)(?P<joint>[1-9]\d*)(?P<ref>_ref)?_(?P<unit>\w+)")
_SCALES = {
    "q": {"deg": np.pi / 180, "rad": 1.0},
    "qd": {"deg_s": np.pi / 180, "rad_s": 1.0},
    "tau": {"Nm": 1.0, "kNm": 1e3},
    "q_ref": {"deg": np.pi / 180, "rad": 1.0},
}
NAMED_TIMES = {f"time_{unit}": scale for unit, scale in TIME.items()}
_ZEROTH = re.compile(r"(q|qd|tau)0_.*")
_BARE = re.compile(r"(time|t|(?:qd|q|tau)[1-9]\d*(?:_ref)?)")


class Understood(NamedTuple):
    """A table whose columns are known.

    Args:
        table: with its time in one column, and angles that do not jump by whole turns.
        time: name of that column, and seconds a count.
        found: which column is which signal of which joint.
        scales: SI units a count, by the name of the column.
        joints: how many there are.
    """

    table: Table
    time: tuple[str, float]
    found: Found
    scales: dict[str, float]
    joints: int


def understood(
    table: Table, given: ColumnMap | None, names: Sequence[str] | None, joints: int | None = None
) -> Understood:
    """What the columns are.

    Args:
        table: by the names of its source.
        given: what they are, where their names do not say it.
        names: of the robot's joints in their order.
        joints: how many to expect; default as many as the names tell.

    Raises:
        InputError: columns or units missing or contradictory.
    """
    if given is None:
        if table.headless:
            raise InputError(f"{table.headless}{guessed_places(table.columns, names)}")
        given_columns = table.columns
        try:
            stated = any(name in NAMED_TIMES for name in table.columns)
            if not has_time(table) or (stamped(table) and not stated):
                table = joined_time(table)
            time, found, scales = _by_name(table, names)
            n = _joints(table, found, joints)
        except InputError as error:
            told = f"{error}{said_of_copies(given_columns)}{said_of_joint_rows(given_columns)}"
            if names_joints(table):
                raise InputError(told) from error
            shown = suggested_map(given_columns, names) or guessed_places(given_columns, names)
            raise InputError(f"{told}{shown}") from error
    else:
        table = mapped(table, given)
        time, found, scales = _by_map(table, given)
        n = _joints(table, found, joints)
    return Understood(table, time, found, scales, n)


def clock_of(
    table: Table, given: ColumnMap | None, names: Sequence[str] | None, joints: int | None = None
) -> Clock:
    """Where a file holds its time.

    Args:
        table: of the file, or of its first rows; given, names, joints: as those of `understood`.

    Raises:
        InputError: as `understood`.
    """
    known = understood(table, given, names, joints)
    time = None if given is None else given.time
    if time is not None and time.rate_Hz is not None:
        return Clock((next(iter(table.columns)),), 1.0 / time.rate_Hz, counted=True)
    pair = None if time is None else time.pair
    if pair is None and known.time[0] not in table.columns:
        pair = time_pair(table.columns)
    if pair is None:
        return Clock((known.time[0],), known.time[1])
    return Clock((pair.seconds, pair.beyond), beyond=pair.counts)


def _joints(table: Table, found: Found, expected: int | None) -> int:
    """How many joints there are, each with an angle and a torque."""
    n = expected or max([max(found[s], default=0) for s in ("q", "tau")], default=0) or 6
    for signal, places in found.items():
        if places or signal in {"q", "tau"}:
            _expect_all(table, signal, places, n)
    return n


def _by_name(
    table: Table, names: Sequence[str] | None
) -> tuple[tuple[str, float], Found, dict[str, float]]:
    """Time, signals and scales as the names say."""
    found: Found = {signal: {} for signal in _SCALES}
    scales: dict[str, float] = {}
    times = [name for name in table.columns if name in NAMED_TIMES]
    without = ""
    recorded = recorder_columns(table, names)
    if recorded is not None:
        found |= recorded[1]
        return recorded[0], found, {c: 1.0 for of in found.values() for c in of.values()}
    for name in table.columns:
        match = _COLUMN.fullmatch(name)
        signal = "" if match is None else match["signal"] + (match["ref"] or "")
        if match is not None and match["unit"] in _SCALES.get(signal, {}):
            joint = int(match["joint"])
            if joint in found[signal]:
                _contradict(table, found[signal][joint], name)
            found[signal][joint] = name
            scales[name] = _SCALES[signal][match["unit"]]
        elif _ZEROTH.fullmatch(name):
            raise InputError(
                f"{table.path}: found column {name!r}, expected joints that count from 1; rename "
                "the columns, or say what they are in a column map (--columns, docs/logs.md)"
            )
        elif _BARE.fullmatch(name):
            without = without or name
    if len(times) > 1:
        _contradict(table, *times)
    if not any(found.values()):
        in_brackets = _by_brackets(table)
        if in_brackets is not None and (any(in_brackets[1].values()) or not times):
            return in_brackets
    if without:
        raise InputError(
            f"{table.path}: column {without!r} has no unit, expected for example "
            f"{_example(without)}; or a column map (--columns, docs/logs.md)"
        )
    stated = {} if times else _stated_times(table)
    if len(stated) == 1:
        return next(iter(stated.items())), found, scales
    if not times:
        raise InputError(
            f"{table.path}: no column time_s, time_ms or 'Time [s]'; found {table.some}: rename "
            "them, or say what they are in a column map (--columns, docs/logs.md)"
            + looks_like(table.columns, "motion")
        )
    return (times[0], NAMED_TIMES[times[0]]), found, scales


def _by_brackets(table: Table) -> tuple[tuple[str, float], Found, dict[str, float]] | None:
    """The same from names such as `Time [s]`, `J1 [deg]`; None where there is no such time."""
    found: Found = {signal: {} for signal in _SCALES}
    scales: dict[str, float] = {}
    times = _stated_times(table)
    for name, short in without_source(table.columns).items():
        signal = joint_signal(short)
        if signal is None:
            continue
        kind, joint, scale = signal
        if joint in found[kind]:
            _contradict(table, found[kind][joint], name)
        found[kind][joint] = name
        scales[name] = scale
    if not times and any(found.values()):
        bare = [name for name in table.columns if name.strip().lower() in TIME_WORDS]
        times = {name: unit_by_size(table.columns[name]) for name in bare}
    if len(times) > 1:
        _contradict(table, *list(times)[:2])
    return (next(iter(times.items())), found, scales) if times else None


def _stated_times(table: Table) -> dict[str, float]:
    """Columns of times by their unit in brackets, else by the unit that ends the name; seconds a
    count."""
    times = {name: scale for name in table.columns if (scale := time_scale(name)) is not None}
    return {name: scale for name, scale in times.items() if name.rstrip()[-1] in ")]）"} or times


def _by_map(table: Table, given: ColumnMap) -> tuple[tuple[str, float], Found, dict[str, float]]:
    """Time, signals and scales as a column map says."""
    found: Found = {signal: {} for signal in _SCALES}
    scales = {}
    for column in given.of(table.columns):
        assert isinstance(column.joint, int)
        if column.joint in found[column.quantity]:
            _contradict(table, found[column.quantity][column.joint], column.file)
        found[column.quantity][column.joint] = column.file
        scales[column.file] = column.scale
    time = ("time_s", 1.0)
    if given.time is not None and given.time.column is not None:
        time = (given.time.column, TIME[given.time.unit])
    if time[0] in scales:
        raise InputError(
            f"the column map names {time[0]!r} as the time and as a signal; expected two columns"
        )
    missing = [name for name in (time[0], *scales) if name not in table.columns]
    if missing:
        raise InputError(
            f"{table.path}: no column {missing[0]!r} that the column map names; found {table.some}"
        )
    return time, found, scales


def _contradict(table: Table, one: str, other: str) -> None:
    raise InputError(
        f"{table.path}: columns {one!r} and {other!r} say the same thing, expected one of them: "
        "rename the other, or name the right one in a column map (--columns, docs/logs.md)"
    )


def _expect_all(table: Table, signal: str, names: dict[int, str], n: int) -> None:
    """Refuse a signal that has not one column for every joint."""
    forms = [f"{{}}_{unit}" for unit in _SCALES[signal] if unit != "kNm"]
    missing = [j for j in range(1, n + 1) if j not in names]
    if missing:
        wanted = ", ".join(
            " or ".join(form.format(_numbered(signal, j)) for form in forms) for j in missing
        )
        plain = without_source(table.columns)
        # a name that tells nothing else is an angle's
        bare = [
            name
            for name, short in plain.items()
            if without_unit(short) and (meaning(short)[0] or "q") == signal
        ]
        unit = {"tau": "Nm", "qd": "deg/s"}.get(signal, "deg")
        hint = "".join(
            f"; {name!r} has no unit, expected '{name} [{unit}]' or a column map"
            for name in bare[:1]
        )
        strange = [(name, strange_word(short) or ("", "")) for name, short in plain.items()]
        hint += "".join(
            f"; {name!r} is not taken for the measured signal because of the word {word!r}: say "
            "in a column map what it is (--columns, docs/logs.md)"
            for name, word in [(name, word) for name, (of, word) in strange if of == signal][:1]
        )
        if signal == "tau" and any("current" in name.lower() for name in table.columns):
            hint += (
                "; currents become torques through a column map with Nm_per_A and gear_ratio "
                "(--columns, docs/logs.md)"
            )
        elif signal == "tau" and any("%" in name for name in table.columns):
            hint += (
                "; torques in per cent need a column map with full_scale_Nm (--columns, "
                "docs/logs.md)"
            )
        raise InputError(f"{table.path}: no column {wanted}; found {table.some}{hint}")
    if max(names) > n:
        raise InputError(
            f"{table.path}: found column {signal} for joint {max(names)}, expected {n} joints"
        )


def _numbered(signal: str, joint: int) -> str:
    return f"q{joint}_ref" if signal == "q_ref" else f"{signal}{joint}"


def _example(name: str) -> str:
    if name in {"t", "time"}:
        return "time_s"
    if name.startswith("tau"):
        return f"{name}_Nm"
    return f"{name}_deg_s or {name}_rad_s" if name.startswith("qd") else f"{name}_deg or {name}_rad"
