"""Files of an earlier run in `--out` are named: they look like the result of the last command."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import irb2400

PATH = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n1000,0,900,0,0,1,50\n1000,40,900,0,0,1,50\n"
FEW = ("--rate", "50")
STUDY = """
name = "one"
robot = "irb2400"
draws = 1
seed = 1
logs = true
controllers = [{ controller = "gravity_pd" }]

[[motions]]
name = "nod"
poses_deg = [[0, 0, 0, 0, 30, 0], [5, 5, 5, 5, 35, 5]]
speeds = [1.0]
"""


def planned(folder: Path, *more: str) -> str:
    (folder / "path.csv").write_text(PATH)
    done = irb2400("plan", "path.csv", "--out", "out", *FEW, *more, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert ("rotation_map.json" in done.stdout) == ("--map" in more)
    return done.stderr


def test_a_refusal_names_what_an_earlier_run_left(tmp_path: Path) -> None:
    assert "from before" not in planned(tmp_path)
    earlier = (tmp_path / "out" / "plan.json").read_text()
    (tmp_path / "path.csv").write_text(PATH.replace("1000,40", "9000,40"))
    refused = irb2400("plan", "path.csv", "--out", "out", *FEW, cwd=tmp_path)
    assert refused.returncode == 2
    told = "out: from before, and no result of this command: plan.json, report.html, trajectory.csv"
    assert refused.stderr.splitlines()[-1] == told
    assert (tmp_path / "out" / "plan.json").read_text() == earlier


def test_a_result_names_what_it_has_not_replaced(tmp_path: Path) -> None:
    planned(tmp_path, "--map")
    again = planned(tmp_path)
    told = "irb2400: out: from before, and no result of this command: rotation_map.json"
    assert told in again.splitlines()


def test_inputs_and_files_beside_a_single_one_are_nobodys_result(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "path.csv").write_text(PATH)
    for kind in ("balancer", "payload", "balancer"):
        done = irb2400("explain", kind, "--out", ".", cwd=tmp_path)
        assert "from before" not in done.stderr
    refused = irb2400("plan", "path.csv", "--out", ".", "--work-frame", "1,2", cwd=tmp_path)
    assert refused.returncode == 2
    assert "notes.txt" in refused.stderr
    assert "path.csv" not in refused.stderr.splitlines()[-1]


@pytest.mark.slow
def test_a_result_that_is_stopped_names_the_last_plan(tmp_path: Path) -> None:
    """Operations that could not be linked left an earlier trajectory.csv, and nothing told."""
    planned(tmp_path)
    heavy = ("--links", "--start=0,0,0,0,0,0", "--set", "joints.2.limits.torque_Nm=200")
    stopped = irb2400("plan", "path.csv", "--out", "out", *FEW, *heavy, cwd=tmp_path)
    assert "not linked" in stopped.stderr
    assert "from before, and no result of this command: plan.json" in stopped.stderr


def test_logs_of_cases_that_a_study_goes_on_with_are_its_result(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY)
    for _ in range(2):
        done = irb2400("sweep", "study.toml", "--out", "out", "--workers", "1", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "from before" not in done.stderr
    assert (tmp_path / "out" / "logs").is_dir()
