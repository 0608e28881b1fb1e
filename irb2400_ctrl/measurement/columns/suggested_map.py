"""The column map that a file probably needs, written from the names of its columns.

Names that count the joints (`measured_torque_1`…) tell what a column is, seldom its unit. What is
found is shown to be checked, never used by itself.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import count

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.columns.recorder_names import unit_by_step
from irb2400_ctrl.measurement.columns.two_part_time import time_pair

OTHERS = re.compile(
    r"acc|qdd|ddq|err|ext|grav|limit|temp|volt|tcp|cart|force|wrench|jerk|collision|inertia"
)
COMMANDED = re.compile(r"ref|cmd|comm|target|des|goal|set|soll|nominal|[a-z]_d(?![a-z])")
MEASURED = re.compile(r"act(?!uator)|meas|msr|mes|real|ist|fb|feed|state")
QUANTITIES = {
    "tau": r"tau|torq|trq|(?<!co)eff|mom|curr?|load|qfrc|m(?=act)|^t\W*$",
    "qd": r"vel|speed|dq|qd|qp(?!os)|omega|geschw",
    "q": r"pos|ang|q|theta|joint|jnt|axis|achse|winkel|^[aj]\W*$",
}
"""what a name means, asked in this order"""
TIME = re.compile(r"(.*[^a-z])?(time|t|tm|tout|time_?stamps?|stamp|zeit|tick|ipoc|sec)([^a-z].*)?")
MOST_JOINTS = 16
DEGREES = 7.0
"""an angle beyond this is hardly in radians"""
UNITS = {
    "q": ("rad", "deg"),
    "qd": ("rad_s", "deg_s"),
    "tau": ("Nm", "Nm"),
    "q_ref": ("rad", "deg"),
}


def suggested_map(columns: Mapping[str, Array]) -> str:
    """The end of a message: a column map to be checked; empty where the names do not tell one.

    Args:
        columns: of the file, by name.
    """
    chosen: dict[str, tuple[int, int, str]] = {}
    for pattern in _numbered(columns):
        quantity, told = _quantity(pattern)
        if quantity and (told, len(pattern)) < chosen.get(quantity, (3, 0, ""))[:2]:
            chosen[quantity] = (told, len(pattern), pattern)
    patterns = {quantity: pattern for quantity, (*_, pattern) in chosen.items()}
    if not {"q", "tau"} <= patterns.keys():
        return ""
    size = max(float(np.nanmax(np.abs(v))) for v in _of(columns, patterns["q"]))
    rows = len(_of(columns, patterns["q"])[0])
    lines = _time(columns, rows)
    for quantity in ("q", "qd", "tau", "q_ref"):
        if quantity in patterns:
            lines += _entry(quantity, patterns[quantity], size > DEGREES)
    return (
        ". A column map for it (--columns map.toml); quantities and units are guessed, check "
        "them:\n\n" + "\n".join(lines)
    )


def _numbered(columns: Mapping[str, Array]) -> list[str]:
    """Names with `{j}` or `{j0}` in the place of a number that counts them, in their order."""
    found: dict[str, set[int]] = {}
    for name in columns:
        for run in re.finditer(r"\d+", name):
            # the same number again further on counts the joints as well
            again = re.sub(rf"(?<!\d){run[0]}(?!\d)", "{j}", name[run.start() :])
            found.setdefault(name[: run.start()] + again, set()).add(int(run[0]))
    patterns = []
    for pattern, numbers in found.items():
        n = len(numbers)
        if 2 <= n <= MOST_JOINTS and numbers == set(range(1, n + 1)):
            patterns.append(pattern)
        elif 2 <= n <= MOST_JOINTS and numbers == set(range(n)):
            patterns.append(pattern.replace("{j}", "{j0}"))
    return patterns


def _of(columns: Mapping[str, Array], pattern: str) -> list[Array]:
    """The columns of a pattern."""
    names = (pattern.replace("{j}", str(k + 1)).replace("{j0}", str(k)) for k in count())
    found: list[Array] = []
    for name in names:
        if name not in columns:
            return found
        found.append(columns[name])
    return found


def _quantity(pattern: str) -> tuple[str, int]:
    """What a name means, and how surely: 0 where it says measured, 2 of a commanded torque; ""
    where it is of another thing, or does not tell."""
    words = re.sub(r"\{j0?\}|\d", "", pattern).lower()
    meant = next((q for q, known in QUANTITIES.items() if re.search(known, words)), "")
    if not meant or OTHERS.search(words):
        return "", 3
    if MEASURED.search(words):
        return meant, 0
    if COMMANDED.search(words):
        # some controllers record no other torque
        return {"q": ("q_ref", 1), "tau": ("tau", 2)}.get(meant, ("", 3))
    return meant, 1


def _time(columns: Mapping[str, Array], rows: int) -> list[str]:
    """The table of the time, where a column is called so."""
    pair = time_pair(columns)
    if pair is not None:
        return ["[time]", f'column = "{pair[0]}"', f'nanoseconds = "{pair[1]}"', ""]
    for name, values in columns.items():
        if len(values) == rows and TIME.fullmatch(name.lower()):
            scale = unit_by_step(values)
            unit = {1e-3: "ms", 1e-6: "us", 1e-9: "ns"}.get(scale, "s")
            return ["[time]", f'column = "{name}"', f'unit = "{unit}"', ""]
    return ["[time]", 'column = "…"   # no column is called as a time is', 'unit = "s"', ""]


def _entry(quantity: str, pattern: str, degrees: bool) -> list[str]:
    """One table of the map."""
    words = pattern.lower()
    lines = ["[[columns]]", f'file = "{pattern}"', f'quantity = "{quantity}"']
    if quantity == "tau" and re.search(r"cur|amp", words):
        lines += ['unit = "A"', "Nm_per_A = nan   # of the motors: a number, or a list"]
        return [*lines, "gear_ratio = nan   # motor turns per joint turn, signed", ""]
    if quantity == "tau" and "%" in words:
        return [*lines, 'unit = "percent"', "full_scale_Nm = nan   # what 100 % are", ""]
    stated = re.search(r"deg|°|rad(?!ius)", words)
    in_degrees = degrees if stated is None else stated[0] != "rad"
    return [*lines, f'unit = "{UNITS[quantity][in_degrees]}"', ""]
