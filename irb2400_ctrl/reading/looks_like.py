"""What a table is, where another kind was expected: the column names say it."""

from __future__ import annotations

import re
from collections.abc import Collection

APT_SUFFIXES = (".apt", ".aptsource", ".cls", ".clsf", ".cl", ".cldata", ".cld", ".ncl")
GCODE_SUFFIXES = (".nc", ".ngc", ".gcode", ".gc", ".tap", ".cnc", ".mpf", ".iso", ".eia", ".din")
CAM_SUFFIXES = (*APT_SUFFIXES, *GCODE_SUFFIXES, ".h")

_KINDS = {
    "path": (r"(x|y|z)_(mm|m|in)", 3, "a tool path: `irb2400 plan` makes a motion of it"),
    "motion": (
        r"(q|qd|qdd|tau)\d+_\w+",
        6,
        "a motion or a log: `irb2400 simulate`, `irb2400 diagnose` take it",
    ),
}


def looks_like(header: Collection[str], expected: str) -> str:
    """The end of a message: `; these are the columns of a tool path: …`; empty where nothing is
    known, or it is what was expected: `path` or `motion` (a log as well)."""
    for kind, (pattern, least, words) in _KINDS.items():
        found = sum(bool(re.fullmatch(pattern, name.strip())) for name in header)
        if kind != expected and found >= least:
            return f"; these are the columns of {words}"
    return ""
