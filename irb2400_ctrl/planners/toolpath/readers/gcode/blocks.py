"""The blocks of G-code: words of a letter and a number, and comments.

An own lexer, about a hundred lines: of the two libraries at hand, `gcodeparser` drops what its
pattern does not match (a block `X1 Y2` without G1 among it) and `pygcode` has had no release since
2017 and is under the GPL.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.flow import Line
from irb2400_ctrl.planners.toolpath.readers.gcode.hole_calls import HoleCall, taken_out
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.variables import (
    ENTER,
    LEAVE,
    Variables,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.siemens_words import (
    NAMED,
    NUMBER,
    TO_ANGLE,
    rewritten,
    with_square_brackets,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.swivel import CALL as SWIVEL
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError

WORD = re.compile(rf"\s*([A-Z$])\s*=?\s*{NUMBER}")
# one word that says for itself what G90 and G91 say for a block: X=IC(10), X=AC(10)
BY_ITSELF = tuple(f"{axis}{how}" for axis in "XYZABC" for how in ("IC", "AC"))
# a block that the operator may skip, by one of nine switches: /G1, /2 G1
OPTIONAL = re.compile(r"/\s*(?:[1-9](?=\s*(?:[A-Z]|$)))?\s*")
# G0 X10; N20 G1 Z-5;
BLOCK_BEHIND = re.compile(
    r"[^;(]*[A-Z]\s*[-+]?[\d.]+\s*;\s*(?:N\d+\s*)?(?:[GMIJKRFST]\s*-?[\d.]+\s*)*"
    r"[XYZ]\s*[-+]?[\d.]+\s*(?:[A-Z]\s*[-+]?[\d.]+\s*)*(?:;|$)",
    re.IGNORECASE,
)
# words of several letters (Siemens)
EXTENDED = (TO_ANGLE, "CR", "TURN", "RPL", "A3", "B3", "C3", "IAC", "JAC", "KAC", *BY_ITSELF)
# $: which spindle, or torch (LinuxCNC)
LETTERS = frozenset([*"ABCDFGHIJKLMNPQRSTXYZ$", *EXTENDED])
# what holds until another of the same group: two of them in one block contradict each other
MODAL = tuple(
    frozenset(map(float, group.split()))
    for group in ("17 18 19", "20 21 70 71 700 710", "90 91", "90.1 91.1", "93 94 95", "98 99")
)
STATED_ONCE = frozenset("XYZABCIJKRQFST")
EXTENDED_WORD = re.compile(rf"\s*({'|'.join(EXTENDED)})\s*=\s*{NUMBER}")
SPLINE = re.compile(r"\b(?:[ABC]SPLINE|POLY|PO(?=\s*\[))(?![A-Z])")
SUBPROGRAM = re.compile(r"^\s*O\s*<|^\s*O\d+\s+(SUB|CALL|IF|WHILE|REPEAT|DO|ENDSUB)")
UNREADABLE = (
    (
        re.compile(r"CYCLE\d+|MCALL|HOLES\d|POCKET\d|SLOT\d"),
        "cycles written as calls (Siemens) are not read; let the CAM system write the moves",
    ),
    (
        re.compile(r"^\s*O\s*(?:<[^<>]*>|\d+)\s*(?:END)?SUB\b"),
        "a sub-program (LinuxCNC) that no line of the file calls; expected a program that does",
    ),
    (SUBPROGRAM, "of o-words sub, call, while, do, repeat and if are read"),
    (
        re.compile(r"\$P?_"),
        "what the control keeps in such variables (frames, places, states; Siemens) is not read: "
        "let the CAM system write all places in one frame",
    ),
    (
        re.compile(r"^[A-Z_]\w+\s*:|\b(REPEATB?|LOOP|GOTO[BCFS]|CASE|FOR|ENDFOR|ENDLOOP|UNTIL)\b"),
        "jumps and loops of Siemens, and labels, are not read: let the CAM system write all moves "
        "out",
    ),
    (
        re.compile(r"[#\[\]]|\bR\d+\s*=|=\s*R\d|\b(WHILE|IF|GOTO|ELSE|END\w*)\b|^\$|DEF\b"),
        "of variables and expressions those are read that set or state a number, of jumps and "
        "loops IF [ ] GOTO, IF [ ] THEN and WHILE [ ] DO1, each in a line of its own: let the CAM "
        "system write all moves out",
    ),
    (
        re.compile(r"\b(?:CALL|MODIN|MODOUT)\b|\bV[CS]\d"),
        "of calls on controls of Okuma CALL O1 Q2 of a program in the file is read, without "
        "variables (VC1): let the CAM system write numbers",
    ),
    (
        re.compile(r"\bPROC\b.*\bSAVE\b"),
        "with SAVE the caller has its G functions back behind the sub-program, which is not read: "
        "take SAVE out where the sub-program changes none, or write all moves into one program",
    ),
    (re.compile(r"\b(CT|CIP|INVCW|INVCCW)\b"), "of arcs G2 and G3 are read"),
    (re.compile(r"\*"), "blocks that end in * (Heidenhain's DIN/ISO) or a checksum are not read"),
    (re.compile(r"\d,\d"), "of decimal numbers only those with a point are read"),
    (re.compile(r",\s*[RC]"), "corners written as ,R or ,C are not read"),
    (re.compile(r"="), "of words with = only those such as X=10, CR=5, I=AC(10), A3=0 are read"),
    (
        re.compile(r"\b(ROTS|AROTS|CROTS|SCALE|ASCALE|MIRROR|AMIRROR)\b"),
        "of programmed frames (Siemens) TRANS, ATRANS, ROT and AROT are read",
    ),
)
# the tool's length from the control's own table (FreeCAD for Fanuc): a place of the machine
REWRITTEN = (
    (
        re.compile(r"\bZ\s*-?\s*\[\s*#\s*\[\s*2[02]00\s*\+\s*#4120\s*\]\s*\]", re.IGNORECASE),
        "G53 Z0",
    ),
    (re.compile(r"\bH\s*#4120\b", re.IGNORECASE), ""),
    # smoothing: G187 P3 E.01 (Haas), G61.1 ,A1 (Mazak)
    (re.compile(r"(\bG187\b[^;(]*?)\s*E\s*[\d.]+", re.IGNORECASE), r"\1"),
    (re.compile(r"(\bG61\.1)\s*,\s*[A-Z]\s*\d+", re.IGNORECASE), r"\1"),
    # a main block (ISO 6983; posts of NX write it at a change of tool): :30 T1 M6
    (re.compile(r"^(\s*/?)\s*:\s*\d+(?=\s*[A-Z])", re.IGNORECASE), r"\1"),
    # axes that go home (3D printers): G28 X Y
    (re.compile(r"(\bG28)(?:\s*[XYZ](?!\s*[-+.\d=\[#]))+", re.IGNORECASE), r"\1"),
    # the head of a sub-program without arguments, and its declaration (Siemens)
    (
        re.compile(
            r"^\s*(?:N\d+\s*)?(?:PROC|EXTERN)\s+[A-Z_]\w*\s*(?:\(\s*\))?"
            r"(?:\s*\b(?:DISPLO[FN]|SBLO[FN]|ACTBLOCNO)\b)*\s*(?=;|$)",
            re.IGNORECASE,
        ),
        "",
    ),
    # home, settings and questions of GRBL, but no jog ($J=…) and none of Siemens ($P_PFRAME=…); the
    # name of a program (Okuma)
    (re.compile(r"^\s*\$H\s*(?=[;(]|$)", re.IGNORECASE), "G28 "),
    (re.compile(r"^\s*(?:\$(?!J=|[A-Z]+_)[\w$#.=-]+%?|\?)\s*(?=[;(]|$)", re.IGNORECASE), ""),
)


@dataclass(frozen=True)
class Block:
    """One line."""

    line: int
    words: tuple[tuple[str, float], ...]
    comments: tuple[str, ...] = ()
    orders: tuple[str, ...] = ()
    """written out: TRAORI, …"""
    call: HoleCall | None = None
    """holes as a call (Siemens)"""
    optional: bool = False
    """behind a / : skipped when the operator wants it"""
    behind_slashes: bool = False
    """behind //, which no standard knows"""
    plane: tuple[str, ...] | None = None
    """what CYCLE800 states (Siemens)"""
    tape_mark: bool = False
    """a % alone: begins the program, or ends it"""
    block_behind: bool = False
    """behind its ; stands what reads as a block"""

    @property
    def assumed(self) -> list[str]:
        """What is to be said of how it was read."""
        if not (self.optional or self.behind_slashes or self.block_behind):
            return []
        notes = {
            "blocks behind / are carried out": self.optional,
            "lines behind // are comments": self.behind_slashes,
            "what stands behind ; is a comment and left out, though it reads as a block: where ; "
            "ends blocks, each belongs in a line of its own": self.block_behind,
        }
        return [note for note, holds in notes.items() if holds]

    def codes(self, letter: str) -> list[float]:
        """All numbers behind this letter."""
        return [value for key, value in self.words if key == letter]

    @property
    def ready(self) -> int | None:
        """The tool to make ready: the second one of T1 T2 M6 (Mazak)."""
        tools = self.codes("T")
        return int(tools[1]) if len(tools) == 2 and 6 in self.codes("M") else None

    def values(self) -> dict[str, float]:
        """The words other than G, M and N by their letter."""
        return {key: value for key, value in self.words if key not in "GMN"}

    def checked(self) -> dict[str, float]:
        """The same; `place` is for messages.

        Raises:
            InputError: a word that is not known, a place stated in two ways, a unit that is a cycle
                on other controls.
        """
        values = self.values()
        if self.ready is not None:
            values["T"] = self.codes("T")[0]
        unknown = sorted(set(values) - LETTERS)
        if unknown:
            why = (
                "; E pushes plastic in 3D printing, is a work frame on Fadal, and an argument of "
                "macros (G65, G47)"
                if unknown[0] == "E"
                else ""
            )
            raise InputError(f"found the word {unknown[0]}, which is not read{why}")
        for letter, value in self.words:
            once = STATED_ONCE - {"T"} if self.ready is not None else STATED_ONCE
            if letter in once and value != values[letter]:
                raise InputError(
                    f"found {letter}{value:g} and {letter}{values[letter]:g} in one "
                    "block, expected one of them (two lines run together?)"
                )
        codes = set(self.codes("G"))
        for group in MODAL:
            if len(codes & group) > 1:
                first, second = sorted(codes & group)[:2]
                raise InputError(
                    f"found G{first:g} and G{second:g} in one block, which contradict "
                    "each other; expected one of them"
                )
        if codes & {70, 71} and not codes & {0, 1, 2, 3} and set("IJKLPQRU") & set(values):
            raise InputError(
                "G70 and G71 with such words are cycles (Haas, Fanuc), which are not "
                "read; alone they are inches and millimetres"
            )
        return values


def blocks(
    lines: Iterable[Line | UnreadLineError], variables: Variables
) -> Iterator[Block | UnreadLineError]:
    """All lines that hold anything; a line that cannot be read comes as its error."""
    for numbered in lines:
        if isinstance(numbered, UnreadLineError):
            yield numbered
            continue
        line, raw = numbered
        if raw.startswith((ENTER, LEAVE)):
            try:
                variables.scope(raw)
            except InputError as error:
                yield UnreadLineError(line, str(error))
            continue
        if raw.lstrip().startswith("//"):
            yield Block(line, (), (raw.strip(),), behind_slashes=True)
            continue
        stated = raw.strip()
        for pattern, text_for_it in REWRITTEN:
            raw = pattern.sub(text_for_it, raw)
        raw = rewritten(raw)
        call, raw = taken_out(raw)
        swivelled = SWIVEL.search(raw)
        raw = SWIVEL.sub(" ", raw)
        code, comments, closed = _split(with_square_brackets(raw) if "=" in raw else raw)
        code = code.strip().upper()
        skipped = OPTIONAL.match(code)
        code = code[skipped.end() :] if skipped else code
        if code.startswith("%"):
            if code == "%":
                yield Block(line, (), tape_mark=True)
            continue
        # program number or name: O1234, :1234, <NAME>, ONAME (Okuma)
        code = re.sub(r"^(?:[O:]\s*\d+|O[A-Z]\w{0,3}|(?:O\s*\d+\s*)?<[^<>]*>)\s*$", "", code)
        try:
            if not closed:
                raise InputError("found a comment ( without its )")
            if found_spline := SPLINE.search(code):
                raise InputError(
                    f"found {found_spline[0]}: splines and polynomials "
                    "(Siemens) are not read; let the CAM system write straight moves and arcs"
                )
            words, orders = _words(variables.resolve(code), stated)
        except InputError as error:
            variables.lost = True
            yield UnreadLineError(line, str(error))
            continue
        plane = tuple(part.strip() for part in swivelled[1].split(",")) if swivelled else None
        if words or comments or orders or call or swivelled or skipped:
            found = (tuple(words), tuple(comments), tuple(orders))
            behind = ";" in stated and BLOCK_BEHIND.match(stated) is not None
            yield Block(line, *found, call, skipped is not None, plane=plane, block_behind=behind)


def _split(raw: str) -> tuple[str, list[str], bool]:
    """Code without comments, the comments, and whether all are closed; `;` reaches to the end of
    the line."""
    comments: list[str] = []
    code = ""
    rest = raw
    while rest:
        start = re.search(r"[(;]", rest)
        if start is None:
            code += rest
            break
        code += rest[: start.start()] + " "
        if rest[start.start()] == ";":
            comments.append(rest[start.start() + 1 :].strip())
            break
        end = _end_of_comment(rest, start.start())
        comments.append(rest[start.start() + 1 : end].strip())
        if end == len(rest):
            return code, comments, False
        rest = rest[end + 1 :]
    return code, comments, True


def _end_of_comment(text: str, start: int) -> int:
    """Where the bracket opened at `start` is closed, brackets inside it counted if they match; the
    length of the text where it is not."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return at
    # an opening bracket inside a comment that nobody closes: the first closing one ends it
    first = text.find(")", start)
    return len(text) if first < 0 else first


def _words(code: str, stated: str) -> tuple[list[tuple[str, float]], list[str]]:
    """Words and orders of a block, and its line as the file states it, for messages."""
    words: list[tuple[str, float]] = []
    orders: list[str] = []
    before = 0
    at = 0
    while at < len(code):
        named = NAMED.match(code, at)
        word = EXTENDED_WORD.match(code, at) or WORD.match(code, at)
        if named:
            orders.append(named.group(1))
            at = named.end()
        elif word:
            value = float(word.group(2))
            if not math.isfinite(value):
                raise InputError(f"found {word.group(2)[:20]}…, expected a finite number")
            words.append(("R" if word.group(1) == "CR" else word.group(1), value))
            before = at
            at = word.end()
        elif code[at:].strip() == "":
            break
        else:
            why = next((text for pattern, text in UNREADABLE if pattern.search(code)), "")
            # A5=0 begins as the word A5
            rest = code[before if code[at:].lstrip().startswith("=") else at :].strip()
            # numbers in the place of variables, and what was rewritten, are not in the file
            shown = rest if rest in stated.upper() else stated
            raise InputError(
                f"found {shown[:30]!r}, expected words such as G1 X10.5"
                + (f"; {why}" if why else "")
            )
    return words, orders
