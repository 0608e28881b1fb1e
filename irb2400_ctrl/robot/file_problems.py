"""What is wrong with a file of tables, one line per problem."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

from irb2400_ctrl.wording import did_you_mean

# pydantic puts the tag of a union into the path; a file has no such key
_TAGS = {"ModifiedDH", "Transform", "capsule", "cylinder", "sphere", "box", "mesh"}


def explain(
    source: str, what: str, error: ValidationError, tables: Sequence[type[BaseModel]]
) -> str:
    """One line per problem: where, what was found, what was expected.

    Args:
        source: the file.
        what: the kind of file, "robot" or "cell".
        error: of pydantic.
        tables: all tables of such a file, for the key that may have been meant.
    """
    lines = []
    items = error.errors()
    for item in items:
        depth = len(item["loc"])
        inside = (other for other in items if other is not item)
        if item["type"] == "too_short" and any(o["loc"][:depth] == item["loc"] for o in inside):
            # the entries are there, with problems of their own
            continue
        parts = [part for part in item["loc"] if part not in _TAGS]
        place = "".join(
            f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in parts
        ).lstrip(".")
        if item["type"] == "extra_forbidden":
            keys = sorted({key for table in tables for key in table.model_fields})
            lines.append(f"{place}: unknown key{did_you_mean(item['loc'][-1], keys)}")
        else:
            value: Any = item["input"]
            found = (
                "" if isinstance(value, dict | list | tuple | BaseModel) else f", found {value!r}"
            )
            lines.append(f"{place or what}: {item['msg'].removeprefix('Value error, ')}{found}")
    return f"{source} is not a valid {what} file:\n  " + "\n  ".join(dict.fromkeys(lines))
