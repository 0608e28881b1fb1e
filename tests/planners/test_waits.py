"""A dwell in the middle of an operation: the arm stands there as long as it takes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl import load_robot
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import check_rapid

PART = """G21 G90
(begin operation: Slot)
G0 X0 Y0 Z0
G1 X20 F1200
G4 P0.35
G1 X20 Y10
(finish operation: Slot)
M2
"""
RATE = 100.0


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dwell")
    (folder / "part.nc").write_text(PART)
    arguments = ["plan", folder / "part.nc", "--out", folder / "out", "--rate", RATE, "--rapid"]
    arguments += ["--work-frame", "950,0,500,0,0,0"]
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    assert done.exit_code == 0, done.output
    return folder / "out"


def test_the_rows_stand_at_the_way_point(planned: Path) -> None:
    rows = np.loadtxt(planned / "trajectory.csv", delimiter=",", skiprows=1)
    q = np.radians(rows[:, 1:7])
    plan = json.loads((planned / "plan.json").read_text())
    kinds = [segment["kind"] for segment in plan["segments"]]
    assert kinds == ["operation", "wait", "operation"]
    wait = plan["segments"][1]
    assert wait["end_s"] - wait["start_s"] == pytest.approx(0.35)
    first, last = (round(RATE * wait[key]) for key in ("start_s", "end_s"))
    assert np.array_equal(q[first : last + 1], np.tile(q[first], (last - first + 1, 1)))
    assert not rows[first : last + 1, 7:13].any()
    place = 1e3 * Model(load_robot("irb2400")).tcp_pose(q[first])[:3, 3]
    assert np.allclose(place, [970, 0, 500], atol=1e-3)
    # nowhere else
    moved = np.abs(np.diff(q, axis=0)).max(axis=1) > 1e-9
    assert moved[1 : first - 1].all()
    assert moved[last + 1 : -1].all()
    assert plan["guaranteed"]
    assert plan["feed"]["programmed_mm"] == pytest.approx(30, abs=0.1)
    dwell = [event for event in plan["events"] if event["kind"] == "dwell"]
    assert [event["at_rest"] for event in dwell] == [True]
    assert dwell[0]["time_s"] == pytest.approx(wait["start_s"], abs=1.5 / RATE)


def test_the_module_waits_once(planned: Path) -> None:
    text = (planned / "program.mod").read_text()
    assert not check_rapid(text)
    assert [line.strip() for line in text.splitlines() if "WaitTime" in line] == [
        "WaitTime 0.3500;"
    ]
