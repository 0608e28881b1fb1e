"""Files of an earlier run in `--out` are named: they look like the result of the last command."""

from __future__ import annotations

from pathlib import Path

from command_line import irb2400

PATH = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n1000,0,900,0,0,1,50\n1000,40,900,0,0,1,50\n"
FEW = ("--rate", "50")


def planned(folder: Path, *more: str) -> str:
    (folder / "path.csv").write_text(PATH)
    done = irb2400("plan", "path.csv", "--out", "out", *FEW, *more, cwd=folder)
    assert done.returncode == 0, done.stderr
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
