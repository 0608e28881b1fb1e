"""docs/from_nothing.md: its commands, one after another, and what it says that they find."""

from __future__ import annotations

import json
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import fenced, irb2400

ROOT = Path(__file__).parents[2]
PAGE = "from_nothing.md"
COMMANDS = [
    line
    for block in fenced((ROOT / "docs" / PAGE).read_text(), "sh")
    for line in block.replace("\\\n", " ").splitlines()
]


def ran(command: str, folder: Path) -> str:
    """What a line of the page prints."""
    program, *words = shlex.split(command)
    if program == "python":
        done = subprocess.run(
            [sys.executable, *words], cwd=folder, capture_output=True, text=True, check=False
        )
    else:
        assert program == "irb2400"
        done = irb2400(*words, cwd=folder)
    assert done.returncode == 0, (command, done.stderr)
    return done.stdout


def findings(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "findings.json").read_text()))


@pytest.mark.slow
def test_from_nothing_to_a_diagnosed_robot(tmp_path: Path) -> None:
    (tmp_path / "examples").mkdir()
    shutil.copytree(ROOT / "examples" / "another_arm", tmp_path / "examples" / "another_arm")
    said = {command: ran(command, tmp_path) for command in COMMANDS}
    identified = next(text for command, text in said.items() if " identify monday" in command)
    assert "the bodies of the file are this arm's" in identified
    heavy = next(text for command, text in said.items() if " identify heavy" in command)
    assert "the bodies of the file are not this arm's: link 2" in heavy

    (load,) = findings(tmp_path / "found")["effects"]
    assert load["kind"] == "payload"
    assert load["list"] == "changed"
    assert load["parameters"]["mass_kg"] == pytest.approx(2.8, rel=0.02)
    assert load["parameters"]["com_m"] == pytest.approx([0.03, 0.0, 0.06], abs=4e-3)
    found = findings(tmp_path / "heavy_found")["effects"]
    assert {(e["kind"], e["joint"]) for e in found} == {("payload", None), ("gear_ripple", 1)}
    tool = next(e for e in found if e["kind"] == "payload")
    assert tool["parameters"]["mass_kg"] == pytest.approx(60.0, rel=0.02)
    ripple = next(e for e in found if e["kind"] == "gear_ripple")
    assert ripple["parameters"]["order"] == pytest.approx(33.0, abs=0.1)

    # the arm on the day after, on another motion, has not changed
    ran("irb2400 diagnose tuesday.csv --reference arm/robot.toml --out same", tmp_path)
    same = findings(tmp_path / "same")
    assert (same["verdict"], same["effects"]) == ("nothing_missing", [])
    assert [number for number in same["numbers"] if number["list"] == "changed"] == []
