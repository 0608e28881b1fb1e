"""Holes as calls (Siemens 840D): `CYCLE81(RTP, RFP, SDIS, DP, DPR, …)`, `MCALL` for many of them.

Source: Siemens, SINUMERIK 840D sl Programming Manual Job Planning, "Programming cycles externally".
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import MOST_STEPS, HoleCycle
from irb2400_ctrl.planners.toolpath.readers.feed import Feed
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.unread_line import WordError

CALL = re.compile(r"\b(MCALL\s+)?(CYCLE8[1-9]|HOLES[12])\s*\(([^()]*)\)", re.IGNORECASE)
BEGINS = re.compile(r"CALL|CYCLE|HOLES", re.IGNORECASE)
# CYCLE80 ends a modal call on older controls
NO_CALL = re.compile(r"\bMCALL\b(?:\s+CYCLE80\b)?(?!\s+[A-Z])", re.IGNORECASE)
KINDS = {
    "CYCLE81": "drill",
    "CYCLE82": "drill",
    "CYCLE83": "peck",
    "CYCLE84": "bore",
    "CYCLE85": "bore",
    "CYCLE86": "drill",
    "CYCLE89": "bore",
}
# the place of _GMODE, which may count the depth at the shank instead of the tip
AT_THE_SHANK = {"CYCLE81": 6, "CYCLE82": 6, "CYCLE83": 17}
# of CYCLE83: name, and the values that ask for nothing
NOT_OF_THE_WAY = {
    9: ("DTS (dwell at the start)", {None, 0.0}),
    10: ("FRF (share of the feed for the first depth)", {None, 0.0, 1.0}),
    14: ("_VRT (way back at a break)", {None, 0.0}),
    15: ("_DTD (dwell at the bottom)", {None, 0.0}),
}


@dataclass(frozen=True)
class HoleCall:
    """One call; without a name it ends the modal one."""

    name: str
    arguments: tuple[str, ...]
    modal: bool


def taken_out(code: str) -> tuple[HoleCall | None, str]:
    """The call in a line, and the line without it."""
    if not BEGINS.search(code):
        return None, code
    found = CALL.search(code)
    if found:
        arguments = tuple(part.strip() for part in found.group(3).split(","))
        call = HoleCall(found.group(2).upper(), arguments, found.group(1) is not None)
        return call, code[: found.start()] + code[found.end() :]
    ends = NO_CALL.search(code)
    if ends:
        return HoleCall("", (), True), code[: ends.start()] + code[ends.end() :]
    return None, code


def cycle_of(call: HoleCall, state: GcodeState, spindle_rpm: float) -> tuple[float, HoleCycle]:
    """Height of the reference plane [m], and the hole below it.

    Raises:
        InputError: a cycle that is not read, or arguments that are missing or contradict each
            other.
    """
    if call.name not in KINDS:
        raise InputError(f"{call.name} is not read; expected one of {', '.join(KINDS)}")
    at = [number(text, call.name) for text in call.arguments] + [None] * 20
    shank = AT_THE_SHANK.get(call.name, -1)
    if shank >= 0 and at[shank]:
        raise InputError(
            f"{call.name} with _GMODE {at[shank]:g} counts the depth at the shank or a "
            "diameter; expected 0 (the tip)"
        )
    retract = at[0]
    plane = at[1]
    clear = abs(at[2] or 0.0)
    depth = _depth(at, call.name)
    if retract is None or plane is None or retract < plane or depth < 0:
        raise InputError(
            f"{call.name}({', '.join(call.arguments[:5])}): expected retraction plane "
            "over reference plane over depth (RTP, RFP, SDIS, DP)"
        )
    kind = KINDS[call.name]
    steps: tuple[float, ...] = ()
    if call.name == "CYCLE83":
        kind = "peck" if at[11] and at[11] % 10 == 1 else "chip"
        steps = _steps(at, plane, clear, depth)
    unit = state.unit
    return plane * unit, HoleCycle(
        kind,
        depth * unit,
        clear * unit,
        max(retract - plane, clear) * unit,
        tuple(step * unit for step in steps),
        _dwell(at, call.name, spindle_rpm),
        _feed(at, call, state),
        call.name,
        feed_out=_feed_out(at, call, state),
    )


def left_out(call: HoleCall) -> str:
    """What `CYCLE83` states of its way and is not carried out; empty where it states nothing."""
    found = []
    for place, (name, nothing) in NOT_OF_THE_WAY.items():
        text = call.arguments[place] if place < len(call.arguments) else ""
        if call.name == "CYCLE83" and number(text, call.name) not in nothing:
            found.append(f"{name} {text}")
    return ", ".join(found)


def number(text: str, word: str) -> float | None:
    """An argument; None where it is left out, or a text.

    Raises:
        InputError: neither.
    """
    if not text or text.startswith('"'):
        return None
    try:
        return float(text)
    except ValueError:
        raise WordError(word, f"found {text!r}, expected a number") from None


def _depth(at: list[float | None], name: str) -> float:
    """Below the reference plane: DP is a height, DPR a length."""
    plane = at[1]
    height = at[3]
    length = at[4]
    if height is None and not length:
        raise InputError(f"{name} states no depth; expected DP or DPR")
    if height is None or plane is None:
        return abs(length or 0.0)
    if length and abs(plane - height - abs(length)) > 1e-6:
        raise InputError(f"{name}: DP {height:g} and DPR {length:g} differ; expected one")
    return plane - height


def _steps(at: list[float | None], plane: float, clear: float, depth: float) -> tuple[float, ...]:
    """FDEP or FDPR first, then less by DAM each time, at least MDEP (or DAM)."""
    first = plane - at[5] if at[5] is not None else abs(at[6] or 0.0)
    if first <= 0:
        return ()
    less = at[7] or 0.0
    least = at[13] or abs(less)
    steps = [first + clear]
    step = first
    reached = first
    while less and reached < depth and len(steps) < MOST_STEPS:
        step = max(step - less, least) if less > 0 else max(step * -less, at[13] or 0.1 * first)
        steps.append(step)
        reached += step
    return tuple(steps) if less else (first + clear, first)


def _dwell(at: list[float | None], name: str, spindle_rpm: float) -> float:
    """DTB: seconds, or turns of the spindle where negative."""
    stated = (at[8] if name == "CYCLE83" else at[5]) or 0.0
    if stated >= 0:
        return stated
    if spindle_rpm <= 0:
        raise InputError(f"{name} dwells for turns of the spindle, and its speed is open")
    return -stated * 60 / spindle_rpm


def _feed(at: list[float | None], call: HoleCall, state: GcodeState) -> Feed | None:
    """Of the way in. CYCLE84: pitch times speed; CYCLE85: FFR; the others have the one in force."""
    if call.name == "CYCLE85" and at[6]:
        return Feed("speed", at[6] * state.feed_unit / 60)
    if call.name != "CYCLE84":
        return None
    if not at[8] or not at[10]:
        raise InputError("CYCLE84 without PIT and SST; expected pitch and speed")
    return Feed("speed", abs(at[8] * at[10]) * state.unit / 60)


def _feed_out(at: list[float | None], call: HoleCall, state: GcodeState) -> Feed | None:
    """RFF of CYCLE85."""
    if call.name != "CYCLE85" or not at[7]:
        return None
    return Feed("speed", at[7] * state.feed_unit / 60)
