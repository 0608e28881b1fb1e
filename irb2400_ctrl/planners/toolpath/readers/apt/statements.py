"""The statements of APT-like files: continuation, comments, words and numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError, WordError

COMMENT = "$$"
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([EeDd][-+]?\d+)?$")
# two commands in one statement: RAPID,GOTO/0,0,30
RAPID_WITH = re.compile(r"RAPID\s*,\s*(?=[A-Za-z])", re.IGNORECASE)
# the rest of such a line is text for people, with or without a slash before it
TEXT_WORDS = ("PARTNO", "PPRINT", "TPRINT", "INSERT", "REMARK", "TITLES", "TITLE", "LETTER", "NOTE")
# a price in dollars at the end of a text continues nothing: the next line is a statement of its own
OWN_LINE = re.compile(
    r"(GOTO|FROM|GODLTA|RAPID|FEDRAT|CIRCLE|MOVARC|INDIRV|TLON|CYCLE|LOADTL|SPINDL|COOLNT)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Statement:
    """`WORD/argument,argument,…` of one or more lines, or a comment (`word` is "$$")."""

    line: int
    word: str
    """capital letters; "" for a line of bare numbers"""
    arguments: tuple[str, ...]
    """as written, without blanks around them"""
    text: str
    """all after the word"""

    @property
    def words(self) -> list[str]:
        """The arguments in capital letters."""
        return [argument.upper() for argument in self.arguments]

    def numbers(self) -> list[float]:
        """All arguments as numbers; InputError names the one that is none."""
        return [number(argument, self.word) for argument in self.arguments]


def number(text: str, word: str) -> float:
    """A finite number behind a word; Fortran's D exponents too."""
    try:
        value = float(text.upper().replace("D", "E"))
    except ValueError:
        raise WordError(word, f"found {text.upper()!r}, expected a number") from None
    if not math.isfinite(value):
        raise WordError(word, f"found {text.upper()}, expected a finite number")
    return value


def is_number(text: str) -> bool:
    """Whether an argument is a number."""
    return NUMBER.match(text) is not None


def statements(text: str) -> Iterator[Statement | UnreadLineError]:
    """All statements and comments; `$` at the end of a line continues it, in Creo's comments too.

    A line without a word and a statement that the file cuts off come as their errors.
    """
    pending = ""
    start = 0
    for line, raw in enumerate(text.split("\n"), 1):
        part = raw.strip()
        if pending and not part:
            continue
        if pending.upper().startswith(TEXT_WORDS) and OWN_LINE.match(part):
            yield _statement(start, f"{pending.strip()}$")
            pending = ""
        start = start if pending else line
        commented = (pending or part).startswith(COMMENT)
        if not commented:
            part = part.split(COMMENT)[0].strip()
        # Creo continues what it says in comments; others end a sentence with $ by chance
        continues = not commented or (pending or part).startswith("$$->")
        if continues and part.endswith("$") and not part.endswith(COMMENT):
            pending += part[:-1].strip() + " "
            continue
        joined = (pending + part).strip()
        pending = ""
        if joined:
            rapid = RAPID_WITH.match(joined)
            if rapid:
                yield Statement(start, "RAPID", (), "")
                joined = joined[rapid.end() :]
            try:
                yield _statement(start, joined)
            except InputError as error:
                yield UnreadLineError(start, str(error))
    if pending:
        yield UnreadLineError(start, "the statement is continued by $ but the file ends")


def _statement(line: int, text: str) -> Statement:
    if text.startswith(COMMENT):
        return Statement(line, COMMENT, (), text[len(COMMENT) :])
    upper = text.upper()
    for word in TEXT_WORDS:
        if upper.startswith(word) and not upper[len(word) :][:1].isalnum():
            rest = text[len(word) :].strip().removeprefix("/").strip()
            return Statement(line, word, tuple(split_arguments(rest)), rest)
    head, slash, tail = text.partition("/")
    first, *more = [part.strip() for part in head.split(",")]
    if is_number(first) and not slash:
        return Statement(line, "", tuple(split_arguments(text)), text)
    if re.match(r"[A-Za-z]", first) is None:
        raise InputError(f"found {text[:40]!r}, expected an APT statement such as GOTO/")
    word = re.sub(r"\s+", " ", first).upper()
    arguments = tuple(part for part in more if part) + tuple(split_arguments(tail))
    return Statement(line, word, arguments, tail.strip())


def split_arguments(text: str) -> list[str]:
    """Arguments between commas; commas within brackets do not separate. A last empty one counts
    not."""
    parts = [""]
    depth = 0
    for character in text:
        depth += (character == "(") - (character == ")")
        if character == "," and depth <= 0:
            parts.append("")
        else:
            parts[-1] += character
    parts = [part.strip() for part in parts]
    return parts[:-1] if not parts[-1] else parts
