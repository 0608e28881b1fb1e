"""docs/cam_to_robot.md: its files, its commands and its scripts do what it says."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
from command_line import answered, fenced, script

from irb2400_ctrl.trajectory import load_trajectory

PAGE = (Path(__file__).parents[2] / "docs" / "cam_to_robot.md").read_text()


def blocks(language: str) -> list[str]:
    return fenced(PAGE, language)


def said(done: subprocess.CompletedProcess[str]) -> str:
    assert done.returncode == 0, (done.args, done.stderr)
    return done.stdout


def commands(text: str, folder: Path) -> str:
    lines = text.strip().split("\n")
    return "".join(said(answered(line, folder)) for line in lines)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "part.nc").write_text(blocks("text")[0])
    return tmp_path


@pytest.mark.slow
def test_a_program_becomes_one_motion(folder: Path) -> None:
    told = commands(blocks("sh")[0], folder)
    plan = json.loads((folder / "plan" / "plan.json").read_text())
    assert plan["guaranteed"] is True
    assert plan["max_feed_ratio"] <= 1 + 1e-9
    assert plan["clearance_plane"]["clearance_mm"] == pytest.approx(40)
    table = PAGE[PAGE.index("| segment | moves |") :]
    named = set(re.findall(r"^\| `([a-z-]+)` \| (?:joints|tool)", table, re.MULTILINE))
    kinds = {segment["kind"] for segment in plan["segments"]}
    assert kinds == named - {"unwind"}
    keys = PAGE[PAGE.index("| `segments` |") : PAGE.index("| `events` |")]
    for segment in plan["segments"]:
        assert all(f"`{key}`" in keys for key in segment), segment
    events = {(e["kind"], e["at_rest"]) for e in plan["events"]}
    assert ("stop", True) in events
    assert ("tool", True) in events
    motion = load_trajectory(folder / "plan" / "trajectory.csv")
    assert motion.duration == pytest.approx(plan["segments"][-1]["end_s"], abs=1e-6)
    program = json.loads((folder / "plan" / "program.json").read_text())
    for operation in program["operations"]:
        assert (folder / "plan" / operation["folder"] / "trajectory.csv").is_file()
    assert "programmed feed held on" in told
    assert (folder / "sim" / "log.csv").is_file()


@pytest.mark.slow
def test_the_script_prints_segments_and_events(folder: Path) -> None:
    told = script(blocks("python")[0], folder).splitlines()
    assert told[0].startswith("  0.000 s approach 1 True")
    assert any(" stop " in line for line in told)
    assert told[-1].startswith("True ")


@pytest.mark.slow
def test_the_dome_is_unwound(folder: Path) -> None:
    script(blocks("python")[1], folder)
    told = commands(blocks("sh")[1], folder)
    assert re.search(r"operation 1, \d+\.\d+ s: lifted at point \d+ to turn ", told)
    plan = json.loads((folder / "dome" / "plan.json").read_text())
    assert plan["guaranteed"] is True
    assert plan["segments"][0]["kind"] == "operation"
    assert plan["segments"][-1]["kind"] == "operation"
    unwound = plan["unwindings"]
    assert unwound
    assert re.search(r"axis \d .*range -?\d+ to \d+ deg", unwound[0]["because"])
