"""Units of length, feeds and spindle speeds of APT-like files."""

from __future__ import annotations

import math

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Spindle
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, is_number, number
from irb2400_ctrl.planners.toolpath.readers.feed import FOOT, INCH, MM, Feed

UNIT_WORDS = {
    "MM": "mm",
    "MMS": "mm",
    "MILLIMETERS": "mm",
    "MILLIMETER": "mm",
    "MILLIMETRES": "mm",
    "METRIC": "mm",
    "CM": "cm",
    "CENTIMETERS": "cm",
    "M": "m",
    "METERS": "m",
    "METRES": "m",
    "IN": "inch",
    "INCH": "inch",
    "INCHES": "inch",
    "FT": "foot",
    "FEET": "foot",
    "FOOT": "foot",
}
PER_MINUTE = {"MMPM": MM, "MPM": 1.0, "IPM": INCH, "FPM": FOOT, "CMPM": 1e-2}
PER_SECOND = {"MMPS": MM, "IPS": INCH, "MPS": 1.0, "CMPS": 1e-2}
PER_TURN = {"MMPR": MM, "IPR": INCH}
FEED_WORDS = frozenset(
    [*PER_MINUTE, *PER_SECOND, *PER_TURN, "PERMIN", "PERREV", "REV", "INVERS", "LOCK"]
)
IMPERIAL = frozenset({"IPM", "IPR", "IPS", "FPM"})
METRIC = frozenset({"MMPM", "MPM", "MMPR", "MMPS", "CMPM", "MPS", "CMPS"})


def stated_units(program: list[Statement], name: str) -> list[tuple[int, str]]:
    """(line, unit) of all `UNITS/` statements."""
    found = []
    for statement in program:
        if statement.word in {"UNITS", "UNIT"}:
            word = (statement.words or [""])[0]
            if word not in UNIT_WORDS:
                raise InputError(
                    f"{name}, line {statement.line}: {statement.word}/{word}, expected MM, CM, M "
                    "or INCHES"
                )
            found.append((statement.line, UNIT_WORDS[word]))
    return found


def units_of_feeds(program: list[Statement]) -> str | None:
    """The unit that the words of all feeds agree on: "mm", "inch", or None."""
    words = {w for s in program if s.word in {"FEDRAT", "CYCLE"} for w in s.words}
    if words & IMPERIAL and not words & METRIC:
        return "inch"
    if words & METRIC and not words & IMPERIAL:
        return "mm"
    return None


def feed(arguments: tuple[str, ...], unit: float) -> Feed:
    """The feed of `FEDRAT/`; without a word of its own it is per minute in the file's unit [m].

    Raises:
        InputError: not exactly one positive number.
    """
    numbers = [argument for argument in arguments if is_number(argument)]
    words = {argument.upper() for argument in arguments if not is_number(argument)}
    wrong = sorted(word for word in words if word not in FEED_WORDS)
    if len(numbers) != 1 or wrong:
        found = f"{len(numbers)} numbers" if len(numbers) != 1 else f"the word {wrong[0]}"
        raise InputError(
            f"FEDRAT/ has {found}, expected one number and its unit, for example "
            f"FEDRAT/1200.0,MMPM (per minute {', '.join(PER_MINUTE)}; per second "
            f"{', '.join(PER_SECOND)}; per turn {', '.join(PER_TURN)})"
        )
    value = number(numbers[0], "FEDRAT")
    if value <= 0:
        raise InputError(f"FEDRAT/{value}, expected a positive feed")
    return feed_of(value, words, unit)


def feed_of(value: float, words: set[str], unit: float) -> Feed:
    """A value and the words of its unit.

    Args:
        value: in the unit of the words.
        words: such as MMPM, IPR.
        unit: of length of the file [m].
    """
    for word, length in PER_TURN.items():
        if word in words:
            return Feed("turn", value * length)
    if words & {"PERREV", "REV"}:
        return Feed("turn", value * unit)
    for word, length in PER_SECOND.items():
        if word in words:
            return Feed("speed", value * length)
    if "INVERS" in words:
        return Feed("inverse", value / 60)
    for word, length in PER_MINUTE.items():
        if word in words:
            return Feed("speed", value * length / 60)
    return Feed("speed", value * unit / 60)


def spindle(
    statement: Statement, before: Spindle, diameter: float | None, unit: float
) -> Spindle | None:
    """`SPINDL/`: the speed, from a surface speed too; None where that needs a diameter.

    `SPINDL/ON` turns again as before; OFF, STOP and LOCK hold.

    Args:
        statement: SPINDL/ and what it states.
        before: as it turned last.
        diameter: of the tool [m].
        unit: of length of the file [m].
    """
    words = set(statement.words)
    if words & {"OFF", "STOP", "LOCK", "ORIENT"}:
        return Spindle(0.0, before.clockwise)
    clockwise = before.clockwise
    if words & {"CLW", "CLW."}:
        clockwise = True
    elif words & {"CCLW", "CCW"}:
        clockwise = False
    numbers = _speeds(statement)
    if not numbers:
        return Spindle(before.speed, clockwise)
    if words & {"SFM", "SMM"}:
        if diameter is None or diameter <= 0:
            return None
        surface = numbers[0] * (FOOT if "SFM" in words else 1.0) / 60
        return Spindle(min(2 * surface / diameter, _most(statement)), clockwise)
    return Spindle(2 * math.pi * numbers[0] / 60, clockwise)


def _most(statement: Statement) -> float:
    """MAXRPM,n: the speed [rad/s] that a surface speed does not exceed; 0 is none."""
    words = [argument.upper() for argument in statement.arguments]
    behind = words[words.index("MAXRPM") + 1 :][:1] if "MAXRPM" in words else []
    rpm = number(behind[0], "SPINDL") if behind and is_number(behind[0]) else 0.0
    return 2 * math.pi * rpm / 60 if rpm > 0 else math.inf


def _speeds(statement: Statement) -> list[float]:
    """Numbers that are not those of RANGE or MAXRPM."""
    kept = []
    skip = False
    for argument in statement.arguments:
        if is_number(argument) and not skip:
            value = number(argument, "SPINDL")
            if value < 0:
                raise InputError(f"SPINDL/{value}, expected a speed of at least zero")
            kept.append(value)
        skip = argument.upper() in {"RANGE", "MAXRPM", "GEAR"}
    return kept
