"""Columns by the names that recorders of robots give them: UR's RTDE, ROS in text.

- RTDE (`record.py`): `timestamp`, `actual_q_0`…, `actual_qd_0`…, `target_q_0`…, in rad and s; the
  torque is `actual_current_as_torque_0`… [Nm]. Currents need a column map.
- PlotJuggler and the like: a column of seconds and `/joint_states/elbow_joint/position`,
  `/velocity`, `/effort` (a dot does as well as the last stroke); flattened tables have
  `elbow_joint_position`, `elbow_joint_velocity`, `elbow_joint_effort`, or `position_elbow_joint`….
- `rostopic echo -p`: `%time` [ns] (a comment line is the header), `field.name0`…,
  `field.position0`…; tables of bags (bagpy): `Time`, `name` with the list of joints,
  `position_0`…, `velocity_0`…, `effort_0`…, or the whole list in one cell of `position`;
  `position.0`… and `position[0]`… of PlotJuggler.

- `libfranka` and `franka_ros`: `state.q[0]`…, `dq`, `q_d`, and `tau_J`, the torque on the link's
  side; `libfranka` counts the time in milliseconds, so that there its step tells the unit; its
  older logs call it `duration`.

A time whose name states no unit is in seconds, or, counted from 1970, in the unit that its size
tells (`pandas` writes nanoseconds).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.joint_order import joint_in, places
from irb2400_ctrl.measurement.columns.signal_names import TIME_WORDS, time_scale
from irb2400_ctrl.measurement.columns.two_part_time import filled_in
from irb2400_ctrl.measurement.table import Table

Named = tuple[tuple[str, float], dict[str, dict[int, str]]]
"""(column and unit of the time), signal -> joint -> column; all in SI"""

WORDS = {"position": "q", "velocity": "qd", "effort": "tau"}
_RTDE = re.compile(r"(actual_q|actual_qd|target_q|actual_current_as_torque)_(\d)")
_RTDE_SIGNALS = {
    "actual_q": "q",
    "actual_qd": "qd",
    "target_q": "q_ref",
    "actual_current_as_torque": "tau",
}
_FRANKA = re.compile(
    r"(?:(?:state|field|.*/franka_states)[./])?(q|dq|q_d|tau_J)(?:\[(\d)\]|[._]?(\d))"
)
_FRANKA_SIGNALS = {"q": "q", "dq": "qd", "q_d": "q_ref", "tau_J": "tau"}
_NAMED = re.compile(r"(?P<joint>.*[^/.])[/.](?P<word>position|velocity|effort)")
_JOINED = re.compile(r"(?P<joint>.+)_(?P<word>position|velocity|effort)")
_BEFORE = re.compile(r"(?P<word>position|velocity|effort)_(?P<joint>(?!\d+$).+)")
_ECHO = re.compile(
    r"(.*[/.])?(?P<word>position|velocity|effort)(?:[_.]?(?P<place>\d+)|\[(?P<bracket>\d+)\])"
)
_QUOTED = re.compile(r"""['"]([^'"]+)['"]""")
_NAMES = re.compile(r"(.*[/.])?name")
_TIMES = {"%time": 1e-9, "time_ns": 1e-9, "time_us": 1e-6, "time_ms": 1e-3, "time_s": 1.0}
_BARE_TIMES = ("timestamp", "__time", "time", "duration")
"""before other words for a time"""
_STAMP = "field.header.stamp"
"""when the message was sampled, beside `%time`, when it was got"""
SLOWEST = 0.1
"""between two samples [s]"""
_SINCE_1970 = ((1e18, 1e-9), (1e17, 1e-7), (1e14, 1e-6), (1e11, 1e-3))
"""(a number above it, seconds a count): seconds reach 1e11 in the year 5138, nanoseconds passed
1e18 in 2001; between are ticks of Windows, 100 ns since 1601 or since the year 1"""


def recorder_columns(table: Table, joints: Sequence[str] | None) -> Named | None:
    """What the columns are; None where the names are of none of these recorders.

    Raises:
        InputError: joints that are not the robot's, or two columns for one.
    """
    stated = {name: scale for name in table.columns if (scale := time_scale(name)) is not None}
    known = {name: scale for name, scale in _TIMES.items() if name in table.columns} or stated
    time = next(iter(known), _bare_time(table))
    if _STAMP in table.columns and filled_in(table.columns[_STAMP]):
        time = _STAMP
    if time is None:
        return None
    for reader in (_rtde, _franka, _by_joint, _echoed):
        found = reader(table, joints)
        if found.get("q"):
            unit = unit_by_step if reader is _franka else unit_by_size
            return (time, known.get(time) or unit(table.columns[time])), found
    return None


def names_joints(table: Table) -> bool:
    """Whether words in a column tell which joint a place is: places do not count them then."""
    return any(_NAMES.fullmatch(name.rstrip("[]0123456789")) for name in table.words)


def has_time(table: Table) -> bool:
    """Whether a column is called as a time is."""
    return _bare_time(table) is not None or any(name in table.columns for name in _TIMES)


def _bare_time(table: Table) -> str | None:
    """The column that is called as a time is, without a unit."""
    words = {"_".join(name.lower().split()): name for name in reversed(table.columns)}
    return next((words[word] for word in (*_BARE_TIMES, *TIME_WORDS) if word in words), None)


def _twice(table: Table, one: str, other: str, what: str) -> InputError:
    return InputError(
        f"{table.path}: columns {one!r} and {other!r} are both {what}, expected one: leave the "
        "other out, or name the right one in a column map (--columns, docs/logs.md)"
    )


def unit_by_size(stamps: Array) -> float:
    """Seconds a count of a time whose name does not say it."""
    first = float(stamps[0]) if len(stamps) else 0.0
    return next((unit for above, unit in _SINCE_1970 if first > above), 1.0)


def unit_by_step(stamps: Array) -> float:
    """Seconds a count of a time that may count milliseconds and less: as from 10 Hz on."""
    known = unit_by_size(stamps)
    step = float(np.median(np.diff(stamps))) if len(stamps) > 1 else 0.0
    units = (known,) if known < 1.0 else (1.0, 1e-3, 1e-6, 1e-9)
    return next((unit for unit in units if step * unit <= SLOWEST), 1.0)


def _counted(
    table: Table, form: re.Pattern[str], signals: Mapping[str, str]
) -> dict[str, dict[int, str]]:
    """Names of a form: a word of `signals`, and the joint's place from 0."""
    found: dict[str, dict[int, str]] = {}
    for match in filter(None, map(form.fullmatch, table.columns)):
        word, *places = match.groups()
        found.setdefault(signals[word], {})[int(next(filter(None, places))) + 1] = match[0]
    return found


def _rtde(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    return _counted(table, _RTDE, _RTDE_SIGNALS)


def _franka(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    found = _counted(table, _FRANKA, _FRANKA_SIGNALS)
    # any recorder may write q0; `tau_J` is Franka's
    return found if 1 in found.get("tau", {}) else {}


def _by_joint(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    seen: dict[str, dict[str, str]] = {}
    form = _NAMED
    if not any(map(_NAMED.fullmatch, table.columns)):
        # only ROS calls a torque effort: other recorders' positions may be in degrees
        matches = ((f, f.fullmatch(name)) for f in (_JOINED, _BEFORE) for name in table.columns)
        form = next((f for f, match in matches if match and match["word"] == "effort"), _NAMED)
    for name in table.columns:
        match = form.fullmatch(name)
        if match is not None:
            joint = match["joint"] if form is not _NAMED else joint_in(match["joint"], joints or ())
            other = seen.setdefault(joint, {}).setdefault(match["word"], name)
            if other != name:
                raise _twice(table, other, name, f"the {match['word']} of {joint}")
    return _ordered(table, list(seen), list(seen.values()), joints)


def _echoed(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    seen: dict[int, dict[str, str]] = {}
    matches = {name: match for name in table.columns if (match := _ECHO.fullmatch(name))}
    # lists in a cell are counted from 1 here; others count their brackets from 0
    brackets = {int(match["bracket"]) for match in matches.values() if match["bracket"]}
    lowest = 0 if 0 in brackets else 1
    for name, match in matches.items():
        place = int(match["place"] or int(match["bracket"]) - lowest)
        other = seen.setdefault(place, {}).setdefault(match["word"], name)
        if other != name:
            raise _twice(table, other, name, f"the {match['word']} of joint {place + 1}")
    words = [words for name, words in table.words.items() if _NAMES.fullmatch(name)]
    listed = _QUOTED.findall(words[0]) if words else []
    # some count from 1
    first = min(seen, default=0)
    numbered = {place: f"joint {place - first + 1}" for place in seen}
    names = [
        table.words.get(
            f"field.name{place}", listed[place] if len(listed) > place else numbered[place]
        )
        for place in seen
    ]
    return _ordered(table, names, list(seen.values()), joints)


def _ordered(
    table: Table, names: list[str], columns: list[dict[str, str]], joints: Sequence[str] | None
) -> dict[str, dict[int, str]]:
    """By the robot's joints."""
    if not names:
        return {}
    example = columns[0].get("position", "")
    order = places(table.path, tuple(names), joints, ordered=True, example=example)
    return {
        signal: {j + 1: columns[k][word] for j, k in enumerate(order) if word in columns[k]}
        for word, signal in WORDS.items()
    }
