"""Small files from strangers: read up to a stated size, as text, with a limit of their nesting.

A message says where something is wrong, never what stands there: a study or a robot file may name
any file of this machine, and what it holds is nobody else's business.
"""

from __future__ import annotations

import codecs
import re
import tomllib
from pathlib import Path
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.looks_like import looks_like
from irb2400_ctrl.reading.stand_in import refuse_stand_in

MOST_BYTES = 10_000_000
"""of a file that people write by hand"""
DEEPEST = 50
"""names in one dotted key"""
_WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_NAME = r"[\w\-\"']+"
_DEEP_KEY = re.compile(rf"[\s\[]*{_NAME}(?:[ \t]*\.[ \t]*{_NAME}){{{DEEPEST},}}")

_HALF_A_NUMBER = re.compile(r"^[^#'\"\n]*[=\[,][ \t]*[+-]?(?:\.\d|\d+\.(?!\d))", re.MULTILINE)

# what is said of "C:\Users", where a backslash begins a character that is written otherwise
_OF_A_BACKSLASH = ("Unescaped", "Invalid hex")
_HINT = "write a path with /, or in single quotes: 'C:\\arm.toml'"
# and what is left of "C:\temp" and "logs\new.csv", where it begins one that can be read
_TURNED = r"\x08\t\n\f\r"
_BROKEN_PATH = re.compile(rf"[A-Za-z]:[\\{_TURNED}].*|[^ ]*\.\w{{1,8}}", re.DOTALL)


def bounded_text(path: Path, what: str, most: int = MOST_BYTES) -> str:
    """The text of a file in UTF-8, its mark left out.

    Args:
        what: the kind of file that is expected, for messages ("a robot file (TOML)").
        most: bytes.

    Raises:
        InputError: cannot be read, larger, or not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise InputError(
            f"{path} cannot be read ({error.strerror or error}), expected {what}"
        ) from error
    refuse_stand_in(path)
    if len(data) > most:
        raise InputError(f"{path} has more than {most / 1e6:g} MB, expected {what}")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = "UTF-16" if data.startswith(_WIDE) else f"no UTF-8 at byte {error.start}"
        raise InputError(f"{path}: found {found}, expected {what} in UTF-8; save it so") from error


def toml_tables(text: str, source: str, what: str) -> dict[str, Any]:
    """The tables of a TOML text.

    Args:
        text: what is read.
        source: what to call it in messages.
        what: what it is to be, such as `a robot file (TOML)`.

    Raises:
        InputError: not TOML, nested without end, numbers of thousands of digits, or a path whose
            backslashes are no longer there.
    """
    for number, line in enumerate(text.splitlines(), 1):
        if _DEEP_KEY.match(line):
            raise InputError(
                f"{source} is not a file of this kind: line {number} has a key of more than "
                f"{DEEPEST} names"
            )
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        slash = str(error).startswith(_OF_A_BACKSLASH)
        hint = f"; {_HINT}" if slash else ""
        if _HALF_A_NUMBER.search(text):
            hint = "; a number has digits on both sides of its point: 0.1 and 122.0"
        other = looks_like(text.partition("\n")[0].split(","), "")
        raise InputError(f"{source} is not TOML, expected {what}: {error}{hint}{other}") from error
    except RecursionError as error:
        raise InputError(f"{source} is not a file of this kind: nested without end") from error
    except ValueError as error:
        raise InputError(f"{source} is not a file of this kind: {error}") from error
    if broken := _broken_path(tables):
        raise InputError(
            f"{source}: {broken} looks like a path, with a tab or a new line in it, which \\t, "
            f"\\n, \\b, \\f and \\r are in double quotes; {_HINT}"
        )
    return tables


def _broken_path(value: object, place: str = "") -> str:
    """The key of the first path that has lost a backslash; empty where there is none."""
    if isinstance(value, str):
        lost = re.search(f"[{_TURNED}]", value) and _BROKEN_PATH.fullmatch(value)
        return place if lost else ""
    inside: list[tuple[str, object]] = []
    if isinstance(value, dict):
        inside = [(f"{place}.{key}".lstrip("."), item) for key, item in value.items()]
    elif isinstance(value, list):
        inside = [(f"{place}[{number}]", item) for number, item in enumerate(value, 1)]
    return next((found for where, item in inside if (found := _broken_path(item, where))), "")
