"""Columns by the names that recorders of robots give them: UR's RTDE, ROS in text.

- RTDE (`record.py`): `timestamp`, `actual_q_0`…, `actual_qd_0`…, `target_q_0`…, in rad and s; the
  torque is `actual_current_as_torque_0`… [Nm]. Currents need a column map.
- PlotJuggler and the like: a column of seconds and `/joint_states/elbow_joint/position`,
  `/velocity`, `/effort` (a dot does as well as the last stroke).
- `rostopic echo -p`: `%time` [ns] (a comment line is the header), `field.name0`…,
  `field.position0`…
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from irb2400_ctrl.measurement.joint_order import places
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
_NAMED = re.compile(r"(.*[/.])?(?P<joint>[^/.]+)[/.](?P<word>position|velocity|effort)")
_ECHO = re.compile(r"field\.(?P<word>position|velocity|effort)(?P<place>\d+)")
_TIMES = {
    "timestamp": 1.0,
    "__time": 1.0,
    "time": 1.0,
    "time_s": 1.0,
    "%time": 1e-9,
    "time_ns": 1e-9,
}


def recorder_columns(table: Table, joints: Sequence[str] | None) -> Named | None:
    """What the columns are; None where the names are of none of these recorders.

    Raises:
        InputError: joints that are not the robot's, or two columns for one.
    """
    time = next((name for name in _TIMES if name in table.columns), None)
    if time is None:
        return None
    for reader, unit in ((_rtde, 1.0), (_by_joint, 1.0), (_echoed, 1e-9)):
        found = reader(table, joints)
        if found.get("q"):
            return (time, unit), found
    return None


def _rtde(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    found: dict[str, dict[int, str]] = {}
    for name in table.columns:
        match = _RTDE.fullmatch(name)
        if match is not None:
            found.setdefault(_RTDE_SIGNALS[match[1]], {})[int(match[2]) + 1] = name
    return found


def _by_joint(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    seen: dict[str, dict[str, str]] = {}
    for name in table.columns:
        match = _NAMED.fullmatch(name)
        if match is not None:
            seen.setdefault(match["joint"], {})[match["word"]] = name
    return _ordered(table, list(seen), list(seen.values()), joints)


def _echoed(table: Table, joints: Sequence[str] | None) -> dict[str, dict[int, str]]:
    seen: dict[int, dict[str, str]] = {}
    for name in table.columns:
        match = _ECHO.fullmatch(name)
        if match is not None:
            seen.setdefault(int(match["place"]), {})[match["word"]] = name
    names = [table.words.get(f"field.name{place}", f"joint {place + 1}") for place in seen]
    return _ordered(table, names, list(seen.values()), joints)


def _ordered(
    table: Table, names: list[str], columns: list[dict[str, str]], joints: Sequence[str] | None
) -> dict[str, dict[int, str]]:
    """By the robot's joints."""
    if not names:
        return {}
    order = places(table.path, tuple(names), joints, ordered=True)
    return {
        signal: {j + 1: columns[k][word] for j, k in enumerate(order) if word in columns[k]}
        for word, signal in WORDS.items()
    }
