"""Where to put a part: what a place is worth, the search, and what is said of the result."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.cell.piece import cell_pieces
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.planning.margin_lines import planned_margins
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.placement import Area, place, rail_position
from irb2400_ctrl.planners.placement.area import Standing
from irb2400_ctrl.planners.placement.constant_ways import constant_ways
from irb2400_ctrl.planners.placement.outlook import ALIKE, outlook
from irb2400_ctrl.planners.placement.task import task_of
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.singularity_margins import reach_left
from irb2400_ctrl.robot import Transform
from irb2400_ctrl.robot.shape import pose

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
ROWS = ["0,0,0,40,0,0,1", "120,0,0,40,0,0,1", "120,80,0,40,0,0,1", "0,80,10,40,0,0,1"]
STIFF = np.array([1e6, 1e6, 8e5, 2e5, 2e5, 1e5])


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "part.csv"
    path.write_text("\n".join(["x_mm,y_mm,z_mm,feed_mm_s,i,j,k", *ROWS]) + "\n", encoding="utf-8")
    return path


def small(turning: bool = False) -> Area:
    turns = np.zeros(1)
    return Area(np.array([0.9, 0.0, 0.4]), np.array([1.3, 0.3, 0.5]), turns, turning)


def test_reach_left_is_the_way_to_the_stretched_arm() -> None:
    g = MODEL.arm_geometry
    q = np.radians([[0.0, 20.0, 10.0, 0.0, 40.0, 0.0]])
    wrist = np.asarray(MODEL.flange_pose(q[0])) @ np.array([0, 0, -g.d7, 1])
    # axis 2 of the upright arm: beside axis 1, at its height
    axis = np.array([g.a1, 0.0, g.d1])
    distance = np.linalg.norm(wrist[:3] - axis)
    assert reach_left(MODEL, q)[0] == pytest.approx(g.a2 + g.forearm - distance, abs=1e-9)


def test_every_constant_way_reaches_its_poses_inside_the_box(part: Path) -> None:
    task = task_of(ROBOT, read_program(part).operation(), True, None, None).thinned(9, 12)
    X_BW = pose((900, 0, 500))
    X = (X_BW @ task.poses).reshape(-1, 4, 4)
    base = MODEL.inverse_kinematics_branches(X).q.reshape(9, 12, 8, 6)
    ways = constant_ways(MODEL, base)
    assert len(ways.q) > 10
    assert (ways.q > ROBOT.q_min).all()
    assert (ways.q < ROBOT.q_max).all()
    assert np.abs(np.diff(ways.q, axis=1)).max() < np.radians(60)
    at = np.asarray(MODEL.tcp_pose(ways.q.reshape(-1, 6)))[:, :3, 3].reshape(-1, 9, 3)
    assert at == pytest.approx(np.broadcast_to(X[::12, :3, 3], at.shape), abs=1e-9)


def test_a_place_out_of_reach_says_so_and_one_nearer_is_worth_more(part: Path) -> None:
    task = task_of(ROBOT, read_program(part).operation(), True, None, None).thinned(9, 12)
    far = outlook([task], pose((3000, 0, 500)))
    edge = outlook([task], pose((1700, 0, 900)))
    good = outlook([task], pose((950, 0, 500)))
    assert far.refused == "out of reach"
    assert far.rank < edge.rank < good.rank
    assert good.worth > 0.5
    assert set(good.margins) >= {"joint_limits_deg", "torque_left", "clearance_mm", "reach_mm"}


def test_the_found_place_is_better_and_shown_on_the_continuous_path(part: Path) -> None:
    start = pose((1250, 250, 400))
    found = place(ROBOT, [read_program(part)], start=start, area=small())
    assert found.found.rank > found.start.rank
    assert not found.proof.refused
    assert found.proof.margins["clearance_mm"] > 0
    assert found.area.holds((found.found.X_BW @ np.append(found.middle, 1.0))[:3])
    load = CuttingLoad.of(ROBOT, [300.0], STIFF)
    stiff = place(ROBOT, [read_program(part)], start=start, area=small(), load=load)
    assert stiff.proof.deflection is not None
    assert stiff.start_proof.deflection is not None
    assert stiff.proof.deflection < stiff.start_proof.deflection


def test_a_cell_is_kept_clear_and_its_work_object_moves(tmp_path: Path) -> None:
    pytest.importorskip("coal")
    folder = Path(__file__).parents[2] / "examples" / "cell"
    cell = load_cell(folder / "cell.toml")
    program = read_program(folder / "part.cls")
    # the post at (900, 500) is in the way of a part there, the table below one at 400 mm
    task = task_of(ROBOT, program.operation(), True, cell, None).thinned(12, 12)
    assert outlook([task], pose((860, 470, 700))).refused == "collision"
    assert outlook([task], pose((860, 0, 380))).refused == "collision"
    assert not outlook([task], pose((860, 0, 700))).refused


@pytest.mark.parametrize(("height", "refused"), [(2.0, ""), (30.0, ""), (-3.0, "collision")])
def test_how_low_the_program_goes_over_its_part_says_nothing_of_a_place(
    height: float, refused: str, tmp_path: Path
) -> None:
    """A rapid move 2 mm above the part was the worst margin of all places alike."""
    pytest.importorskip("coal")
    cell = load_cell(Path(__file__).parents[2] / "examples" / "cell" / "cell.toml")
    file = tmp_path / "part.nc"
    file.write_text(
        f"G21 G90\nG0 X-20. Y30. Z40.\nG0 Z{height}\nG0 X60. Y30.\nG0 Z40.\nG1 Z41. F600.\n"
    )
    operation = read_program(file).operation()
    task = task_of(ROBOT, operation, True, cell, "MILL_10").thinned(9, 12)
    assert cell.work_frame is not None
    found = outlook([task], cell.work_frame, None)
    assert found.refused == refused
    if not refused:
        assert found.margins["clearance_mm"] > 10


def test_a_part_stands_at_first_where_the_cell_has_its_work_object() -> None:
    pytest.importorskip("coal")
    folder = Path(__file__).parents[2] / "examples" / "cell"
    cell = load_cell(folder / "cell.toml")
    program = read_program(folder / "part.cls")
    assert cell.work_frame is not None
    orientation = task_of(ROBOT, program.operation(), True, cell, None).path.position
    middle = (orientation.min(axis=0) + orientation.max(axis=0)) / 2
    here = cell.work_frame[:3, :3] @ middle + cell.work_frame[:3, 3]
    alone = replace(program, operations=(program.operation(),))
    found = place(ROBOT, [alone], area=Area(here, here, np.zeros(1), False), cell=cell)
    np.testing.assert_allclose(found.start.X_BW, cell.work_frame)


def test_an_area_in_metres_is_said(part: Path, tmp_path: Path) -> None:
    where = ["--area", "0.9,-0.3,0.4,1.2,0.3,0.9"]
    done = CliRunner().invoke(app, ["place", str(part), "--out", str(tmp_path / "out"), *where])
    assert isinstance(done.exception, InputError)
    assert "looks like metres" in str(done.exception)


def test_no_place_in_the_area_is_said(part: Path) -> None:
    nowhere = Area(np.array([2.0, 2.0, 0.0]), np.array([2.1, 2.1, 0.1]), np.zeros(1), False)
    with pytest.raises(UnreachableError, match="no place in the area"):
        place(ROBOT, [read_program(part)], area=nowhere)


def test_command(part: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = ["place", str(part), "--out", str(out), "--work-frame", "1250,180,400", "--no-turn"]
    command += ["--area", "900,-100,400,1350,250,500", "--cutting-force", "0,0,-200"]
    command += ["--joint-stiffness", "1e6,1e6,8e5,2e5,2e5,1e5"]
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 0, done.output
    told = json.loads((out / "placement.json").read_text())
    page = (out / "report.html").read_text()
    assert "irb2400 place" in page
    assert page.count("<svg") == 3
    assert 'class="arm"' in page
    assert told["found"]["worth"] >= told["start"]["worth"] - ALIKE
    assert told["found"]["deflection_mm"] < told["start"]["deflection_mm"]
    assert told["looked_at"] == len(told["map"]) > 10
    assert "found: --work-frame" in done.output


def test_a_plan_of_another_way_than_the_judged_one_says_so() -> None:
    """A place with 0.616 from the wrist singularity was planned with 0.535, and nothing said so."""
    judged = {"margins": {"wrist": 0.616, "shoulder": 0.7, "elbow": 0.5, "joint_limits_deg": 40.0}}
    planned = {"margins": {"wrist": 0.535, "shoulder": 0.699, "elbow": 0.6}}
    told = planned_margins(planned, judged)
    assert "wrist 0.535, shoulder 0.699, elbow 0.6; another way" in told
    assert "judged above (wrist 0.616)" in told
    planned["margins"]["wrist"] = 0.614
    assert "another way" not in planned_margins(planned, judged)


def test_a_plan_nearer_to_the_joint_limits_says_so() -> None:
    """A place with 50.4 deg to the joint limits was planned with 45.1 deg, which nobody printed."""
    judged = {"margins": {"wrist": 0.6, "joint_limits_deg": 50.4}}
    planned = {"margins": {"wrist": 0.6, "joint_limits_deg": 45.1}}
    told = planned_margins(planned, judged)
    assert "wrist 0.6, joint limits 45.1 deg; another way" in told
    assert "judged above (joint limits 50.4 deg)" in told
    planned["margins"]["joint_limits_deg"] = 50.1
    assert "another way" not in planned_margins(planned, judged)


RAIL = """
name = "on a rail"
[work_object]
place_mm = [900, 2000, 400]
[rail]
direction = [0, 2, 0]
range_mm = [0, 3000]
position_mm = 1000
[[things]]
name = "post"
role = "obstacle"
shapes = [{ kind = "box", centre_mm = [900, 2400, 750], size_mm = [90, 90, 1500] }]
"""


def test_a_carriage_moves_everything_else_the_other_way(tmp_path: Path) -> None:
    pytest.importorskip("coal")
    (tmp_path / "cell.toml").write_text(RAIL)
    cell = load_cell(tmp_path / "cell.toml")
    assert cell.work_frame is not None
    assert cell.work_frame[:3, 3] == pytest.approx([0.9, 1.0, 0.4])
    assert cell.on_rail(1500).work_frame == pytest.approx(pose((900, 500, 400)))
    (post,) = cell_pieces(cell.on_rail(1500))
    assert post.X[:3, 3] == pytest.approx([0.0, -1.5, 0.0])
    # a pose that is stated is that in the base, wherever the carriage stands
    X = pose((800, 100, 300), (0, 0, 30))
    assert cell.placed(X).work_frame == pytest.approx(X)
    with pytest.raises(InputError, match="expected a place on the rail"):
        cell.on_rail(3001)


def test_the_carriage_is_brought_to_the_part(part: Path, tmp_path: Path) -> None:
    pytest.importorskip("coal")
    (tmp_path / "cell.toml").write_text(RAIL.replace("position_mm = 1000", "position_mm = 0"))
    cell = load_cell(tmp_path / "cell.toml")
    found = rail_position(ROBOT, [read_program(part)], cell)
    assert found.start.refused == "out of reach"
    assert abs(found.position_mm - 2000) < 1500
    assert not found.proof.refused
    # the same place, seen through the cell alone
    there = cell.on_rail(found.position_mm)
    assert there.work_frame == pytest.approx(found.found.X_BW)
    task = task_of(ROBOT, read_program(part).operation(), True, there, None).thinned(48, 24)
    again = outlook([task], found.found.X_BW, patient=True)
    assert again.margins == pytest.approx(found.found.margins, rel=1e-6)


def test_a_part_keeps_its_tilt_whatever_way_the_arm_leans() -> None:
    """Turned about the vertical, which is the base's x axis for an arm on a wall."""
    wall = ROBOT.model_copy(update={"gravity_m_s2": (-9.81, 0.0, 0.0)})
    stands = pose((0, 0, 0), (0, 90, 0))[:3, :3]
    centre = np.array([0.1, 0.2, 0.0])
    for robot, R_BW, up in ((wall, stands, 0), (ROBOT, np.eye(3), 2)):
        X = Standing(np.array([0.8, 0.0, 0.4]), np.pi / 2).pose(R_BW, centre, robot.upright)
        np.testing.assert_allclose(X[:3, 2], np.eye(3)[up], atol=1e-12)
        np.testing.assert_allclose(X[:3, :3] @ centre + X[:3, 3], [0.8, 0.0, 0.4], atol=1e-12)
        turned = X[:3, :3] @ R_BW.T
        assert turned[up, up] == pytest.approx(1.0)
        assert np.trace(turned) == pytest.approx(1.0)


def test_the_area_of_an_arm_on_a_wall_lies_before_the_wall() -> None:
    floor = Area.around(MODEL, np.zeros(1))
    X = Transform.model_validate({"transform": pose((0, 0, 1000), (0, 90, 0)).tolist()})
    first = ROBOT.links[0].model_copy(
        update={
            "frame": Transform.model_validate(
                {"transform": (X.matrix() @ ROBOT.links[0].frame.matrix()).tolist()}
            )
        }
    )
    wall = Area.around(
        Model(ROBOT.model_copy(update={"links": (first, *ROBOT.links[1:])})), np.zeros(1)
    )
    ends = np.array([floor.low, floor.high])
    # before the wall as far as above the floor, beside and below its foot as far as around it
    np.testing.assert_allclose([wall.low[0], wall.high[0]], ends[:, 2], atol=1e-9)
    np.testing.assert_allclose([wall.low[1], wall.high[1]], ends[:, 1], atol=1e-9)
    np.testing.assert_allclose([wall.low[2] - 1, wall.high[2] - 1], ends[:, 0], atol=1e-9)
