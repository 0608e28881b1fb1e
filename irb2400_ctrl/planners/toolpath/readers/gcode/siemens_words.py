"""Words of Siemens' controls (840D): what shapes the control's own timing, and what is written in
another way than elsewhere."""

from __future__ import annotations

import re

# an exponent (6.1e-17, as scripts print numbers) has a sign and two digits; E of printers has not
NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]\d{2,3}(?![\d.]))?)"
# an expression in brackets: AC([10]), IC([R1+2])
_VALUE = r"(\[[^()]*\])"
# an angle to turn to, in G91 too: C=DC(30), C=AC(30)
TO_ANGLE = "TOANGLE"
# a tool called by its name, as a comment: words of a block are numbers
CALLED_TOOL = "TOOL CALLED BY NAME:"
# transformation, acceleration, feed, compression, dynamics, look-ahead, approach, protected zones
_QUIET = """SOFT BRISK DRIVE FFWON FFWOF COMPCAD COMPON COMPCURV COMPOF COMPSURF COMPPATH FNORM FLIN
CFC CFTCP CFIN ORIWKS ORIMKS ORIAXES ORIVECT ORIPLANE ORIPATH ORIEULER ORIRPY2 ORIRPY ORIVIRT1
ORIVIRT2 ORISON ORISOF DIAMOF STOPRE FGROUP WAITS DYNNORM DYNPOS DYNROUGH DYNSEMIFIN DYNFINISH
DYNPREC UPATH SPATH FIFOCTRL STARTFIFO STOPFIFO KONT NORM CUT2DF CUT2D CDOF2 CDOF CDON WALIMON
WALIMOF RTLION RTLIOF GROUP_BEGIN GROUP_END"""
NAMED = re.compile(
    rf"\s*(TRAORI|TRAFOOF|SUPA|A?TRANS|A?ROT|{'|'.join(_QUIET.split())})\b"
    r"(\(\s*[\w, ]*\s*\))?"
)
# tolerances, blending, the override of rapid moves, the arm's branch; by axis: jerk, speed,
# acceleration
_SETTINGS = re.compile(
    r"(?<![A-Z_])(?:(?:ADIS(?:POS)?|[ACO]TOL|OVRRAP|OVR(?=\s*=\s*100(?!\d))|STAT|TU)|"
    rf"(?:JERKLIM|VELOLIM|ACCLIM|ACC|OVRA|FGREF)\s*\[\s*\w+\s*\])\s*=\s*(?:{NUMBER}|'\w+')",
    re.IGNORECASE,
)
# G75 alone with axes at zero: words with numbers are a cycle of other controls
_FIXED_POINT = re.compile(
    r"^(\s*(?:N\d+)?\s*(?:G\s*\d+\s*)*?)\bG75\b"
    r"((?:\s*(?:FP\s*=\s*\d+|[XYZABC]\d?\s*=?\s*[-+]?0*\.?0*(?![\d.])))+)\s*(?:D0\s*)?$",
    re.IGNORECASE,
)
_REWRITTEN = (
    (re.compile(r'\bMSG\s*\(\s*"([^"]*)"\s*\)', re.IGNORECASE), r"(MSG, \1)"),
    (re.compile(r"\bMSG\s*\(\s*\)", re.IGNORECASE), ""),
    (re.compile(r'\bT[1-9]?\s*=\s*"([^"]*)"', re.IGNORECASE), rf"({CALLED_TOOL} \1)"),
    (re.compile(rf"\b([IJK])\s*=\s*AC\s*\(\s*{_VALUE}\s*\)", re.IGNORECASE), r"\1AC=\2"),
    (re.compile(r"\bCYCLE832\s*\([^()]*\)", re.IGNORECASE), ""),
    (
        re.compile(rf"\b([ABC])\s*=\s*(?:DC|AC[PN]?)\s*\(\s*{_VALUE}\s*\)", re.IGNORECASE),
        rf"\1=\2 {TO_ANGLE}=1",
    ),
    (
        re.compile(rf"\b([XYZABC])\s*=\s*(IC|AC)\s*\(\s*{_VALUE}\s*\)", re.IGNORECASE),
        r"\1=\3 \1\2=1",
    ),
    # the blank for the simulation, the main spindle
    (re.compile(r"\b(WORKPIECE\s*\([^()]*\)|SETMS\b(\s*\(\d*\))?)", re.IGNORECASE), ""),
    (re.compile(r"\b(GROUP_BEGIN)\s*\([^()]*\)", re.IGNORECASE), r"\1"),
    (re.compile(r"\bTRAORI\s*\(\s*1?\s*\)", re.IGNORECASE), "TRAORI"),
    (re.compile(r"\bTRAFOOF\s*\(\s*\)", re.IGNORECASE), "TRAFOOF"),
    # the spindle turned to an angle
    (
        re.compile(
            rf"\bSPOSA?\s*(?:\[\s*\d+\s*\]\s*)?=\s*(?:{NUMBER}|(?:AC|IC|DC|AC[PN])\s*\([^()]*\))",
            re.IGNORECASE,
        ),
        "M19",
    ),
    # the first spindle by its number: S1=5000 M1=3 T1=4
    (re.compile(r"(?<![A-Z_])([SMT])[1-9]\s*=\s*(\d+\.?\d*)", re.IGNORECASE), r"\1\2"),
    (re.compile(r"\bG153\b", re.IGNORECASE), "SUPA"),
    # the end of a sub-program that none calls: it is the file's program
    (re.compile(r"\bRET\b(?!\s*[(=])", re.IGNORECASE), "M17"),
    (_SETTINGS, ""),
)
# brackets of Siemens' expressions are round, as comments are
_ROUND = re.compile(
    r"(?:[=+\-*/\[,]|\b(?:A?SIN|A?COS|TAN|ATAN2|SQRT|ABS|ROUND|TRUNC|POT))\s*\(", re.IGNORECASE
)
_PLACE = re.compile(r"=\s*(?:IC|DC|AC[PN]?)\s*\((?!\s*\[)", re.IGNORECASE)
_BEGINS = re.compile(r"[=(]|\b(?:G153|G75|RET)\b", re.IGNORECASE)


def rewritten(raw: str) -> str:
    """A line with these words as the rest of the reader knows them: messages and names of tools as
    comments, absolute centres as one word, fixed points as places of the machine."""
    if not _BEGINS.search(raw):
        return raw
    raw = _bracketed(raw)
    for pattern, text_for_it in _REWRITTEN:
        raw = pattern.sub(text_for_it, raw)
    return _FIXED_POINT.sub(_as_machine_place, raw)


def _bracketed(raw: str) -> str:
    """What stands in AC( ), IC( ) and their like in square brackets."""
    at = 0
    while found := _PLACE.search(raw, at):
        at = found.end()
        close = _closing(raw, at - 1)
        if close < len(raw):
            square = raw[at:close].replace("(", "[").replace(")", "]")
            raw = f"{raw[:at]}[{square}]{raw[close:]}"
    return raw


def _closing(raw: str, opened: int) -> int:
    """Where the bracket at `opened` is closed; the length of the text where it is not."""
    depth = 0
    for at in range(opened, len(raw)):
        depth += {"(": 1, ")": -1}.get(raw[at], 0)
        if depth == 0:
            return at
    return len(raw)


def with_square_brackets(raw: str) -> str:
    """A line of Siemens with the round brackets of its expressions as square ones, so that they are
    told from comments."""
    while found := _ROUND.search(raw):
        opened = found.end() - 1
        close = _closing(raw, opened)
        if close == len(raw):
            break
        raw = f"{raw[:opened]}[{raw[opened + 1 : close]}]{raw[close + 1 :]}"
    return raw


def _as_machine_place(found: re.Match[str]) -> str:
    axes = re.findall(r"[XYZABC]", found[2].upper())
    return f"{found[1]} SUPA {' '.join(f'{axis}0' for axis in axes)}"
