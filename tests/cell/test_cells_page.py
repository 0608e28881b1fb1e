"""docs/cells.md: its files, its commands and its script do what it says."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from command_line import answered, fenced, irb2400, script

from irb2400_ctrl import load_robot

pytest.importorskip("coal")
PAGE = (Path(__file__).parents[2] / "docs" / "cells.md").read_text()


def block(language: str, number: int = 0) -> str:
    return fenced(PAGE, language)[number]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "cell.toml").write_text(block("toml"))
    (tmp_path / "part.cls").write_text(block("text"))
    return tmp_path


@pytest.mark.slow
def test_commands(folder: Path) -> None:
    for line in block("sh").strip().split("\n"):
        done = answered(line, folder)
        assert done.returncode == 0, (line, done.stderr)
        assert "clearance: at least" in done.stdout
    for name in ("plan", "deeper"):
        plan = json.loads((folder / name / "plan.json").read_text())
        assert plan["clearance_mm"]["value"] >= 5.0
        assert len(plan["clearance_mm"]["pair"]) == 2
        assert plan["guaranteed"] is True


@pytest.mark.slow
def test_the_part_is_placed(folder: Path) -> None:
    command = shlex.split(block("sh", 1))[1:]
    done = irb2400(*command, cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads((folder / "place" / "placement.json").read_text())
    assert told["found"]["worth"] > told["start"]["worth"]
    assert not told["found"]["continuous"]["refused"]
    # the page's table is that of the program
    for name in told["found"]["margins"]:
        assert f"| `{name}` |" in PAGE


def test_script(folder: Path) -> None:
    assert "'value'" in script(block("python"), folder)


def test_the_table_of_the_arm_is_that_of_the_file() -> None:
    outline = load_robot("irb2400").outline
    assert outline is not None
    rows = re.findall(r"^\| (?:\w|\|).*radius [\d; ]+.*\|$", PAGE, re.MULTILINE)
    table = "\n".join(rows)
    stated = sorted({int(n) for text in re.findall(r"radius ([\d; ]+)", table)
                     for n in text.replace(";", " ").split()})  # fmt: skip
    used = {round(part.shape.radius_mm) for part in outline.parts if part.on != "base"}
    assert stated == sorted(used)
