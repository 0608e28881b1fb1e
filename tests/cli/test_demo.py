"""The main job and the commands, on the data that comes with the package: files, contracts, sane
numbers."""

from __future__ import annotations

import csv
import json
import os
import re
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.demo import _next_words
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.trajectory import load_trajectory

DATA = Path(str(resources.files("irb2400_ctrl") / "data"))


def run(*arguments: object) -> str:
    done = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    out = tmp_path_factory.mktemp("demo")
    return out, run("demo", "--out", out)


def test_demo_prints_a_small_table_and_the_report(demo: tuple[Path, str]) -> None:
    out, text = demo
    assert len(text.strip().splitlines()) <= 20
    assert text.strip().splitlines()[-1] == f"report: {out / 'report.html'}"


def test_the_readme_shows_what_is_printed(demo: tuple[Path, str]) -> None:
    """Word for word; a number may differ by a hundredth, as other machines round otherwise, and the
    errors of the loop, where joints stick and slip, by a twentieth: the last bits of exp, which
    differ between processors, move the least of them by 2 %."""
    readme = (Path(__file__).parents[2] / "README.md").read_text()
    (shown,) = re.findall(r"```text\n(plan .*?)```", readme, re.DOTALL)
    number = re.compile(r"\d+(?:\.\d+(?:e-\d+)?|e-\d+)?")
    printed = demo[1].replace(str(demo[0]), "demo_out").splitlines()
    for line in shown.strip().splitlines():
        alike = [one for one in printed if number.sub("#", one) == number.sub("#", line)]
        values = [list(map(float, number.findall(one))) for one in alike]
        expected = list(map(float, number.findall(line)))
        rel = 0.05 if line.startswith("close") else 0.01
        close = [pytest.approx(expected, rel=rel, abs=1e-11) == found for found in values]
        assert any(close), (line, alike)


def test_the_torque_that_is_told_is_that_of_the_written_rows(demo: tuple[Path, str]) -> None:
    """It was 81 % beside rows of 89.6: a share of the limits was taken off twice."""
    out, text = demo
    motion = load_trajectory(out / "plan" / "trajectory.csv")
    most = 100 * (np.abs(motion.tau) / irb.load_robot("irb2400").tau_max).max()
    (told,) = re.findall(r"torque at most (\S+) %", text)
    # a bound over all instants lies a little above the rows
    assert most <= float(told) <= most + 1.0
    page = (out / "report.html").read_text()
    assert re.findall(r"torque, at most</dt><dd>(\d+) %", page) == [f"{float(told):.0f}"]
    assert re.findall(r"torque, at most</td><td>([^<]*)<", page) == [told]


def test_report_is_one_self_contained_file(demo: tuple[Path, str]) -> None:
    page = (demo[0] / "report.html").read_text()
    assert page.count('<svg class="plot"') >= 30
    assert re.findall(r'(?:src|href)="(?!#|data:)', page) == []
    assert len(page) < 5e6
    start = page[page.index("<main") : page.index("<section")]
    assert "gear_ripple on joint 4" in start
    listed = page[page.index("<nav") : page.index("</nav>")]
    contents = re.findall(r'<a href="#[^>]*>([^<]*)<', listed)
    assert len(contents) == len(set(contents)) > 10


def test_findings_keep_the_contract_and_reach_the_noise_floor(demo: tuple[Path, str]) -> None:
    found = json.loads((demo[0] / "diagnosis" / "findings.json").read_text())
    assert found["verdict"] == "explained"
    (effect,) = found["effects"]
    assert (effect["kind"], effect["joint"]) == ("gear_ripple", 4)
    assert {"parameters", "standard_errors", "confidence", "alternatives"} <= set(effect)
    for stage in ("before", "after"):
        for which in ("identification", "validation"):
            metrics = found["error"][which][stage]
            assert set(metrics) == {"mae_Nm", "rmse_Nm", "rmse_over_mean_percent"}
            assert all(len(values) == 6 for values in metrics.values())
    after = np.array(found["error"]["validation"]["after"]["rmse_Nm"])
    before = np.array(found["error"]["validation"]["before"]["rmse_Nm"])
    assert (after <= 1.1 * np.array(found["error"]["noise_floor_Nm"])).all()
    assert after[3] < 0.25 * before[3]
    robot = irb.load_robot(demo[0] / "diagnosis" / "robot.toml")
    assert [e.kind for e in robot.effects] == ["gear_ripple"]


def test_plan_keeps_the_contract(demo: tuple[Path, str]) -> None:
    plan = json.loads((demo[0] / "plan" / "plan.json").read_text())
    assert {
        "duration_s",
        "reachable",
        "max_tcp_deviation_mm",
        "max_tool_axis_deviation_deg",
        "singularity_margin",
        "max_torque_ratio",
        "max_velocity_ratio",
        "guaranteed",
        "wall_time_s",
    } <= set(plan)
    assert plan["guaranteed"] is True
    assert plan["max_torque_ratio"] <= 1.0
    with (demo[0] / "plan" / "trajectory.csv").open() as file:
        header, *rows = csv.reader(file)
    for name in ("time_s", "q1_deg", "qd6_deg_s", "qdd3_deg_s2", "tau2_Nm", "s"):
        assert name in header
    table = np.array(rows, dtype=float)
    assert table[0, 0] == 0.0
    speeds = [
        i for i, name in enumerate(header) if name.startswith("qd") and name.endswith("deg_s")
    ]
    assert np.abs(table[[0, -1]][:, speeds]).max() < 1e-6


def test_better_description_tracks_better(demo: tuple[Path, str]) -> None:
    lines = [line.split() for line in demo[1].splitlines() if line.startswith("close")]
    before, recalibrated, after = (float(words[words.index("mm") - 1]) for words in lines)
    assert after < 0.6 * before
    assert after < 0.6 * recalibrated


def test_commands_hand_on_their_files(demo: tuple[Path, str], tmp_path: Path) -> None:
    trajectory = demo[0] / "plan" / "trajectory.csv"
    robot = demo[0] / "diagnosis" / "robot.toml"
    run(
        "simulate",
        trajectory,
        "--controller",
        "feedforward_pid",
        "--robot",
        robot,
        "--out",
        tmp_path / "run",
    )
    simulation = json.loads((tmp_path / "run" / "simulation.json").read_text())
    assert 0.0 < simulation["tcp_error_mm"]["rms"] < 5.0
    assert "irb2400 simulate" in (tmp_path / "run" / "report.html").read_text()
    run("codegen", "--controller", "gravity_pd", "--robot", robot, "--out", tmp_path / "c")
    assert json.loads((tmp_path / "c" / "verification.json").read_text())["passed"] is True
    run("robot", "show", robot)
    assert "inertia" in run("robot", "check", robot)
    # a simulated log is a log like any other
    assert "verdict:" in run(
        "diagnose", tmp_path / "run" / "log.csv", "--robot", robot, "--out", tmp_path / "found"
    )
    assert (tmp_path / "found" / "report.html").is_file()


def test_diagnose_closes_the_loop_with_generated_code(tmp_path: Path) -> None:
    arm = DATA / "arm" / "identification.csv.gz"
    text = run(
        "diagnose", arm, "--close-loop", "--controller", "computed_torque", "--out", tmp_path
    )
    assert "robot as diagnosed" in text
    runs = json.loads((tmp_path / "closed_loop.json").read_text())
    before, recalibrated, after = (runs[name] for name in ("before", "recalibrated", "after"))
    axis = [r["joint_error_deg"]["rms"][3] for r in (before, recalibrated, after)]
    assert axis[2] < 0.5 * min(axis[:2])
    assert {r["controller"] for r in runs.values()} == {"computed_torque"}
    assert json.loads((tmp_path / "controller" / "verification.json").read_text())["passed"] is True
    # the ripple is in the code: its order is one of the numbers
    (ripple,) = irb.load_robot(tmp_path / "robot.toml").effects
    assert (
        f"R({ripple.parameters()['order']!r})"
        in (tmp_path / "controller" / "computed_torque.c").read_text()
    )
    assert (
        "own simulation: it has the effects exactly as found"
        in (tmp_path / "report.html").read_text()
    )


def test_plan_with_held_orientation(tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    rows = [
        "x_mm,y_mm,z_mm,i,j,k,feed_mm_s",
        *(f"{900 + 2 * k},{-50 + 4 * k},700,0,0,1,200" for k in range(26)),
    ]
    path.write_text("\n".join(rows) + "\n")
    run("plan", path, "--fixed", "--rate", 500, "--rapid", "--out", tmp_path / "plan")
    plan = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert plan["duration_s"] >= 0.9 * 111.8 / 200
    page = (tmp_path / "plan" / "report.html").read_text()
    assert f"irb2400 plan {path} --out {tmp_path / 'plan'} --rate 500.0 --fixed --rapid" in page
    assert (tmp_path / "plan" / "program.mod").read_text().startswith("MODULE")


def test_the_end_says_where_the_command_is_that_no_shell_finds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after `make demo`: in an environment that is not active."""
    folder = tmp_path / ".venv" / "bin"
    folder.mkdir(parents=True)
    name = "irb2400.exe" if os.name == "nt" else "irb2400"
    (folder / name).touch()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "executable", str(folder / "python"))
    monkeypatch.setenv("PATH", "")
    place = os.path.join(".venv", "bin", name)
    assert _next_words() == [f"irb2400 is {place}; try: {place} --help"]
    (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(folder))
    assert _next_words() == []
