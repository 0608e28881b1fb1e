"""What a table is, where another kind was expected: the column names say it."""

from __future__ import annotations

import re
from collections.abc import Collection

_KINDS = (
    (r"(x|y|z)_(mm|m|in)", 3, "a tool path: `irb2400 plan` makes a motion of it"),
    (
        r"(q|qd|qdd|tau)\d+_\w+",
        6,
        "a motion or a log: `irb2400 simulate`, `irb2400 diagnose` take it",
    ),
)


def looks_like(header: Collection[str]) -> str:
    """The end of a message: `; these are the columns of a tool path: …`; empty where nothing is
    known."""
    for pattern, least, words in _KINDS:
        if sum(bool(re.fullmatch(pattern, name.strip())) for name in header) >= least:
            return f"; these are the columns of {words}"
    return ""
