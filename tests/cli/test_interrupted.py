"""Ctrl-C says what it leaves: nothing, or which files were written until then."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import irb2400

from irb2400_ctrl.planners import Plan

PATH = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n1000,0,900,0,0,1,50\n1000,40,900,0,0,1,50\n"


def stopped(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_an_interrupted_plan_says_that_nothing_was_written_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "path.csv").write_text(PATH)
    monkeypatch.setattr("irb2400_ctrl.planners.plan_path", stopped)
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
    monkeypatch.setattr("irb2400_ctrl.cli.robot_in.Summary", stopped)
    done = irb2400("robot", "new", "--out", "arm.toml", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "irb2400: interrupted; written until then: arm.toml\n"
