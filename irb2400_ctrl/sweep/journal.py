"""The finished cases of a sweep on disk: appended one by one, read back after a crash."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.sweep.cases import CaseOutcome, Row, identity
from irb2400_ctrl.sweep.study import Study, changed_keys
from irb2400_ctrl.system import lock

STUDY = "study.toml"
CASES = "cases.jsonl"
LOGS = "logs"


class Journal:
    """`cases.jsonl` in the folder of a sweep: a line that names the study, then a line per finished
    case.

    One process writes. A line counts once its end is there and it holds a case of the study: a
    crash in the middle of one, or a line that was spoiled later, costs that case only.
    """

    def __init__(self, folder: Path, rows: dict[int, Row], file: Any) -> None:
        self.folder = folder
        self.rows = rows
        self._file = file

    def add(self, outcome: CaseOutcome) -> None:
        """Save a finished case."""
        index = int(outcome.row["case"])
        if outcome.log:
            # before the row: a case that is in the journal has its log
            write_atomic(log_path(self.folder, index), outcome.log)
        self._file.write(json.dumps(outcome.row, allow_nan=False).encode() + b"\n")
        _save(self._file)
        self.rows[index] = outcome.row


def saved_cases(folder: Path) -> int:
    """How many finished cases a folder holds."""
    path = folder / CASES
    return max(0, path.read_bytes().count(b"\n") - 1) if path.is_file() else 0


def log_path(folder: Path, index: int) -> Path:
    """Place of a case's log."""
    return folder / LOGS / f"case_{index:06d}.csv.gz"


@contextmanager
def open_journal(folder: Path, study: Study) -> Iterator[Journal]:
    """The journal of a study in that folder, begun or taken up again.

    Raises:
        InputError: the folder holds another study or another kind of file, or another sweep writes
            to it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / CASES
    copy = folder / STUDY
    with path.open("a+b") as file:
        _lock(file, folder)
        file.seek(0)
        content = file.read()
        lines = content.split(b"\n")
        kept = len(content) - len(lines.pop())
        if lines and _fingerprint(path, lines[0]) != study.fingerprint:
            raise InputError(_other_study(folder, study))
        file.truncate(kept)
        rows = _rows(path, lines[1:], study)
        write_atomic(copy, study.text)
        if not lines:
            file.write(
                json.dumps({"study": study.fingerprint, "cases": study.cases}).encode() + b"\n"
            )
            _save(file)
        yield Journal(folder, rows, file)


def _save(file: Any) -> None:
    """On the disk: neither a crash nor a loss of power takes a finished case."""
    file.flush()
    os.fsync(file.fileno())


def _fingerprint(path: Path, line: bytes) -> str:
    begun = _parsed(line)
    if begun is None or not isinstance(begun.get("study"), str):
        raise InputError(
            f"{path} does not begin with the line of a sweep; expected one that this command "
            "began: choose another folder, or delete that one"
        )
    return str(begun["study"])


def _rows(path: Path, lines: list[bytes], study: Study) -> dict[int, Row]:
    """The finished cases; a line that is not one of this study's cases does not count."""
    rows = {}
    left_out = []
    for number, line in enumerate(lines, 2):
        row = _parsed(line)
        if row is not None and _is_of(study, row):
            rows[row["case"]] = row
        else:
            left_out.append(str(number))
    if left_out:
        more = ", …" if len(left_out) > 5 else ""
        print(
            f"irb2400: {path}: line {', '.join(left_out[:5])}{more} holds no case of this study; "
            "left out, cases that are missing run again",
            file=sys.stderr,
        )
    return rows


def _parsed(line: bytes) -> Row | None:
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None


def _is_of(study: Study, row: Row) -> bool:
    """Whether a row is whole and of a case that the study has."""
    index = row.get("case")
    if type(index) is not int or not 0 <= index < study.cases:
        return False
    known = identity(study, index)
    fixed = set(known) - {"status", "message"}
    plain = all(isinstance(value, str | int | float | None) for value in row.values())
    return plain and "wall_time_s" in row and all(row.get(key) == known[key] for key in fixed)


def _lock(file: Any, folder: Path) -> None:
    # without such locks a second sweep into one folder would only repeat cases
    if not lock(file):
        raise InputError(
            f"{folder}: another sweep is writing there; wait for it or choose another folder"
        )


def _other_study(folder: Path, study: Study) -> str:
    try:
        keys = changed_keys((folder / STUDY).read_text("utf-8"), study.text)
    except (OSError, ValueError):
        keys = []
    what = (
        f"differs in {', '.join(keys)}" if keys else "refers to files or settings that have changed"
    )
    return (
        f"{folder} holds the results of another study: {folder / STUDY} {what}. Results of two "
        "studies do not "
        "belong into one table; choose another folder, or delete that one"
    )
