"""Progress of `irb2400 plan`: stages and how far they are on a terminal, nothing in a pipe."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from only_posix import posix_only

import irb2400_ctrl as irb
from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners.toolpath import builders

COMMAND = (sys.executable, "-m", "irb2400_ctrl.cli.main", "plan")


@pytest.fixture
def toolpath(tmp_path: Path) -> Path:
    path = tmp_path / "line.csv"
    rows = [f"900,{y},500,0,0,1" for y in range(0, 60, 10)]
    path.write_text("\n".join(["x_mm,y_mm,z_mm,i,j,k", *rows]) + "\n", encoding="utf-8")
    return path


def test_long_stages_tell_how_far_they_are() -> None:
    told: list[str] = []
    plan_path(
        irb.load_robot("irb2400"),
        builders.line((0.9, 0, 0.5), (0.9, 0.1, 0.5)),
        progress=told.append,
    )
    shares = [
        int(text.removeprefix("timing: ").removesuffix(" %"))
        for text in told
        if text.startswith("timing: ")
    ]
    assert shares[0] == 0
    assert shares == sorted(set(shares))
    assert shares[-1] < 100
    assert "branch and rotation: 1 way" in told
    assert (
        told.index("curve")
        < told.index("branch and rotation")
        < told.index("timing")
        < told.index("check")
    )


def test_a_pipe_hears_nothing(toolpath: Path, tmp_path: Path) -> None:
    run = subprocess.run(
        [*COMMAND, str(toolpath), "--out", str(tmp_path / "out")], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert "planning" not in run.stdout + run.stderr
    assert "timing:" not in run.stderr


@posix_only
def test_a_terminal_sees_stages(toolpath: Path, tmp_path: Path) -> None:
    import pty

    ours, theirs = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    command = [*COMMAND, str(toolpath), "--out", str(tmp_path / "out")]
    with subprocess.Popen(
        command, stderr=theirs, stdout=subprocess.DEVNULL, env=environment
    ) as process:
        os.close(theirs)
        seen = b""
        while True:
            try:
                chunk = os.read(ours, 4096)
            except OSError:
                break
            if not chunk:
                break
            seen += chunk
    os.close(ours)
    assert process.returncode == 0, seen.decode()
    assert "planning 6 points: " in seen.decode()
