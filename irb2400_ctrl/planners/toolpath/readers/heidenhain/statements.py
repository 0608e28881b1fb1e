"""The blocks of a program in Heidenhain's plain language: one behind each number, `~` goes on in
the next line, `;` begins a comment, `* -` names what comes."""

from __future__ import annotations

import re
from dataclasses import dataclass

_NUMBER = re.compile(r"^\s*(/?)\s*(?:\d+(?![\d.,]))?\s*(/?)\s*")
_HEADING = re.compile(r"^\*\s*-?\s*")
_COMMA = re.compile(r"(?<=\d),(?=\d)")


@dataclass(frozen=True)
class Statement:
    """One block."""

    line: int
    code: str
    """upper case, decimal points, without number and comment"""
    text: str
    """as written, without number and comment"""
    optional: bool = False
    """behind a / : skipped when the operator wants it"""

    @property
    def heading(self) -> str | None:
        """The name behind `* -`; None where it is another block."""
        found = _HEADING.match(self.text)
        return self.text[found.end() :].strip() if found else None


def statements(text: str) -> list[Statement]:
    """All blocks that hold anything."""
    found: list[Statement] = []
    parts: list[str] = []
    first = 0
    for line, raw in enumerate(text.split("\n"), 1):
        goes_on = raw.rstrip().endswith("~")
        first = first if parts else line
        parts.append(raw.rstrip().removesuffix("~").split(";")[0])
        if goes_on:
            continue
        number = _NUMBER.match(parts[0])
        # a comment that goes on is one in the next line, too
        only_comment = number is not None and not parts[0][number.end() :].strip()
        joined = "" if only_comment and len(parts) > 1 else " ".join(parts)
        parts = []
        number = _NUMBER.match(joined)
        code = joined[number.end() :].strip() if number else joined.strip()
        if code:
            skipped = number is not None and "/" in number.groups()
            found.append(Statement(first, _COMMA.sub(".", code.upper()), code, skipped))
    return found
