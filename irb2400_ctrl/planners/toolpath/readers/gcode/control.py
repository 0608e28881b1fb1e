"""Whose control a file of G-code is for, as far as its words or its name say so."""

from __future__ import annotations

import re
from pathlib import PurePath

# brackets within brackets from the inner one on; a line behind // is refused, and no code
_COMMENT = re.compile(r"\([^()\n]*\)|;.*|^[ \t]*//.*", re.MULTILINE)
# X=10, R1=5, T="…", but not #1=5 and #<name>=5 (Fanuc, LinuxCNC); words and codes of 840D
_SIEMENS = re.compile(
    r"[A-Z_]\w*\s*=|\bCYCLE\d|\bMCALL\b|\bTRA(?:ORI|FOOF)\b|\bSUPA\b|\bMSG\b|\bA?TRANS\b"
    r"|^\s*%_N_|\bG(?:500|700|710)\b",
    re.MULTILINE,
)
_SUFFIXES = {".mpf", ".spf"}
_LINUXCNC = re.compile(
    r"^\s*O\s*(?:<|\d+\s*(?:SUB|CALL|IF|WHILE|DO|REPEAT)\b)|#\s*<_", re.MULTILINE
)


def without_comments(text: str) -> str:
    """The code of a file in capitals, line by line as in the file."""
    code = text.upper()
    count = 1
    while count:
        code, count = _COMMENT.subn("", code)
    return code


def is_siemens(text: str, name: str) -> bool:
    """Whether only a control of Siemens reads such words, or the file is named as one of its
    programs."""
    suffix = PurePath(name).suffix.lower()
    return suffix in _SUFFIXES or _SIEMENS.search(without_comments(text)) is not None


def is_linuxcnc(text: str, name: str) -> bool:
    """Whether only LinuxCNC reads such words, or the file is named as one of its programs."""
    named = PurePath(name).suffix.lower() == ".ngc"
    return named or _LINUXCNC.search(without_comments(text)) is not None
