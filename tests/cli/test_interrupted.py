"""Ctrl-C says what it leaves: nothing, or which files were written until then."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import irb2400
from only_posix import posix_only

from irb2400_ctrl.planners import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions

PATH = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n1000,0,900,0,0,1,50\n1000,40,900,0,0,1,50\n"


def stopped(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_an_interrupted_plan_says_that_nothing_was_written_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "path.csv").write_text(PATH)
    monkeypatch.setattr(PlanOptions, "timed", stopped)
    done = irb2400("plan", "path.csv", "--out", "out", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "irb2400: interrupted; nothing was written\n"
    assert [entry.name for entry in tmp_path.iterdir()] == ["path.csv"]


def test_what_was_written_before_an_interruption_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "path.csv").write_text(PATH)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    whole = Plan.write

    def half(self: Plan, folder: Path) -> None:
        whole(self, folder)
        raise KeyboardInterrupt

    monkeypatch.setattr(Plan, "write", half)
    done = irb2400("plan", "path.csv", "--out", "out", "--rate", "50", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "irb2400: interrupted; written until then: plan.json, trajectory.csv\n"


def test_a_single_file_is_named_as_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irb2400_ctrl.cli.robot_in.wrote", stopped)
    done = irb2400("robot", "new", "--out", "arm.toml", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "irb2400: interrupted; written until then: arm.toml\n"


FORGETS = """
import os
import signal


def add():
    try:
        os.kill(os.getpid(), signal.SIGINT)
        sum(range(200_000))
    except KeyboardInterrupt:
        pass
"""


@posix_only
def test_an_interruption_within_what_forgets_it_is_heard_behind_it(tmp_path: Path) -> None:
    """An operator of CasADi dropped it, and the plan went on."""
    (tmp_path / "forgets.py").write_text(FORGETS)
    code = (
        "import signal, sys, time\n"
        "from irb2400_ctrl.system import interrupt_outside\n"
        "import forgets\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "interrupt_outside('forgets.py') if sys.argv[1:] else None\n"
        "try:\n"
        "    forgets.add()\n"
        "    time.sleep(0.5)\n"
        "    print('went on')\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    for more, says in ((["outside"], "interrupted\n"), ([], "went on\n")):
        command = [sys.executable, "-c", code, *more]
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
        assert done.stdout == says, done.stderr
