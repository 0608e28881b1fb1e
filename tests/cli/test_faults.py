"""What the command line says when something goes wrong that is not the user's input."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys

import pytest

from irb2400_ctrl import __version__
from irb2400_ctrl.cli import main
from irb2400_ctrl.errors import InputError, IrbError


def told(monkeypatch: pytest.MonkeyPatch, capsys, error: BaseException) -> tuple[int, str]:
    """Exit code and stderr of a command that fails with `error`."""

    def fail() -> None:
        raise error

    monkeypatch.setattr(main, "app", fail)
    with pytest.raises(SystemExit) as stop:
        main.run()
    return int(stop.value.code), capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InputError("q7 found, six expected"), 2, r"^irb2400: q7 found, six expected$"),
        (IrbError("the solver gave up"), 1, r"^irb2400: the solver gave up$"),
        (OSError(errno.ENOSPC, "No space left on device", "out/log.csv"), 1, r"out/log.csv: No sp"),
        (PermissionError(13, "denied", ".x.csv.1", None, "x.csv"), 1, r": x.csv: den.*Excel"),
        (MemoryError(), 1, r"memory of this machine was not enough"),
        (ZeroDivisionError("division by zero"), 1, r"ZeroDivisionError in test_faults.py:\d+"),
    ],
)
def test_every_error_is_one_plain_line(monkeypatch, capsys, error, code, says) -> None:
    found, text = told(monkeypatch, capsys, error)
    assert found == code
    assert re.search(says, text.strip())
    assert "Traceback" not in text
    assert text.count("\n") == 1


def test_a_fault_of_ours_can_be_looked_into(monkeypatch) -> None:
    def fail() -> None:
        raise KeyError("q")

    monkeypatch.setattr(main, "app", fail)
    monkeypatch.setenv(main.TRACEBACK_VARIABLE, "1")
    with pytest.raises(KeyError):
        main.run()


@pytest.mark.parametrize("words", [["explain"], ["schema", "robot"]])
def test_a_reader_that_has_gone_is_no_fault(words) -> None:
    """As `irb2400 explain | head -1`: a little that is flushed at the end, and much."""
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "irb2400_ctrl", *words]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_version_is_said(monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.argv", ["irb2400", "--version"])
    with pytest.raises(SystemExit) as stop:
        main.run()
    assert stop.value.code == 0
    assert capsys.readouterr().out == f"irb2400 {__version__}\n"
