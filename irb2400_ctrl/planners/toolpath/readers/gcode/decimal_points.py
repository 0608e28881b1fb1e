"""Lengths without a decimal point: millimetres on most controls, thousandths on some of Fanuc's."""

from __future__ import annotations

import re

from irb2400_ctrl.planners.toolpath.readers.gcode.control import (
    is_linuxcnc,
    is_siemens,
    without_comments,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import CYCLES

_LENGTH = re.compile(r"(?<![A-Z#\d.])([XYZIJKR])\s*[-+]?(\d+\.?\d*|\.\d+)")
# what ends a cycle or begins one, G9 and G40 do not
_MOTION = re.compile(r"G\s*0*(0|[1-3]|7[346]|8\d)(?![\d.])")
_CALL = re.compile(r"M\s*0*98(?!\d)")
# K is how often a hole is drilled or a sub-program called, J how fast the tap turns back (Haas)
_COUNTS = frozenset("JK")


def without_point(text: str, name: str) -> list[tuple[int, str]]:
    """The first line with a length without a point, and what is assumed of it; nothing where none
    is, or the file is of a control of Siemens or LinuxCNC, on which X100 is always 100 mm."""
    if is_siemens(text, name) or is_linuxcnc(text, name):
        return []
    code = without_comments(text)
    bare = 0
    first = 0
    pointed = 0
    in_cycle = False
    for line, raw in enumerate(code.split("\n"), 1):
        for motion in _MOTION.findall(raw):
            in_cycle = int(motion) in CYCLES
        counts = _COUNTS if in_cycle or _CALL.search(raw) else frozenset[str]()
        for letter, number in _LENGTH.findall(raw):
            if letter in counts:
                continue
            if "." in number:
                pointed += 1
            elif float(number) != 0:
                bare += 1
                first = first or line
    if not bare:
        return []
    how = f"{bare} of {bare + pointed} lengths have" if pointed else "lengths have"
    says = (
        f"{how} no decimal point: X100 is read as 100 in the file's unit; some controls (Fanuc) "
        "count such numbers in their smallest step, X100 is 0.1 mm there"
    )
    return [(first, says)]
