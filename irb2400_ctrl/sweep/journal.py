"""The finished cases of a sweep on disk: appended one by one, read back after a crash."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.sweep.cases import CaseOutcome, Row
from irb2400_ctrl.sweep.study import Study, changed_keys

STUDY = "study.toml"
CASES = "cases.jsonl"
LOGS = "logs"


class Journal:
    """`cases.jsonl` in the folder of a sweep: a line that names the study, then a line per finished
    case.

    One process writes. A line counts once its end is there: a crash in the middle of one costs that
    case only.
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
        self._file.flush()
        self.rows[index] = outcome.row


def log_path(folder: Path, index: int) -> Path:
    """Place of a case's log."""
    return folder / LOGS / f"case_{index:06d}.csv.gz"


@contextmanager
def open_journal(folder: Path, study: Study) -> Iterator[Journal]:
    """The journal of a study in that folder, begun or taken up again.

    Raises:
        InputError: the folder holds another study, or another sweep writes to it.
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
        if lines:
            begun = json.loads(lines[0])
            if begun["study"] != study.fingerprint:
                raise InputError(_other_study(folder, study))
        file.truncate(kept)
        rows = {row["case"]: row for row in map(json.loads, lines[1:])}
        write_atomic(copy, study.text)
        if not lines:
            file.write(
                json.dumps({"study": study.fingerprint, "cases": study.cases}).encode() + b"\n"
            )
            file.flush()
        yield Journal(folder, rows, file)
        os.fsync(file.fileno())


def _lock(file: Any, folder: Path) -> None:
    try:
        import fcntl
    except ImportError:
        # no such lock on this system; a second sweep into one folder would only repeat cases
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        raise InputError(
            f"{folder}: another sweep is writing there; wait for it or choose another folder"
        ) from error


def _other_study(folder: Path, study: Study) -> str:
    try:
        keys = changed_keys((folder / STUDY).read_text(), study.text)
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
