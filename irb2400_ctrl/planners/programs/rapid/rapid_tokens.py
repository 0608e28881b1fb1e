"""RAPID text as tokens: names, numbers, strings and marks; comments are left out."""

from __future__ import annotations

import re
from typing import NamedTuple

from irb2400_ctrl.errors import InputError

LARGEST_TEXT = 64_000_000
"""characters of a module; no controller holds as much"""
_TOKEN = re.compile(
    r"(?P<space>[ \t\r\n]+)|(?P<comment>![^\n]*)"
    r'|(?P<string>"(?:[^"\\\n]|""|\\\\)*")'
    r"|(?P<number>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)|(?P<mark>:=|[\[\](),;%\\])"
)


class RapidSyntaxError(InputError):
    """A text that is not the subset of RAPID that this library writes; knows the line."""

    def __init__(self, line: int, says: str) -> None:
        super().__init__(f"RAPID line {line}: {says}")
        self.line = line
        self.says = says


class Token(NamedTuple):
    """A piece of the text; `kind` is name, number, string, mark or end."""

    kind: str
    text: str
    line: int


def tokens(text: str) -> list[Token]:
    """All tokens, with one of kind `end` after the last.

    Raises:
        RapidSyntaxError: a character that RAPID does not know there, a string without its end, or
        more text than a controller holds.
    """
    if len(text) > LARGEST_TEXT:
        raise RapidSyntaxError(
            1, f"found {len(text):,} characters, expected at most {LARGEST_TEXT:,}; split it"
        )
    found: list[Token] = []
    at = 0
    line = 1
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise RapidSyntaxError(line, _unreadable(text[at]))
        kind = match.lastgroup or ""
        piece = match.group()
        if kind == "space":
            line += piece.count("\n")
        elif kind != "comment":
            found.append(Token(kind, piece, line))
        at = match.end()
    found.append(Token("end", "the end of the text", line))
    return found


def _unreadable(character: str) -> str:
    if character == '"':
        return "a string does not end in its line"
    return f"found the character {character!r}, expected none of that kind outside strings"
