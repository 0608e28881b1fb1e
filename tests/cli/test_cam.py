"""`irb2400 path show` and `irb2400 plan` on CAM programs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400

from irb2400_ctrl import load_robot
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import plan_program, read_program
from irb2400_ctrl.planners.toolpath.work_frame import work_frame

PROGRAM = """G21 G90
(begin operation: Face it)
T1 M6
S3000 M3
G0 X0 Y0 Z30
G1 Z0 F1200
G3 X40 Y40 I0 J40
(finish operation: Face it)
(begin operation: Far/away)
T2 M6
G0 X4000 Y0 Z30
G1 X4050
M2
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "part.nc"
    path.write_text(PROGRAM)
    return path


def test_show_prints_operations_and_what_is_not_understood(file: Path) -> None:
    file.write_text(PROGRAM.replace("M2\n", "G41 D1\nM2\n"))
    done = irb2400("path", "show", file, cwd=file.parent)
    assert done.returncode == 0, done.stderr
    assert "part.nc: G-code, 2 operations" in done.stdout
    assert "1: Face it (lines 5 to 7)" in done.stdout
    assert "feed 20 mm/s" in done.stdout
    assert "extent [mm] x 0.000 … 40.000" in done.stdout
    assert "not understood (irb2400 plan refuses the file):" in done.stdout
    assert "line 13: G41 is the offset by the tool's radius" in done.stdout
    refused = irb2400("plan", file, "--out", "out", cwd=file.parent)
    assert refused.returncode == 2
    assert "line 13: G41" in refused.stderr
    assert not (file.parent / "out").exists()


def test_show_as_json(file: Path) -> None:
    done = irb2400("path", "show", file, "--json", cwd=file.parent)
    summary = json.loads(done.stdout)
    assert summary["dialect"] == "G-code"
    first = summary["operations"][0]
    assert first["tool"]["number"] == 1
    assert first["spindle_rpm"] == pytest.approx(3000)
    assert first["cutting_length_mm"] == pytest.approx(30 + 20 * np.pi, rel=1e-3)
    assert first["extent_mm"][1] == pytest.approx([40, 40, 30])


def test_each_operation_into_its_folder(file: Path) -> None:
    done = irb2400(
        "plan", file, "--out", "out", "--work-frame", "900,0,600,0,0,90", "--rate", "50", "--json",
        cwd=file.parent,
    )  # fmt: skip
    # the second operation is out of reach: said, while the first is there
    assert done.returncode == 2
    assert "1 of 2 operations: 2 (Far/away): point 1 is out of reach" in done.stderr
    assert "Traceback" not in done.stderr
    out = file.parent / "out"
    summary = json.loads((out / "program.json").read_text())
    told = json.loads(done.stdout)
    assert told["program"] == summary
    assert "out/01_Face_it/report.html" in told["written"]
    assert [o["planned"] for o in summary["operations"]] == [True, False]
    assert summary["operations"][0]["folder"] == "01_Face_it"
    assert summary["transfers_not_planned"][0]["from"] == 1
    plan = json.loads((out / "01_Face_it" / "plan.json").read_text())
    assert plan["guaranteed"] is True
    # 93 mm at 20 mm/s, 30 of them
    assert plan["duration_s"] > (30 + 20 * np.pi) / 20
    assert (out / "01_Face_it" / "report.html").is_file()


def test_one_operation_into_the_folder_itself(file: Path) -> None:
    done = irb2400(
        "plan", file, "--out", "out", "--operation", "Face it", "--work-frame=900,0,600",
        "--rate", "50", cwd=file.parent,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (file.parent / "out" / "plan.json").is_file()
    assert not (file.parent / "out" / "program.json").exists()
    unknown = irb2400("plan", file, "--out", "out", "--operation", "7", cwd=file.parent)
    assert unknown.returncode == 2
    assert "found 0 operations called '7', expected one" in unknown.stderr


def test_work_frame_turns_about_fixed_axes() -> None:
    X = work_frame("100,-200,300,90,0,90")
    assert np.allclose(X[:3, 3], [0.1, -0.2, 0.3])
    # first about x: z goes to -y; then about z: -y goes to x
    assert np.allclose(X[:3, :3] @ [0, 0, 1], [1, 0, 0])
    assert np.allclose(work_frame((1.0, 2.0, 3.0))[:3, :3], np.eye(3))
    for wrong in ("1,2", "a,b,c", "1,2,3,4", "1,2,nan"):
        with pytest.raises(InputError, match="expected x,y,z,rx,ry,rz in mm and degrees"):
            work_frame(wrong)


def test_a_work_frame_moves_the_plan(file: Path) -> None:
    program = read_program(file)
    frame = work_frame("900,0,600,0,0,90")
    found = plan_program(load_robot("irb2400"), program, work_frame=frame, rate=50.0)
    first = found.operations[0].plan
    assert first is not None
    assert np.allclose(first.path.position[0], [0.9, 0, 0.63])
    assert np.allclose(first.path.position[-1], [0.9 - 0.04, 0.04, 0.6])
    assert len(found.refused) == 1
    assert found.transfers()[0]["distance_mm"] == pytest.approx(
        1e3 * np.linalg.norm(np.array([4.0, 0, 0.03]) - [0.04, 0.04, 0])
    )
