"""A positioner of a cell file, 3+2: the part turns with it, each operation at its own angles."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, load_cell
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import plan_path, read_program
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.programs.rapid import check_rapid, load_rapid

Array = npt.NDArray[np.float64]
ROBOT = load_robot("irb2400")
# a block with a cut on its top and one on its side, which faces x of the part
PART = """$$ two sides
PARTNO/BLOCK
UNITS/MM
LOADTL/1
$$ OPERATION NAME : TOP
RAPID
GOTO/0,0,20,0,0,1
FEDRAT/1200,MMPM
GOTO/0,0,0,0,0,1
GOTO/30,0,0,0,0,1
$$ OPERATION NAME : SIDE
RAPID
GOTO/70,0,-30,1,0,0
FEDRAT/1200,MMPM
GOTO/50,0,-30,1,0,0
GOTO/50,20,-30,1,0,0
FINI
"""
CELL = """schema_version = 1
name = "tilting table"
[work_object]
place_mm = [900, 0, 500]
[positioner]
tilt = { direction = [0, 1, 0], point_mm = [900, 0, 400], range_deg = [-100, 100] }
turn = { direction = [0, 0, 1], point_mm = [900, 0, 0], range_deg = [-180, 180] }
%s
[[things]]
name = "block"
role = "part"
frame = "work_object"
shapes = [{ kind = "box", centre_mm = [0, 0, -40], size_mm = [90, 90, 70] }]
"""


def cell(tmp_path: Path, rows: str = "") -> Cell:
    file = tmp_path / "cell.toml"
    file.write_text(CELL % rows)
    return load_cell(file)


def test_the_work_object_turns_about_the_axes_in_their_order(tmp_path: Path) -> None:
    found = cell(tmp_path, "position_deg = [-90, 30]").work_frame
    R = Rotation.from_euler("y", -90, degrees=True).as_matrix()
    R = R @ Rotation.from_euler("z", 30, degrees=True).as_matrix()
    assert found is not None
    assert np.allclose(found[:3, :3], R)
    # 100 mm above the tilting axis: swung to -x
    assert np.allclose(found[:3, 3], [0.8, 0.0, 0.4])
    things = cell(tmp_path, "position_deg = [-90, 0]")
    assert np.allclose(things.on_positioner((0, 0)).work_frame, cell(tmp_path).work_frame)


def test_the_table_of_the_page_is_read(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "cells.md").read_text()
    table = page[page.index("[positioner]") :].split("```")[0]
    head = 'schema_version = 1\nname = "page"\n[work_object]\nplace_mm = [900, 0, 500]\n'
    (tmp_path / "page.toml").write_text(head + table)
    plate = load_cell(tmp_path / "page.toml").positioner
    assert plate is not None
    assert plate.asked(2, "SIDE") == (-90, 0)
    assert plate.asked(1, "TOP") == "find"


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ("position_deg = [120, 0]", "tilt at 120.00 deg, range -100 to 100"),
        ("operations = { TOP = [0, 200] }", "turn at 200.00 deg"),
        ('position_deg = "seek"', "position_deg"),
    ],
)
def test_angles_outside_the_ranges_are_refused(tmp_path: Path, rows: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        cell(tmp_path, rows)
    assert says in str(caught.value)


def test_angles_are_found_or_stated_for_each_operation(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text(PART)
    top, side = read_program(file).operations
    around = cell(tmp_path, 'position_deg = "find"')
    asked = PlanOptions(cell=around)
    found = [asked.for_operation(o, ROBOT).cell for o in (top, side)]
    assert found[0].positioner_deg == (0, 0)
    # the axis that points to x in the part stands upright
    up = found[1].work_frame[:3, :3] @ [1, 0, 0]
    assert np.allclose(up, [0, 0, 1], atol=1e-4)
    stated = cell(tmp_path, "operations = { SIDE = [-45, 10] }")
    angles = [PlanOptions(cell=stated).for_operation(o, ROBOT).positioner for o in (top, side)]
    assert angles == [(0, 0), (-45, 10)]
    with pytest.raises(InputError, match="answered for each operation"):
        plan_path(ROBOT, top.path, cell=around)


def test_upright_is_against_gravity(tmp_path: Path) -> None:
    """Below an arm that hangs, whose base frame is upside down, the side is turned up as well."""
    file = tmp_path / "part.apt"
    file.write_text(PART)
    side = read_program(file).operations[1]
    hung = ROBOT.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    options = PlanOptions(cell=cell(tmp_path, 'position_deg = "find"'))
    up = options.for_operation(side, hung).frame[:3, :3] @ [1, 0, 0]
    assert np.allclose(up, [0, 0, -1], atol=1e-4)


@pytest.mark.slow
def test_two_sides_in_one_motion(tmp_path: Path) -> None:
    cell(tmp_path, "position_deg = [0, 0]")
    (tmp_path / "part.apt").write_text(PART)
    arguments = ["plan", tmp_path / "part.apt", "--out", tmp_path / "out", "--rate", "100"]
    arguments += ["--cell", tmp_path / "cell.toml", "--positioner", "find", "--rapid"]
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    assert done.exit_code == 0, done.output
    planned = json.loads((tmp_path / "out" / "plan.json").read_text())
    by_operation = {s["operation"]: s["positioner_deg"] for s in planned["segments"]}
    assert by_operation[1] == [0, 0]
    assert by_operation[2][0] == pytest.approx(-90)
    turned = [e for e in planned["events"] if e["kind"] == "positioner"]
    assert [e["at_rest"] for e in turned] == [True, True]
    rows = np.loadtxt(tmp_path / "out" / "trajectory.csv", delimiter=",", skiprows=1)
    k = round(100 * turned[1]["time_s"])
    # the arm is at home while the part turns
    assert np.allclose(rows[k, 1:7], 0, atol=1e-9)
    side = [s for s in planned["segments"] if s["kind"] == "operation"][1]
    last = np.radians(rows[round(100 * side["end_s"]), 1:7])
    X_BW = load_cell(tmp_path / "cell.toml").on_positioner(tuple(by_operation[2])).work_frame
    assert X_BW is not None
    tip = np.linalg.inv(X_BW) @ Model(ROBOT).tcp_pose(last)
    assert np.allclose(1e3 * tip[:3, 3], [50, 20, -30], atol=0.05)
    module = tmp_path / "out" / "program.mod"
    text = module.read_text()
    assert not check_rapid(text)
    assert "[0,0,9E9" in text
    assert "[-90,0,9E9" in text
    assert text.count("e,vApproach,fine") == 1
    read = load_rapid(module).joint_angles(Model(ROBOT))
    assert np.isfinite(read).all()
