"""Columns of signal recorders (RobotStudio, scopes, spreadsheets): `J1 [deg]`, `Axis 2 torque
(Nm)`.

A name tells the joint by `J1`, `A1`, `Joint 1` or `Axis 1` (in German and Chinese too), or by the
quantity that counts it (`q1`, `dq1`, `tau1`, `Torque 1`), and the quantity by its unit, in brackets
or as the last word (`joint1_pos_rad`, `j1_torque_Nm`). What stands before every name
(`System1:T_ROB1:`, `GP1`) is the controller's or the unit's, and is passed over. Commanded angles
hold a word for it (`ref`, `command`, `setpoint`, `programmed`). Only names whose every word is
known are taken: a gravity torque, a position error or a torque limit has the unit of the measured
signal and is another thing. Commanded speeds and torques, and what is on the motor's side, are no
measured joint signals: they need a column map.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from irb2400_ctrl.measurement.columns.axis_letters import numbered

UNITS = {
    "deg": ("q", np.pi / 180),
    "rad": ("q", 1.0),
    "deg/s": ("qd", np.pi / 180),
    "rad/s": ("qd", 1.0),
    "nm": ("tau", 1.0),
    "knm": ("tau", 1e3),
}
"""unit -> (signal, SI per number)"""
TIMES = {
    **{"s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "sek": 1.0},
    **{"ms": 1e-3, "msec": 1e-3, "millisec": 1e-3, "milliseconds": 1e-3},
    **{"us": 1e-6, "µs": 1e-6, "μs": 1e-6, "usec": 1e-6, "microseconds": 1e-6},
    **{"ns": 1e-9, "nsec": 1e-9, "nanosec": 1e-9, "nanoseconds": 1e-9},
}
TIME_WORDS = (
    *("time", "t", "timestamp", "time_stamp", "elapsed", "elapsed_time"),
    *("zeit", "zeitstempel", "temps", "tiempo", "时间", "時間"),
)
_SPELLED = {
    "°": "deg",
    "degrees": "deg",
    "degree": "deg",
    "radians": "rad",
    "grad": "deg",
    "度": "deg",
    "弧度": "rad",
}
_NAME = re.compile(r"(?P<words>.*?)\s*[\[(<\uff08](?P<unit>[^\])>\uff09]*)[\])>\uff09]\s*")
_ENDS = re.compile(
    r"(?P<words>.*?)(?:[ _]|\s*[/,]\s*)(?:in )?"
    r"(?P<unit>(?:deg|rad|°)(?:ps|[_/]s|_per_s)?|k?nm|seconds|[mun]?s(?:ec)?)",
    re.IGNORECASE,
)
_NUMBER = r")[ _]?([1-9]\d?)(?!\d)"
_JOINT = re.compile(
    r"(?<![a-z])(?:j|jt|jnt|a|joint|actuator|axis|achse|gelenk|关节|軸|轴" + _NUMBER,
)
LETTERS = {
    **{"q": "q", "theta": "q", "θ": "q", "qd": "qd", "dq": "qd", "omega": "qd", "ω": "qd"},
    **{"tau": "tau", "τ": "tau"},
}
"""what counts the joints -> its signal"""
_COUNTED = re.compile(
    rf"(?<![a-z])(?:{'|'.join(LETTERS)}|pos|position|angle|vel|velocity|speed|torque|trq|cmd|command"
    + _NUMBER
)
_HUMP = re.compile(r"(?<=[a-zäöüß])(?=[A-Z])")
COMMANDED = {
    *("ref", "reference", "cmd", "command", "commanded", "setpoint", "des"),
    *("programmed", "desired", "target", "soll", "sollposition", "sollwinkel"),
}
MEASURED = {
    *("angle", "position", "pos", "torque", "moment", "effort", "speed", "velocity", "vel"),
    *("actual", "act", "real", "measured", "meas", "msr", "feedback", "fb", "encoder", "enc"),
    *("value", "signal", "joint", "jnt", "trq", "axis", "robot", "rob", "rob1", "1"),
    *("winkel", "gelenkwinkel", "achswinkel", "lage", "drehmoment", "geschwindigkeit"),
    *("achse", "gelenk", "ist", "istwert", "gemessen", "istposition", "istwinkel", "istmoment"),
    *("istdrehmoment", "istgeschwindigkeit"),
    *("角度", "位置", "实际", "实际角度", "实际位置", "实际力矩", "力矩", "扭矩", "速度"),
    *("トルク", "関節角度", "関節トルク", "実測"),
}
"""words of a measured signal; with any other word a name may mean something else"""


def time_scale(name: str) -> float | None:
    """Seconds per number of a column called `Time [s]`, `t (ms)`, `time_sec`…; else None."""
    return stated_tick(name) if _parts(name)[0] in TIME_WORDS else None


def stated_tick(name: str) -> float | None:
    """Seconds per number of a column whose name ends in a unit of time (`host_time_us`)."""
    return TIMES.get(_parts(name)[1])


def without_source(names: Iterable[str]) -> dict[str, str]:
    """Every name, and the same without what stands before all that tell a joint: a controller, a
    unit; joints that are called by letters are numbered.

    Only what holds a digit, stands before the joint and ends in a blank or a stroke is left out: a
    word such as `Soll` before all names says what the columns are.
    """
    told = numbered(names)
    given = list(told.values())
    signals = [name for name in given if _JOINT.search(name.lower()) is not None]
    # what the first and the last in order share, all between them share
    first, last = (min(signals), max(signals)) if len(signals) > 1 else ("", "")
    same = [a == b for a, b in zip(first, last, strict=False)]
    joints = [match.start() for name in signals if (match := _JOINT.search(name.lower()))]
    prefix = first[: min([same.index(False) if False in same else 0, *joints])]
    prefix = prefix[: max(prefix.rfind(mark) for mark in " :./|") + 1]
    if not re.search(r"\d", prefix):
        return told
    return {name: short.removeprefix(prefix) for name, short in told.items()}


def joint_signal(name: str) -> tuple[str, int, float] | None:
    """(signal, joint, SI per number) of a column; None where the name does not say all three."""
    words, unit = _parts(name)
    joint = _joint(words)
    signal, scale = UNITS.get(_unit(unit), ("", 0.0))
    if joint is None or not signal or strange_word(name) is not None:
        return None
    told = set(re.split(r"[\W\d_]+", words))
    if any(LETTERS[letter] != signal for letter in told & LETTERS.keys()):
        return None
    if told & COMMANDED:
        return ("q_ref", int(joint[1]), scale) if signal == "q" else None
    return signal, int(joint[1]), scale


def strange_word(name: str) -> tuple[str, str] | None:
    """(signal its unit is of, word) where a word keeps a column from being a measured signal."""
    words, unit = _parts(name)
    if _joint(words) is None:
        return None
    signal, _ = UNITS.get(_unit(unit), ("", 0.0))
    others = _JOINT.sub(" ", words, count=1)
    if others == words:
        # the word that is counted stays one of the words
        others = _COUNTED.sub(lambda found: re.sub(r"\d", " ", found[0]), words, count=1)
    told = [word for word in re.split(r"[\W_]+", others) if word]
    strange = [word for word in told if word not in MEASURED | COMMANDED | LETTERS.keys()]
    commanded = [word for word in told if word in COMMANDED and signal in {"qd", "tau"}]
    return next(((signal, word) for word in strange + commanded if signal), None)


def without_unit(name: str) -> bool:
    """Whether a name tells a joint and nothing of its unit."""
    words, unit = _parts(name)
    return not unit and _JOINT.search(words) is not None


def is_unit(cell: str) -> bool:
    """Whether a cell is one of the units known here, in brackets or not."""
    bare = cell.strip("[]() ").lower()
    return bare in TIMES or _unit(bare) in UNITS


def _parts(name: str) -> tuple[str, str]:
    """The words of a name and its unit, both in small letters; no unit where none stands there.

    Where a word grows a capital (`ActPos`) another one begins.
    """
    match = _NAME.fullmatch(name.strip()) or _ENDS.fullmatch(name.strip())
    words, unit = (name.strip(), "") if match is None else (match["words"], match["unit"])
    return _HUMP.sub(" ", words).lower(), unit.strip().lower()


def _joint(words: str) -> re.Match[str] | None:
    """Where the words tell a joint."""
    return _JOINT.search(words) or _COUNTED.search(words)


def _unit(text: str) -> str:
    found = re.sub(r"[\s·⋅*.-]", "", text)
    for spelled, short in _SPELLED.items():
        found = found.replace(spelled, short)
    return re.sub(r"(?<=deg|rad)(?:/sec|_s|ps|_per_s)$", "/s", found)
