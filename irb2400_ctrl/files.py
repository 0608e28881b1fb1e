"""Writing files so that a reader never sees half of one."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


def write_atomic(path: Path | str, content: str | bytes | Iterator[str]) -> Path:
    """Write `content` under a temporary name in the same folder, bring it to the disk, then move
    it to `path`; a long text as its parts, which are not in memory all at once.

    Missing parent folders are made; a byte of a file's name that is no UTF-8 becomes a question
    mark. Returns the path.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    parts = iter([content]) if isinstance(content, str | bytes) else content
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            for part in parts:
                file.write(part if isinstance(part, bytes) else part.encode(errors="replace"))
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes private files; results are meant to be read by others too
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path


def write_json(path: Path | str, content: Mapping[str, Any]) -> Path:
    """Write one JSON object as `write_atomic` does; a number that is not finite is null."""
    return write_atomic(path, json.dumps(plain(content), indent=2, allow_nan=False) + "\n")


def plain(value: Any) -> Any:
    """The value of JSON's own types; arrays and numbers of numpy know themselves how."""
    if isinstance(value, Mapping):
        return {str(key): plain(member) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [plain(member) for member in value]
    if isinstance(value, str | bool | int) or value is None:
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    return str(value)


def flush_to_disk(path: Path) -> None:
    """Wait until the content of a file is on the disk, so that it survives a loss of power."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())
