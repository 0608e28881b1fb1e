"""The blocks of a program in Heidenhain's plain language: one behind each number, `~` goes on in
the next line, `;` begins a comment, `* -` names what comes. Some posts, and printed programs, write
the values of a cycle below `CYCL DEF 200` without `~`."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

_NUMBER = re.compile(r"^\s*(/?)\s*(?:\d+(?![\d.,]))?\s*(/?)\s*")
NUMBER = r"[-+]?\s*(?:\d+\.?\d*|\.\d+)"
_HEADING = re.compile(r"^\*\s*-?\s*")
_DEFINES = re.compile(r"^CYCLE?\s+DEF\s*[2-9]\d\d(?![\d.])")
# Q of cycles are those from 200 on
_VALUE = re.compile(r"^(Q(?:[2-9]\d\d|1\d{3}))\s*=\s*(?:[-+]?\s*[\d.]+|Q\d+|[A-Z]+)$")
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


def as_number(text: str) -> float:
    """Of a `NUMBER`: blanks may stand behind its sign."""
    return float(text.replace(" ", ""))


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
        begins = _NUMBER.match(parts[0])
        # a comment that goes on is one in the next line, too
        only_comment = begins is not None and not parts[0][begins.end() :].strip()
        joined = "" if only_comment and len(parts) > 1 else " ".join(parts)
        parts = []
        begins = _NUMBER.match(joined)
        code = joined[begins.end() :].strip() if begins else joined.strip()
        if code:
            skipped = begins is not None and "/" in begins.groups()
            block = Statement(first, _COMMA.sub(".", code.upper()), code, skipped)
            numbered = begins is not None and begins[0].strip(" \t/") != ""
            if found and not numbered and _goes_on(found[-1], block):
                parts_of_it = (f"{found[-1].code} {block.code}", f"{found[-1].text} {block.text}")
                found[-1] = replace(found[-1], code=parts_of_it[0], text=parts_of_it[1])
            else:
                found.append(block)
    return found


def _goes_on(before: Statement, block: Statement) -> bool:
    """Whether a block without a number is a value of the cycle that the one before it defines."""
    value = _VALUE.match(block.code)
    return (
        value is not None
        and _DEFINES.match(before.code) is not None
        and re.search(rf"\b{value[1]}\s*=", before.code) is None
    )
