"""The G codes: which move, which end or shift something, which are refused, and the words that some
of them own."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import CYCLES
from irb2400_ctrl.planners.toolpath.readers.gcode.frames import CODES as FRAMES
from irb2400_ctrl.planners.toolpath.readers.gcode.motion import ABSOLUTE, CENTRE, VECTOR
from irb2400_ctrl.planners.toolpath.readers.gcode.state import AXES, ROTARY, SPLINES, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

MOTION = {0, 1, 2, 3, 80, *SPLINES, *CYCLES}
EXACT_STOPS = frozenset([9.0, 60.0, 61.0, 61.1])
EXACT_STOP = (
    "G9, G60, G61: exact stops, which are not made: corners may be cut by --tolerance-mm, state "
    "less where that counts; where the way turns back or waits the tool is exact"
)
# blending, safe zones, look-ahead, compensation off: nothing for the points
_QUIET = """8 22 23 25 26 40 49.1 50 50.1 62 63 64 67 69.1 80.1 97 103 131 187 290 332
601 602 603 641 642 643 644 645 450 451"""
HARMLESS = frozenset(map(float, _QUIET.split()))
# take axis words for something else than a place to go to, or end something
SPECIAL = frozenset([4, 28, 28.1, 30, 53, 53.1, *FRAMES])
RADIUS = (
    "the offset by the tool's radius, which the control knows; let the CAM system write the path "
    "of the tool's centre (where it does, and the control adds the wear alone, take the word out)"
)
PROBE = (
    "a probe, and where it stops is not in the file; let the post processor leave out how a torch "
    "or a probe finds the part"
)
REFUSED = {
    **dict.fromkeys((2.2, 3.2), "an involute"),
    **dict.fromkeys((2.3, 3.3), "a spiral whose radius grows as an exponential"),
    **dict.fromkeys((2.4, 3.4), "an arc in space through a point of it"),
    5.2: "a spline",
    6.3: "a spline",
    7: "programming in diameters",
    7.1: "interpolation on a cylinder",
    12.1: "interpolation in polar coordinates",
    10: "a change of the control's offsets (where it only says before the first motion where the "
    "part lies on the machine, delete the line)",
    31: PROBE,
    33: "thread cutting",
    **dict.fromkeys((37, 38.2, 38.3, 38.4, 38.5), PROBE),
    **dict.fromkeys(
        (41, 42, *(round(c + n / 10, 1) for c in (41, 42) for n in range(1, 7))), RADIUS
    ),
    51: "scaling",
    51.1: "mirroring",
    68.3: "a tilted plane by the axes of the machine; expected G68.2 X Y Z I J K (Euler angles)",
    68.4: "a tilted plane in a tilted plane; expected G68.2 X Y Z I J K (Euler angles)",
    65: "a macro",
    66: "a macro",
    12: "a circular pocket (Haas); let the CAM system write its arcs",
    13: "a circular pocket (Haas); let the CAM system write its arcs",
    44: "a tool's length with the other sign",
    87: "boring from below",
    96: "constant surface speed",
    110: "a pole (Siemens)",
    111: "a pole (Siemens)",
    112: "a pole (Siemens), or X and Y of a turning part (Haas)",
    150: "a pocket (Haas); let the CAM system write its moves",
    268: "a tilted plane of Haas, whose order of angles stands elsewhere; expected G68.2 or G254",
}
PLACE_WORDS = frozenset("XYZABC")
_LIMITS = ("XYZABCIJKPQRS", "limits, which are not held")
_NUMBER = ("P", "")
# the letters that belong to a code, and what they are; without a text nobody takes them for a place
OWNED: dict[float, tuple[str, str]] = {
    8: _NUMBER,
    22: _LIMITS,
    25: _LIMITS,
    26: _LIMITS,
    43.1: (
        "XYZABC",
        "the tool's length offset and no motion (LinuxCNC, grbl); it is not applied: the places "
        "are those of the tip",
    ),
    50: ("S", "the highest speed of the spindle, which is not held"),
    50.1: ("XYZABC", "the axes that are no longer mirrored"),
    54.1: _NUMBER,
    64: ("PQ", ""),
    92: ("S", "the highest speed of the spindle, which is not held"),
    103: _NUMBER,
    154: _NUMBER,
    131: ("RJ", ""),
    187: _NUMBER,
    332: ("R", ""),
}
# of codes without a motion beside them: letters with which other controls mean something else by
# them, letters with which they do not, and what they mean
_ELSEWHERE: dict[float, tuple[str, str, str]] = {
    8: ("XYZIJ", "P", "an arc that begins along the move before (Fagor)"),
    93: ("XYZIJ", "F", "a pole or another zero (Fagor, MillPlus)"),
}

# what a letter may say, and beside which motions it says nothing
_BESIDE: dict[str, tuple[str, frozenset[float]]] = {
    "L": (
        "how often M98 or a cycle is repeated, on some controls the turns of a helix (let the CAM "
        "system write each turn)",
        frozenset([0, 1, 2, 3]),
    ),
    "P": ("the time of G4, the program of M98 or the turns of G2 and G3", frozenset([0, 1])),
    "Q": ("a step of G73 and G83", frozenset([2, 3])),
    "D": ("the register of G41 and G42", frozenset([1, 2, 3])),
}
# beside other codes and functions of M the words may be theirs
_WITHOUT_WORDS = frozenset(
    [0, 1, 2, 3, *range(15, 22), 49, 61, 69, 80, 90, 90.1, 91, 91.1, *range(93, 96), 98, 99]
)
_M_WITHOUT_WORDS = frozenset([0, 1, 2, *range(3, 10), 13, 14, 30, 48, 49, 60])


def refuse_idle_words(
    state: GcodeState, codes: tuple[list[float], list[int]], values: dict[str, float]
) -> None:
    """Words beside a motion that belong to nothing in their block.

    Args:
        state: with the motion in force.
        codes: the numbers behind G and behind M in the block.
        values: its words by their letter.

    Raises:
        InputError: there is one.
    """
    if not (_WITHOUT_WORDS.issuperset(codes[0]) and _M_WITHOUT_WORDS.issuperset(codes[1])):
        return
    for letter, (says, motions) in _BESIDE.items():
        # D is the edge of the tool on a control of Siemens
        if letter in values and state.motion in motions and not (state.siemens and letter == "D"):
            raise InputError(
                f"found {letter}{values[letter]:g} beside G{state.motion:g}, where it "
                f"says nothing that is read; {letter} is {says}: expected it there, or not at all"
            )


def without_owned(
    codes: list[float], values: dict[str, float], builder: ProgramBuilder
) -> dict[str, float]:
    """The words of a block without those that belong to a code which moves nothing.

    Args:
        codes: the G codes of the block.
        values: its words by their letter.
        builder: takes the notes.

    Raises:
        InputError: the words could also be the place that another code of the block moves to, or
            the code changes the coordinates and that is not read.
    """
    left = dict(values)
    moving = [code for code in codes if code in MOTION and code != 80]
    places = PLACE_WORDS & set(values)
    _refuse_of_others(codes, values, moving)
    for code in codes:
        if code == 50 and places and not moving:
            raise InputError(
                f"G50 with {min(places)} and no motion code sets the coordinates "
                "(lathes of Fanuc); not read, expected G92 for it, or where it ends scaling "
                "(mills), G50 alone or beside G0 or G1"
            )
        if code == 50 and places:
            builder.assume(
                f"G50 beside G{moving[0]:g} ends scaling, and the place is that of G{moving[0]:g} "
                "(mills)"
            )
        letters, says = OWNED.get(code, ("", ""))
        # G43.1 with H goes to the place beside it (Fanuc)
        taken = [letter for letter in letters if letter in values]
        if not taken or (code == 43.1 and "H" in values):
            continue
        # of a mill G50 S5000 G0 X9 is the spindle's speed, of a lathe its highest one
        if moving and (PLACE_WORDS & set(taken) or (code == 50 and places)):
            raise InputError(
                f"G{code:g} and G{moving[0]:g} in one block: whose is "
                f"{taken[0]}{values[taken[0]]:g}? Expected them in two lines"
            )
        for letter in taken:
            left.pop(letter, None)
        if says:
            shown = " ".join(f"{letter}{values[letter]:g}" for letter in taken)
            builder.assume(f"G{code:g} {shown}: {says}")
    return left


def _refuse_of_others(codes: list[float], values: dict[str, float], moving: list[float]) -> None:
    for code, (letters, without, says) in _ELSEWHERE.items():
        found = [letter for letter in letters if letter in values]
        if code in codes and found and without not in values and not moving:
            raise InputError(
                f"G{code:g} with {found[0]}{values[found[0]]:g} and no motion code: on some "
                f"controls {says}; not read, expected G{code:g} in a line of its own"
            )


def moves(values: dict[str, float], *, by_centre: bool = False) -> bool:
    """Whether a block has words that lead somewhere; `by_centre`: I, J and K do, and I=AC(…)
    (`GcodeState.by_centre`)."""
    words = (*AXES, *ROTARY, *VECTOR, *((*CENTRE, *ABSOLUTE) if by_centre else ()))
    return any(letter in values for letter in words)
