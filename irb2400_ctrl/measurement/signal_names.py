"""Columns of signal recorders (RobotStudio, scopes, spreadsheets): `J1 [deg]`, `Axis 2 torque
(Nm)`.

A name tells the joint by `J1`, `Joint 1` or `Axis 1` and the quantity by its unit in brackets.
Commanded angles hold a word for it (`ref`, `command`, `setpoint`, `programmed`). Commanded speeds
and torques, and what is on the motor's side, are no measured joint signals: they need a column map.
"""

from __future__ import annotations

import re

import numpy as np

UNITS = {
    "deg": ("q", np.pi / 180),
    "rad": ("q", 1.0),
    "deg/s": ("qd", np.pi / 180),
    "rad/s": ("qd", 1.0),
    "nm": ("tau", 1.0),
    "knm": ("tau", 1e3),
}
"""unit -> (signal, SI per number)"""
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3}
_SPELLED = {"°": "deg", "degrees": "deg", "degree": "deg", "radians": "rad"}
_NAME = re.compile(r"(?P<words>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*")
_JOINT = re.compile(r"(?<![a-z])(?:j|joint|axis)[ _]?([1-9]\d?)(?!\d)")
_COMMANDED = re.compile(r"ref|command|setpoint|programmed|desired|target")


def time_scale(name: str) -> float | None:
    """Seconds per number of a column called `Time [s]`, `t (ms)`, …; None for any other."""
    match = _NAME.fullmatch(name.strip().lower())
    if match is None or match["words"] not in {"time", "t", "timestamp"}:
        return None
    return TIMES.get(match["unit"].strip())


def joint_signal(name: str) -> tuple[str, int, float] | None:
    """(signal, joint, SI per number) of a column; None where the name does not say all three."""
    match = _NAME.fullmatch(name.strip().lower())
    if match is None:
        return None
    joint = _JOINT.search(match["words"])
    signal, scale = UNITS.get(_unit(match["unit"]), ("", 0.0))
    if joint is None or not signal or "motor" in match["words"]:
        return None
    if _COMMANDED.search(match["words"]):
        return ("q_ref", int(joint[1]), scale) if signal == "q" else None
    return signal, int(joint[1]), scale


def without_unit(name: str) -> bool:
    """Whether a name tells a joint and nothing of its unit."""
    lower = name.strip().lower()
    return _NAME.fullmatch(lower) is None and _JOINT.search(lower) is not None


def is_unit(cell: str) -> bool:
    """Whether a cell is one of the units known here, in brackets or not."""
    bare = cell.strip("[]() ").lower()
    return bare in TIMES or _unit(bare) in UNITS


def _unit(text: str) -> str:
    found = re.sub(r"[\s·*]", "", text)
    for spelled, short in _SPELLED.items():
        found = found.replace(spelled, short)
    return re.sub(r"(?<=deg|rad)/sec$|(?<=deg|rad)_s$", "/s", found)
