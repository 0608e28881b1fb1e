"""What a cell file may say, and what is said of one that is wrong."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl import load_robot, save_robot
from irb2400_ctrl.cell import Cell, Rail, Scene, load_cell, with_tool
from irb2400_ctrl.cell.piece import cell_pieces
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.planning.placing import doubts
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.shape import place_and_turn, pose

pytest.importorskip("coal")
EXAMPLE = Path(__file__).parents[2] / "examples" / "cell"
CELL_FILE = EXAMPLE / "cell.toml"
THING = '[[things]]\nname = "box"\nrole = "table"\nshapes = [{shape}]\n'
BOX = '{ kind = "box", centre_mm = [0, 0, 0], size_mm = [1, 1, 1] }'
TOOL = '[[tools]]\nname = "NAME"\nnumber = 1\nshapes = [' + BOX + "]\n"


def cell(tmp_path: Path, text: str) -> Cell:
    file = tmp_path / "cell.toml"
    file.write_text(text)
    return load_cell(file)


def test_the_example_says_what_it_says() -> None:
    found = load_cell(CELL_FILE)
    assert found.work_frame is not None
    assert found.work_frame[:3, 3] == pytest.approx([0.85, 0.0, 0.5])
    pieces = {piece.name: piece for piece in cell_pieces(found)}
    assert set(pieces) == {"part", "vise", "table", "post", "floor"}
    assert pieces["part"].may_be_cut
    assert not pieces["vise"].may_be_cut
    # the step is 80 x 60 x 40 mm, its top at the zero of the work object
    X = pieces["part"].pose()
    assert pieces["part"].half_size() == pytest.approx([0.04, 0.03, 0.02])
    assert X[:3, 3] == pytest.approx([0.89, 0.03, 0.48])
    floor = pieces["floor"]
    assert floor.pose()[2, 3] + floor.half_size()[2] == pytest.approx(0.0)
    assert found.tool_of(1, "") == "MILL_10"
    assert found.tool_of(None, "MILL_10") == "MILL_10"
    assert found.tool_of(7, "SAW") is None


def test_frames_turn_about_fixed_axes(tmp_path: Path) -> None:
    text = 'name = "a"\nwork_object = { place_mm = [100, 0, 0], turn_deg = [90, 0, 90] }\n'
    found = cell(tmp_path, text).work_frame
    assert found is not None
    # first about x: z goes to -y; then about z: -y goes to x
    assert found[:3, :3] @ [0, 0, 1] == pytest.approx([1, 0, 0])
    assert found[:3, 3] == pytest.approx([0.1, 0, 0])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x = ", "is not TOML"),
        ("", "name: Field required"),
        ('name = "a"\nflor_mm = 0', "flor_mm: unknown key; did you mean floor_mm?"),
        ('name = "a"\nclearance_mm = -1', "clearance_mm: .* greater than or equal to 0, found -1"),
        ('name = "a"\n' + THING.format(shape='{ kind = "cone" }'), "does not match"),
        (
            'name = "a"\n' + THING.format(shape='{ kind = "sphere", radius_mm = 0 }'),
            r"things\[1\].shapes\[1\].radius_mm: .* greater than 0, found 0",
        ),
        (
            'name = "a"\n'
            + THING.format(
                shape='{ kind = "capsule", from_mm = [1, 2, 3], to_mm = [1, 2, 3], radius_mm = 1 }'
            ),
            "the same point; expected a sphere",
        ),
        ('name = "a"\n' + 2 * THING.format(shape=BOX), "two things are called 'box'"),
        (
            'name = "a"\n' + TOOL.replace("NAME", "b") + TOOL.replace("NAME", "c"),
            "two tools have the number 1",
        ),
        (
            'name = "a"\n' + TOOL.replace("[0, 0, 0]", "[0, 0, 0.5]"),
            "tool NAME: all of it lies beyond its tip, .*expected negative z",
        ),
        (
            'name = "a"\n' + THING.format(shape=BOX).replace("role", 'frame="work_object"\nrole'),
            r"box stands in the frame of the work object, but there is no \[work_object\]",
        ),
        ('name = "a"\n' + THING.format(shape=BOX).replace("table", "sky"), "role: .* found 'sky'"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError) as error:
        cell(tmp_path, text)
    assert re.search(says, str(error.value)), error.value
    assert "cell.toml" in str(error.value)


@pytest.mark.parametrize("scale", [1, 1e-3], ids=["mm", "m"])
def test_a_post_in_metres_is_no_speck(tmp_path: Path, scale: float) -> None:
    """It was one of 1.5 mm at the foot of the arm, and nothing ever touched it."""
    ends = f"from_mm = [{950 * scale}, 0, 0], to_mm = [{950 * scale}, 0, {1500 * scale}]"
    shape = f'{{ kind = "cylinder", {ends}, radius_mm = {50 * scale} }}'
    found = cell(tmp_path, 'name = "a"\n' + THING.format(shape=shape))
    if scale == 1:
        assert len(cell_pieces(found)) == 1
        return
    with pytest.raises(InputError, match=r"box: found a thing of 1\.\d mm.*are its numbers metres"):
        cell_pieces(found)


def test_shapes_that_are_wrong_are_not_missing_as_well(tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        cell(tmp_path, 'name = "a"\n' + THING.format(shape='{ kind = "mehs" }'))
    assert "at least 1 item" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "asked"), [("PROFILE", False), ("Profile", True), ("PROFLIE", True), ("OTHER", False)]
)
def test_an_operation_of_a_rail_that_is_misspelt_is_asked_about(name: str, asked: bool) -> None:
    """The arm stayed where it works on all others, and nothing told."""
    rail = Rail(direction=(0, 1, 0), range_mm=(0, 3000), operations={name: 2800.0})
    standing = load_cell(CELL_FILE).model_copy(update={"rail": rail})
    program = read_program(EXAMPLE / "part.cls")
    called = replace(program.operations[0], name="PROFILE")
    options = PlanOptions(cell=standing)
    found = doubts(load_robot("irb2400"), replace(program, operations=(called,)), options)
    told = f"[rail] has a place for the operation {name}, the program has PROFILE"
    assert any(question.startswith(told) for question in found) == asked


def test_missing_files_are_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found nothing, expected a cell file"):
        load_cell(tmp_path / "none.toml")
    shape = '{ kind = "mesh", file = "part.stl" }'
    found = cell(tmp_path, 'name = "a"\n' + THING.format(shape=shape))
    with pytest.raises(InputError, match=r"part\.stl: found nothing, expected an STL file"):
        cell_pieces(found)
    (tmp_path / "part.stl").write_bytes(b"solid nothing\nendsolid nothing\n")
    with pytest.raises(InputError, match=r"part\.stl"):
        cell_pieces(found)


def test_an_outline_names_links_that_there_are(tmp_path: Path) -> None:
    robot = load_robot("irb2400")
    assert load_robot(save_robot(robot, tmp_path / "arm.toml")) == robot
    text = (tmp_path / "arm.toml").read_text().replace('on = "link_4"', 'on = "link_9"')
    (tmp_path / "arm.toml").write_text(text)
    with pytest.raises(InputError, match="outline: no link is called 'link_9'"):
        load_robot(tmp_path / "arm.toml")


def test_a_tool_of_the_cell_takes_the_place_of_what_the_spindle_holds() -> None:
    robot = load_robot("irb2400")
    found = load_cell(CELL_FILE)
    longer = found.tools[0].model_copy(update={"offset_mm": (0.0, 0.0, 30.0)})
    arm = with_tool(robot, longer)
    assert np.linalg.norm(arm.X_FT[:3, 3] - robot.X_FT[:3, 3]) == pytest.approx(0.03)
    scene = Scene.of(Model(arm), robot, found, longer)
    assert scene is not None
    names = [piece.name for piece in scene.arm]
    assert names.count("MILL_10") == 3
    assert "tool of the electric spindle" not in names
    assert "electric spindle" in names
    # its tip is where the TCP is
    q = np.radians([10.0, 20, 5, 30, 40, 50])
    tip = next(p for p in scene.arm if p.cuts)
    _, poses = scene.near(q[None])
    ends, _ = tip.capsule()
    X = poses[0, tip.link]
    assert X[:, :3] @ ends[1] + X[:, 3] == pytest.approx(Model(arm).tcp_pose(q)[:3, 3])


def test_a_pose_leads_back_to_its_six_numbers() -> None:
    draw = np.random.default_rng(3)
    for turn in [*draw.uniform(-180, 180, (50, 3)), (30.0, 90.0, 0.0), (10.0, -90.0, 0.0)]:
        X = pose(draw.normal(size=3) * 1e3, turn)
        assert pose(*place_and_turn(X)) == pytest.approx(X, abs=1e-9)


def test_what_stands_on_the_work_object_moves_with_it() -> None:
    pytest.importorskip("coal")
    cell = load_cell(CELL_FILE)
    X = pose((700, -300, 400), (0, 0, 40))
    robot = load_robot("irb2400")
    model = Model(robot)
    whole = Scene.of(model, robot, cell)
    again = Scene.of(model, robot, cell.placed(X))
    assert whole is not None
    assert again is not None
    moved = whole.placed(X)
    q = np.radians(np.random.default_rng(1).uniform(-50, 50, (40, 6)))
    none = np.zeros(40, dtype=bool)
    outer = [whole.things[k].on_work_object for _, k in whole.outer]
    pairs = np.array([False] * len(whole.own) + outer)
    before, after, anew = (each.clearance(q, none, 2.0, pairs) for each in (whole, moved, again))
    assert after == pytest.approx(anew, abs=1e-9)
    assert np.abs(after - before).max() > 1e-3
    stays = {piece.name for piece in moved.things if not piece.on_work_object}
    assert stays == {"table", "post", "floor"}


def test_plan_moves_the_cell_with_the_work_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def planned(options: PlanOptions, _: Robot) -> None:
        asked.append(options)
        raise InputError("seen")

    monkeypatch.setattr(PlanOptions, "timed", planned)
    command = ["plan", str(EXAMPLE / "part.cls"), "--out", str(tmp_path / "out")]
    command += ["--cell", str(CELL_FILE), "--work-frame", "700,-300,400,0,0,40"]
    assert isinstance(CliRunner().invoke(app, command).exception, InputError)
    found = asked[0].cell
    assert isinstance(found, Cell)
    assert found.work_frame == pytest.approx(pose((700, -300, 400), (0, 0, 40)))


def test_a_tool_of_the_cell_on_the_bare_flange_of_an_imported_arm() -> None:
    """Its file has no [tool], and no cell with a tool was planned in."""
    bare = load_robot("irb2400").model_copy(update={"tool": None})
    mill = load_cell(CELL_FILE).tools[0].model_copy(update={"offset_mm": (5.0, 0.0, 80.0)})
    model = Model(with_tool(bare, mill))
    q = np.linspace(0.1, 0.6, 6)
    X = np.linalg.inv(Model(bare).flange_pose(q)) @ model.tcp_pose(q)
    np.testing.assert_allclose(X[:3, 3], [0.005, 0.0, 0.08], atol=1e-12)
    np.testing.assert_array_equal(model.gravity(q), Model(bare).gravity(q))
