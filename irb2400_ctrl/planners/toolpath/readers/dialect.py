"""Which language a CAM file is in: by its content first, by its suffix where that says nothing."""

from __future__ import annotations

import re
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.looks_like import APT_SUFFIXES, GCODE_SUFFIXES

NX = "NX CLSF"
CREO = "Creo NCL"
CATIA = "CATIA aptsource"
HEIDENHAIN = "Heidenhain"
APT_LINE = re.compile(
    r"^\s*(GOTO|FROM|GODLTA|FEDRAT|CIRCLE|MOVARC|CYCLE|SPINDL|COOLNT|LOADTL|CUTTER|UNITS|PARTNO"
    r"|MULTAX|TOOL PATH|TLDATA|MSYS|PAINT|MACHIN|LOAD|CUTCOM|NURBS|TLON|INTOL|OUTTOL|PPRINT)\s*/",
    re.IGNORECASE | re.MULTILINE,
)
GCODE_LINE = re.compile(
    r"^\s*(?:/[1-9]?)?\s*(?:N\s*\d+\s*)?(?:[GM]\s*\d+(?:\.\d+)?(?=[\sA-Z(;]|$)"
    r"|[XYZ]\s*[-+]?[\d.]+(?=[\sA-Z(;]|$))",
    re.IGNORECASE | re.MULTILINE,
)
PLAIN = re.compile(r"^\s*\d*\s*BEGIN PGM\b", re.IGNORECASE | re.MULTILINE)
# the head of Heidenhain's DIN/ISO, whose G54 X Y, G28 X, G98 L are others than elsewhere
DIN_ISO = re.compile(r"^\s*%\s*\S+\s+G7[01]\b", re.IGNORECASE | re.MULTILINE)
# RAPID, KRL, FANUC's TP, INFORM, URScript
ROBOT_LINE = re.compile(
    r"^\s*(?:MODULE\s+\w|(?:CONST|PERS|VAR)\s+robtarget\b|&ACCESS\b|(?:PTP|LIN|CIRC)\s*\{"
    r"|/PROG\s+\w|//NAME\s+\w|\d+:\s*[JL]\s+P\[|move[jlcp]\s*\()",
    re.IGNORECASE | re.MULTILINE,
)
CSV_COLUMNS = re.compile(r'(^|,)\s*"?[xyz]_?\w*"?\s*(,|$)', re.IGNORECASE)
ROBOTS = "a program of a robot: give the CAM file it was made from"
DRAWING = "a drawing or a shape without tool paths: let a CAM system make them"
OTHERS = {
    **dict.fromkeys((".mod", ".prg", ".src", ".ls", ".tp", ".script", ".urp", ".jbi"), ROBOTS),
    **dict.fromkeys((".step", ".stp", ".igs", ".iges", ".stl", ".3mf", ".dxf", ".dwg"), DRAWING),
    ".sbp": "ShopBot's language: let the CAM system write G-code",
    ".plt": "a plotter's HPGL: let the CAM system write G-code",
    ".hpgl": "a plotter's HPGL: let the CAM system write G-code",
    ".drl": "drill places of a circuit board (Excellon): let pcb2gcode write G-code",
    ".xln": "drill places of a circuit board (Excellon): let pcb2gcode write G-code",
    ".gbr": "layers of a circuit board (Gerber): let pcb2gcode write G-code",
}
"""by suffix, what is not read, and what to give"""
LISTED = ".csv, " + ", ".join((*APT_SUFFIXES[:5], ".ncl", ".nc", ".ngc", ".gcode", ".h"))


def dialect(text: str, path: Path) -> str:
    """ "CSV", "G-code", "Heidenhain", "NX CLSF", "Creo NCL", "CATIA aptsource" or "APT".

    Raises:
        InputError: the content is of no known language, or of two.
    """
    # Creo counts versions behind its suffix: part.ncl.8
    suffix = next((s for s in reversed(path.suffixes) if not s[1:].isdecimal()), "").lower()
    if PLAIN.search(text):
        return HEIDENHAIN
    if suffix == ".nci":
        raise InputError(
            f"{path}, line 1: found Mastercam's own NCI, which is not read; "
            "let its post processor write G-code or APT"
        )
    if DIN_ISO.search(text):
        raise InputError(
            f"{path}: found Heidenhain's DIN/ISO (% NAME G71), which is not read; let the post "
            "processor write plain language (.h) or G-code for another control"
        )
    if suffix in {".drl", ".xln", ".gbr"}:
        raise InputError(f"{path}: found {OTHERS[suffix]}")
    if _is_csv(text):
        return "CSV"
    apt = len(APT_LINE.findall(text))
    gcode = len(GCODE_LINE.findall(_without_comments(text)))
    if apt and gcode and min(apt, gcode) > 0.2 * max(apt, gcode):
        raise InputError(
            f"{path}: found {apt} lines of APT and {gcode} of G-code, expected one language; split "
            "the file"
        )
    if apt > gcode:
        return _apt_dialect(text)
    if gcode:
        return "G-code"
    if suffix == ".csv":
        return "CSV"
    if ROBOT_LINE.search(text):
        raise InputError(f"{path}: found {ROBOTS}")
    if suffix in APT_SUFFIXES:
        return _apt_dialect(text)
    if suffix in GCODE_SUFFIXES:
        return "G-code"
    known = f"; found {OTHERS[suffix]}" if suffix in OTHERS else ""
    raise InputError(
        f"{path}: unknown kind {suffix!r}, expected one of {LISTED}, or such content{known}"
    )


def _apt_dialect(text: str) -> str:
    if re.search(r"^\s*(TOOL PATH|END-OF-PATH|TLDATA\s*/|MSYS\s*/)", text, re.MULTILINE | re.I):
        return NX
    if re.search(r"^\s*\$\$\s*(->|\*\s*Pro/CLfile)", text, re.MULTILINE | re.IGNORECASE):
        return CREO
    if re.search(r"^\s*\$\$.*CATIA", text, re.MULTILINE | re.IGNORECASE):
        return CATIA
    return "APT"


def _is_csv(text: str) -> bool:
    """Whether the first line that is no comment is a header with columns of coordinates; a comment
    of another language, such as (size x, y, z), is none."""
    for line in text.split("\n"):
        if line.strip() and not line.startswith("#"):
            other = line.lstrip().startswith(("(", ";", "%", "$"))
            return (
                not other
                and "," in line
                and "/" not in line
                and CSV_COLUMNS.search(line) is not None
            )
    return False


def _without_comments(text: str) -> str:
    return re.sub(r"\([^)\n]*\)|;[^\n]*", "", text)
