"""docs/cam.md: its file, its commands and its script do what it says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import answered, fenced, script

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "cam.md").read_text()


def block(language: str) -> str:
    return fenced(PAGE, language)[0]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "part.cls").write_text(block("text"))
    return tmp_path


@pytest.mark.slow
def test_commands(folder: Path) -> None:
    for line in block("sh").strip().split("\n"):
        done = answered(line, folder)
        assert done.returncode == 0, (line, done.stderr)
    program = json.loads((folder / "plan" / "program.json").read_text())
    assert [o["folder"] for o in program["operations"]] == ["01_CONTOUR", "02_HOLES"]
    for name in ("plan/01_CONTOUR", "plan/02_HOLES", "holes"):
        plan = json.loads((folder / name / "plan.json").read_text())
        assert plan["guaranteed"] is True
        assert plan["max_feed_ratio"] <= 1 + 1e-9
        assert (folder / name / "trajectory.csv").is_file()


def test_script(folder: Path) -> None:
    lines = script(block("python"), folder).splitlines()
    assert lines[0].startswith("1 CONTOUR Tool(number=1, name='MILL_10'")
    assert lines[1].startswith("2 HOLES")
    assert "no UNITS/" in lines[2]
