"""`CYCLE/…` of APT-like files: which hole it describes.

Three ways of writing are in use. Creo: `DRILL, DEPTH, a, MMPM, b, CLEAR, c, RAPTO, d, RETURN, e`
(PTC's help, "CL Output for Holemaking Cycles"). Siemens NX: `DRILL, RAPTO, a, FEDTO, b, RTRCTO, c,
MMPM, d` with FEDTO counted upwards from the point. ISO 4343 and CATIA: bare numbers, depth first,
the clearance after it, the feed beside its unit.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, is_number, number
from irb2400_ctrl.planners.toolpath.readers.apt.units import FEED_WORDS, feed_of
from irb2400_ctrl.planners.toolpath.readers.dialect import CREO, NX
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle

# DWELL,REV,n counts revolutions
CYCLE_FEED_WORDS = FEED_WORDS - {"REV", "LOCK"}
PER_TURN = frozenset({"MMPR", "IPR", "PERREV"})
KINDS = {
    "DRILL": "drill",
    "SPOT": "drill",
    "SPDRL": "drill",
    "CDRILL": "drill",
    "CTRDRL": "drill",
    "FACE": "drill",
    "CSINK": "drill",
    "CBORE": "drill",
    "SPFACE": "drill",
    "THRU": "drill",
    "DEEP": "peck",
    "DEEPHL": "peck",
    "DEEP2": "peck",
    "PECK": "peck",
    "BRKCHP": "chip",
    "CHIP": "chip",
    "REAM": "bore",
    "BORE": "bore",
    "TAP": "bore",
    "RIGID": "bore",
}
THREADS = frozenset({"TAP", "RIGID"})
# words that state a height; beside them bare numbers mean something else
HEIGHTS = frozenset({"depth", "feed to", "clear", "rapid to", "retract"})
REFUSED = frozenset({"MILL", "THREAD", "ROUGH", "PROFIL", "BACKBORE", "BCKBRE", "PLUNGE", "GROOVE"})
# words with a number: what it means
LENGTH_WORDS = {
    "DEPTH": "depth",
    "FEDTO": "feed to",
    "CLEAR": "clear",
    "RAPTO": "rapid to",
    "RETURN": "retract",
    "RTRCTO": "retract",
    "STEP": "step",
    "INCR": "step",
    "STEP1": "step",
    "STEP2": "step",
    "STEP3": "step",
    "STEP4": "step",
    "STEP5": "step",
    "STEP6": "step",
    "STEP7": "step",
    "1STPECK": "step",
    "SUBPECK": "step",
}
# numbers that change no place
_OTHERS = """DWELL TIMES TPI LEAD PITCH DIAMETR DIAMET DIA REV CAM TOOL ORIENT ORIANT CSINK BACK
TLANGL CUTANG SPINDL OFFSET MAXRPM RANGE RETRCT BOTTOM TLCOMP THREAD THRDS"""
OTHER_WORDS = frozenset(_OTHERS.split())
# ORIENT,angle,way aside
SEVERAL = frozenset({"ORIENT"})
# back to the height from which the tool came (NX: RTRCTO,AUTO; Creo: RETURN,0)
UP_WORDS = frozenset({"AUTO", "MANUAL"})


def hole_cycle(statement: Statement, unit: float, dialect: str) -> HoleCycle:
    """The hole of a `CYCLE/` statement.

    Args:
        unit: length unit of the file [m].
        dialect: in NX CLSF, RAPTO is a height over the point, in Creo NCL a way down from CLEAR;
            among bare numbers Creo writes the feed before its unit, others behind it.

    Raises:
        InputError: no drilling cycle, no depth, or numbers whose meaning is not known.
    """
    words = statement.words
    kind, name = _kind(words)
    values, bare, feed, between = _values(statement, dialect == CREO)
    feed_words = {word for word in words if word in CYCLE_FEED_WORDS}
    assumed = ""
    if feed is not None and between and len(bare) == 2 and not HEIGHTS & set(values):
        bare[1], feed = _told_apart(bare[1], feed, feed_words, name)
        assumed = f"of the bare numbers {bare[1]:g} is the clearance, {feed:g} the feed"
    if feed is None and values.get("TPI", [0.0])[0] > 0:
        feed = 1 / values["TPI"][0]
        feed_words = {"IPR"}
    depth, clear, steps = _bare(bare, values)
    if "feed to" in values:
        depth = _below(values["feed to"][0], dialect)
    rapid_to = values.get("rapid to", [None])[0]
    # RAPTO beside FEDTO counts from the point, as FEDTO does
    upwards = dialect == NX or (dialect != CREO and "feed to" in values)
    clearance, start = _heights(clear, rapid_to, upwards)
    if depth is None:
        raise InputError(
            f"CYCLE/{name} states no depth; expected DEPTH,… (Creo), FEDTO,… (NX) or the "
            "depth as first number"
        )
    if depth < 0 or any(step <= 0 for step in steps):
        raise InputError(f"CYCLE/{name} has a negative depth or step; expected lengths")
    if clear is not None and clear < 0:
        raise InputError(
            f"CYCLE/{name} has the clearance {clear:g}, below the point; expected a height over it"
        )
    retract = values.get("retract", [clearance])[0]
    if UP_WORDS & set(words) or ("RETURN" in words and retract == 0):
        retract = math.inf
    return HoleCycle(
        kind if steps or kind not in {"peck", "chip"} else "drill",
        depth * unit,
        start * unit,
        max(retract, start) * unit,
        tuple(step * unit for step in steps),
        _dwell(values),
        None if feed is None else feed_of(feed, feed_words, unit),
        name,
        assumed,
    )


def resumed(before: Statement | None, statement: Statement) -> Statement:
    """`CYCLE/ON[,FEDTO,…]`: the cycle from before `CYCLE/OFF`, with what is stated anew.

    Raises:
        InputError: there was none.
    """
    if before is None:
        raise InputError("CYCLE/ON without a CYCLE/ before it; expected CYCLE/DRILL,…")
    groups = _groups(before.arguments)
    anew = _groups(statement.arguments[1:])
    feeds = FEED_WORDS & {group[0].upper() for group in anew}
    stated = {group[0].upper() for group in anew}
    kept = [
        group
        for group in groups
        if group[0].upper() not in stated and not (feeds and group[0].upper() in FEED_WORDS)
    ]
    arguments = tuple(argument for group in [*kept, *anew] for argument in group)
    return replace(before, line=statement.line, arguments=arguments)


def _groups(arguments: tuple[str, ...]) -> list[list[str]]:
    """Arguments with the word before them: [[DRILL], [FEDTO, -10], [RTRCTO, AUTO]]."""
    groups: list[list[str]] = []
    for argument in arguments:
        begins = not is_number(argument) and argument.upper() not in UP_WORDS
        if begins or not groups:
            groups.append([argument])
        else:
            groups[-1].append(argument)
    return groups


def _kind(words: list[str]) -> tuple[str, str]:
    found = [word for word in words if word in KINDS]
    refused = [word for word in words if word in REFUSED]
    if words[:2] == ["BORE", "BACK"]:
        # NX: through the hole, and the cut from below
        refused = ["BORE,BACK"]
    if refused or not found:
        shown = (refused or words or ["nothing"])[0]
        raise InputError(
            f"CYCLE/{shown} is not read; expected one of {', '.join(KINDS)}, or points"
        )
    # NX: DRILL,DEEP and DRILL,BRKCHP: the later word says how
    special = [word for word in found if KINDS[word] != "drill"]
    name = (special or found)[0]
    return KINDS[name], name


def _values(
    statement: Statement, feed_first: bool
) -> tuple[dict[str, list[float]], list[float], float | None, bool]:
    """Numbers by their word, bare numbers, the feed beside its unit, and whether the unit stands
    between two bare numbers, so that either may be the feed."""
    values: dict[str, list[float]] = defaultdict(list)
    bare: list[float] = []
    feed: float | None = None
    between = False
    last = ""
    followings = (*statement.arguments[1:], "")
    for position, (argument, following) in enumerate(
        zip(statement.arguments, followings, strict=True)
    ):
        if is_number(argument):
            value = number(argument, "CYCLE")
            if last in LENGTH_WORDS:
                values[LENGTH_WORDS[last]].append(value)
            elif last in CYCLE_FEED_WORDS and feed is None:
                feed = value
                between = len(bare) == 2
            elif last in CYCLE_FEED_WORDS:
                # Creo's peck table: other feeds in deeper steps; the slowest is safe for all
                feed = min(feed, value) if feed is not None else value
            elif last in OTHER_WORDS:
                values[last].append(value)
            else:
                bare.append(value)
                continue
        elif (
            feed is None
            and (feed_first or not is_number(following))
            and _feed_before(argument, last, bare, values)
        ):
            feed = bare.pop()
            last = ""
            continue
        kept = last if last in SEVERAL else ""
        last = kept if is_number(argument) else argument.upper()
        if last in KINDS and (position == 0 or not (last in OTHER_WORDS and is_number(following))):
            last = ""
    if feed is not None and feed <= 0:
        raise InputError(f"CYCLE/ has the feed {feed}, expected a positive one")
    return values, bare, feed, between


def _below(feed_to: float, dialect: str) -> float:
    """The depth of `FEDTO`: NX counts it upwards, others write either sign.

    Raises:
        InputError: NX, and the bottom would be above the point.
    """
    if dialect == NX and feed_to > 0:
        raise InputError(
            f"CYCLE/ with FEDTO,{feed_to:g}: NX counts it upwards from the point, so that "
            "the bottom would be above it; expected a negative one"
        )
    return abs(feed_to)


def _told_apart(
    first: float, second: float, feed_words: set[str], name: str
) -> tuple[float, float]:
    """Clearance and feed of `depth, a, MMPM, b`, which tables of post-processors write either way:
    a feed per minute is the larger of the two numbers, one per turn the smaller. The pitch of a
    thread is as large as a clearance: it stands before its unit, as all of CATIA's feeds do."""
    low, high = sorted((first, second))
    if not feed_words & PER_TURN:
        return low, high
    return (second, first) if name in THREADS else (high, low)


def _feed_before(
    argument: str, last: str, bare: list[float], values: dict[str, list[float]]
) -> bool:
    """Whether the bare number just read is a feed: its unit follows, and it is not the depth."""
    stated = "depth" in values or "feed to" in values
    return argument.upper() in CYCLE_FEED_WORDS and last == "" and len(bare) > (0 if stated else 1)


def _bare(
    bare: list[float], values: dict[str, list[float]]
) -> tuple[float | None, float | None, list[float]]:
    """Depth, clearance and steps from numbers with and without a word."""
    depth = values.get("depth", [None])[0]
    clear = values.get("clear", [None])[0]
    steps = list(values.get("step", []))
    rest = list(bare)
    if depth is None and "feed to" not in values and rest:
        depth = rest.pop(0)
    if clear is None and "rapid to" not in values and rest:
        clear = rest.pop(0)
    if rest or len(values.get("depth", [])) > 1:
        raise InputError(
            f"CYCLE/ has numbers whose meaning is not known: {rest or values['depth']}; "
            "expected words before them (DEPTH, STEP, CLEAR, RETURN, FEDTO, RAPTO, RTRCTO)"
        )
    return depth, clear, steps


def _heights(clear: float | None, rapid_to: float | None, upwards: bool) -> tuple[float, float]:
    """Height of the retract and height where the feed begins."""
    if rapid_to is None:
        return clear or 0.0, clear or 0.0
    if clear is None or upwards:
        return rapid_to, rapid_to
    return clear, clear - rapid_to


def _dwell(values: dict[str, list[float]]) -> float:
    """Seconds at the bottom."""
    return max(values.get("DWELL", [0.0])[0], 0.0)
