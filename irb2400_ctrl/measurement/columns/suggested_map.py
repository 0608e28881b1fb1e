"""The column map that a file probably needs, written from the names of its columns.

Names that count the joints (`measured_torque_1`…) or hold the names of the robot's
(`actual_pos_elbow_joint`) tell what a column is, seldom its unit. What is found is shown to be
checked, never used by itself.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.columns.axis_letters import lettered
from irb2400_ctrl.measurement.columns.column_map import TURN
from irb2400_ctrl.measurement.columns.column_words import (
    AMPERE,
    DEGREE_OR_RAD,
    MOTOR,
    NEWTON_METRES,
    PULSES,
    SURELY,
    TIME,
    TURNS,
    TURNS_A_MINUTE,
    is_commanded,
    meaning,
)
from irb2400_ctrl.measurement.columns.interleaved import interleaved, place_of
from irb2400_ctrl.measurement.columns.joint_words import FEWEST, worded
from irb2400_ctrl.measurement.columns.recorder_names import unit_by_step
from irb2400_ctrl.measurement.columns.signal_names import stated_tick
from irb2400_ctrl.measurement.columns.two_part_time import COUNTED, time_pair

NAMED = "{name}"
"""in the place of a joint's name"""
MOST_JOINTS = 16
DEGREES = 7.0
"""an angle beyond this is hardly in radians"""
GOES_ON = 0.9
"""of the rows of a time; a counter may wrap, a clock stand for a row"""
COUNTS = 720.0
"""whole numbers beyond this are hardly degrees"""
NEEDED = "and a log needs them (of signals in files of their own, put the columns into one)"
ALONE = (
    "not measured: record the measured ones, or say in a column map that they are to be taken "
    '(quantity = "q"; --columns, docs/logs.md)'
)
UNITS = {
    "q": ("rad", "deg"),
    "qd": ("rad_s", "deg_s"),
    "tau": ("Nm", "Nm"),
    "q_ref": ("rad", "deg"),
}


def suggested_map(columns: Mapping[str, Array], joints: Sequence[str] | None = None) -> str:
    """The end of a message: a column map to be checked, or that there is no torque; empty where the
    names do not tell.
    """
    patterns, rivals, chosen = _choices(columns, joints or ())
    if "tau" not in chosen and {"q", "q_ref"} & chosen.keys():
        return f"; no columns are called as measured torques or currents are, {NEEDED}"
    if "tau" in chosen and not {"q", "q_ref"} & chosen.keys():
        return f"; no columns are called as angles of joints are, {NEEDED}"
    if "tau" in chosen and "q_ref" in chosen and "q" not in chosen:
        commanded = chosen["q_ref"][-1]
        return f"; the angles that there are ({commanded}) are called commanded ones, {ALONE}"
    if not {"q", "tau"} <= chosen.keys():
        return ""
    names = {quantity: patterns[pattern] for quantity, (*_, pattern) in chosen.items()}
    angles = np.column_stack([columns[name] for name in names["q"]])
    size = _size(angles)
    taken = {name for several in names.values() for name in several}
    lines = _time({n: v for n, v in columns.items() if n not in taken}, len(angles))
    for quantity in ("q", "qd", "tau", "q_ref"):
        # the speeds of counted angles are in any unit
        if quantity in names and (quantity != "qd" or size != "counts"):
            pattern = chosen[quantity][-1]
            own = set(names[quantity])
            others = [other for other in rivals[quantity] if not own >= set(patterns[other])]
            entry = _entry(quantity, pattern, names[quantity], size)
            lines += _wrapped(entry, angles) if quantity == "q" else entry
            if joints and len(names[quantity]) > len(joints):
                lines[-1:] = [
                    f"joints = {len(joints)}   # of {len(names[quantity])} such columns: the first "
                    "ones, where no gripper stands among them",
                    "",
                ]
            if others:
                lines[-1:] = [f"# or, of the same kind by its name: {', '.join(others)}", ""]
    return (
        ". A column map for it (--columns map.toml); quantities and units are guessed, check "
        "them:\n\n" + "\n".join(lines)
    )


def _choices(
    columns: Mapping[str, Array], joints: Sequence[str]
) -> tuple[dict[str, list[str]], dict[str, list[str]], dict[str, tuple[int, bool, int, str]]]:
    """The forms of names and their columns, the forms of each quantity, and the best of these with
    its rank.
    """
    lists = interleaved(columns, _row(columns))
    places = {name for one in lists.values() for names in one for name in names}
    patterns = _patterns({n: v for n, v in columns.items() if n not in places}, joints)
    chosen: dict[str, tuple[int, bool, int, str]] = {}
    rivals: dict[str, list[str]] = {}
    for pattern in patterns:
        quantity, told = meaning(pattern)
        rivals.setdefault(quantity, []).append(pattern)
        # torques before currents, the joint's side before the motor's
        doubt = re.search(rf"{AMPERE.pattern}|{MOTOR.pattern}", pattern.lower()) is not None
        if quantity and (told, doubt, len(pattern)) < chosen.get(quantity, (3, False, 0, ""))[:3]:
            chosen[quantity] = (told, doubt, len(pattern), pattern)
    for name, signals in lists.items():
        words = name.lower()
        commanded = is_commanded(words)
        # what a command holds beside angles is seldom more than zeros
        for k, quantity in enumerate(
            ("q_ref",) if commanded else ("q", "qd", "tau")[: len(signals)]
        ):
            form = place_of(name, len(signals), k)
            patterns[form] = signals[k]
            rivals.setdefault(quantity, []).append(form)
            chosen.setdefault(quantity, (0, False, 0, form))
    return patterns, rivals, chosen


def _patterns(columns: Mapping[str, Array], joints: Sequence[str]) -> dict[str, list[str]]:
    """Names with a place for the joint, and the columns in the order of the joints."""
    found = {NAMED.join(form): names for form, names in lettered(columns).items()}
    words = worded(columns, len(joints) or None)
    for pattern, names in _numbered(columns).items():
        # three of six joints may be counted
        few = len(names) < FEWEST
        if not (few and any(set(names) < set(several) for several in words.values())):
            found[pattern] = names
    # where the robot is known, fewer are some joints of several
    found = {pattern: names for pattern, names in found.items() if len(names) >= len(joints)}
    found |= _named(columns, joints)
    if any(meaning(pattern)[0] for pattern in found):
        return found
    return {NAMED.join(form): names for form, names in words.items()}


def _numbered(columns: Mapping[str, Array]) -> dict[str, list[str]]:
    """Names with `{j}` or `{j0}` in the place of a number that counts them, in their order; and the
    columns."""
    found: dict[str, dict[int, str]] = {}
    for name in columns:
        for run in re.finditer(r"\d+", name):
            zeros = run[0][: -len(str(int(run[0])))]
            # the same number again further on counts the joints as well
            again = re.sub(rf"(?<!\d){run[0]}(?!\d)", zeros + "{j}", name[run.start() :])
            found.setdefault(name[: run.start()] + again, {})[int(run[0])] = name
    patterns = {}
    for pattern, names in found.items():
        n = len(names)
        if 2 <= n <= MOST_JOINTS and names.keys() == set(range(1, n + 1)):
            patterns[pattern] = [names[j + 1] for j in range(n)]
        elif 2 <= n <= MOST_JOINTS and names.keys() == set(range(n)):
            patterns[pattern.replace("{j}", "{j0}")] = [names[j] for j in range(n)]
    return {
        pattern: names
        for pattern, names in patterns.items()
        if not _of_some(pattern, names, columns)
    }


def _of_some(pattern: str, names: Sequence[str], columns: Mapping[str, Array]) -> bool:
    """Whether as many other columns end as these do: `wrist_{j}_joint/position` counts three of
    six joints, which have names.
    """
    tail = re.split(r"\{j0?\}", pattern)[-1]
    alike = [name for name in columns if name.endswith(tail) and not re.search(r"\d", name)]
    return bool(meaning(tail)[0]) and len(alike) >= len(names)


def _named(columns: Mapping[str, Array], joints: Sequence[str]) -> dict[str, list[str]]:
    """Names with `{name}` in the place of each joint's name, and the columns in their order."""
    found: dict[str, dict[str, str]] = {}
    for name in columns:
        inside = max((joint for joint in joints if joint in name), key=len, default="")
        if inside:
            found.setdefault(name.replace(inside, NAMED), {})[inside] = name
    return {
        pattern: [names[joint] for joint in joints]
        for pattern, names in found.items()
        if len(names) == len(joints)
    }


def _size(angles: Array) -> str:
    """What angles whose names state no unit look like: "rad", "deg" or "counts"."""
    there = angles[np.isfinite(angles)]
    if (np.abs(there) > COUNTS).any() and (there == np.round(there)).all():
        return "counts"
    return "deg" if (np.abs(there) > DEGREES).any() else "rad"


def _wrapped(entry: list[str], angles: Array) -> list[str]:
    """The tables of angles; said in them where some go on a whole turn off from one row to the next
    and never by a good part of one."""
    steps = np.abs(np.diff(angles, axis=0))
    for unit, turn in (("deg", 360.0), ("rad", TURN)):
        jumps = np.abs(steps - turn) < 0.1 * turn
        if f'unit = "{unit}"' in entry and jumps.any() and (steps[~jumps] < 0.1 * turn).all():
            said = f'unit = "{unit}"\nwrapped = true   # some jump by a whole turn'
            return [said if line == f'unit = "{unit}"' else line for line in entry]
    return entry


def _time(columns: Mapping[str, Array], rows: int) -> list[str]:
    """The table of the time, where a column is called so."""
    pair = time_pair(columns)
    if pair is not None:
        return [
            "[time]",
            f'column = "{pair.seconds}"',
            f'{COUNTED[pair.counts]} = "{pair.beyond}"',
            "",
        ]
    for name, values in columns.items():
        if len(values) == rows and _is_clock(name, values):
            scale = _tick(name, values)
            unit = {1e-3: "ms", 1e-6: "us", 1e-7: "ticks", 1e-9: "ns"}.get(scale, "s")
            rows_alone = len(values) > 1 and bool((np.diff(values) == 1.0).all())
            doubt = (
                "   # or it counts rows: then rate_Hz in the place of column and unit" * rows_alone
            )
            return ["[time]", f'column = "{name}"', f'unit = "{unit}"{doubt}', ""]
    return ["[time]", "rate_Hz = nan   # samples a second: no column is called as a time is", ""]


def _row(columns: Mapping[str, Array]) -> float:
    """Time from one row to the next [s]; 0 where no column is called as a time is."""
    for name, values in columns.items():
        if len(values) > 1 and _is_clock(name, values):
            return (_tick(name, values) or 1.0) * float(np.median(np.diff(values)))
    return 0.0


def _tick(name: str, values: Array) -> float:
    """[s] that one of a clock is: as its name says (`time_us`), else as its steps look."""
    return stated_tick(name) or unit_by_step(values)


def _is_clock(name: str, values: Array) -> bool:
    """Whether a column is called as a time is, and goes on: the T of `O_T_EE[1]` is a pose."""
    steps = np.diff(values)
    goes_on = len(steps) == 0 or bool((steps > 0.0).any() and (steps >= 0.0).mean() > GOES_ON)
    return goes_on and TIME.fullmatch(name.lower()) is not None


def _entry(quantity: str, pattern: str, names: Sequence[str], size: str) -> list[str]:
    """One table of the map; one for each joint where a name stands in the place of a number."""
    told = [f'quantity = "{quantity}"', *_unit(quantity, pattern.lower(), size), ""]
    if NAMED not in pattern:
        return ["[[columns]]", f'file = "{pattern}"', *told]
    tables = [
        ["[[columns]]", f'file = "{name}"', f"joint = {joint}", *told]
        for joint, name in enumerate(names, 1)
    ]
    return [line for table in tables for line in table]


def _unit(quantity: str, words: str, size: str) -> list[str]:
    """What stands in a table about the unit."""
    gear = "gear_ratio = nan   # motor turns per joint turn, signed"
    motor = [f"{gear}; 1 if it is the joint's"]
    if quantity == "tau":
        return _unit_of_torque(words, gear, motor if MOTOR.search(words) else [])
    if re.search(TURNS_A_MINUTE if quantity == "qd" else TURNS, words):
        return [f'unit = "{"rpm" if quantity == "qd" else "rev"}"', *motor]
    stated = re.search(DEGREE_OR_RAD, words)
    if re.search(PULSES, words) or (stated is None and size == "counts"):
        zero = "zero = nan   # pulses where the joint is at zero: half a turn of most servos"
        return ['unit = "rev"', "factor = nan   # turns of the joint a pulse, signed", zero]
    in_degrees = size == "deg" if stated is None else stated[0] != "rad"
    return [f'unit = "{UNITS[quantity][in_degrees]}"', *motor * bool(MOTOR.search(words))]


def _unit_of_torque(words: str, gear: str, motor: list[str]) -> list[str]:
    """The same of a torque, or of a current.

    Args:
        words: of its name; gear: the line of a ratio that is needed; motor: that of one that may
            be, or nothing.
    """
    if "%" in words:
        return ['unit = "percent"', "full_scale_Nm = nan   # what 100 % are"]
    if AMPERE.search(words):
        milli = re.search(r"(?<![a-z])ma(?![a-z])", words) is not None
        constant = "Nm_per_A = nan   # of the motors: a number, or a list"
        return ['unit = "A"', *["factor = 0.001   # of mA"] * milli, constant, gear]
    if not SURELY.search(words):
        doubt = "   # or a current (A, with Nm_per_A), or percent: its name does not say"
        return [f'unit = "Nm"{doubt}', *motor]
    stated = re.search(NEWTON_METRES, words)
    said = "" if stated is None else stated[0]
    unit = {"k": "kNm", "m": "mNm"}.get(said[:1], "Nm")
    factor = ["factor = 0.01   # of Ncm"] * (said == "ncm")
    doubt = "   # commanded, or of the controller's model: not measured" * is_commanded(words)
    return [f'unit = "{unit}"{doubt}', *factor, *motor]
