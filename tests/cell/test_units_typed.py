"""Metres where millimetres, and radians where degrees are expected."""

from __future__ import annotations

from pathlib import Path

import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, load_cell
from irb2400_ctrl.cell.metres_typed import metres_typed
from irb2400_ctrl.cell.piece import arm_pieces
from irb2400_ctrl.cell.radians_typed import radians_typed
from irb2400_ctrl.cli.planning.placing import doubts
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.robot.shape import pose

THING = '[[things]]\nname = "box"\nrole = "table"\nshapes = [{shape}]\n'
BOX = '{ kind = "box", centre_mm = [0, 0, 0], size_mm = [9, 9, 9] }'
PLACE = 'name = "a"\n[work_object]\nplace_mm = [1, 2, 3]\n'


def cell(tmp_path: Path, text: str) -> Cell:
    file = tmp_path / "cell.toml"
    file.write_text(text)
    return load_cell(file)


@pytest.mark.parametrize(("scale", "size"), [(1, ""), (0.03, ""), (1e-3, "0.141 mm")])
def test_a_tool_in_metres_is_no_speck(tmp_path: Path, scale: float, size: str) -> None:
    """It was one of 0.1 mm, and its holder never touched anything."""
    ends = f"from_mm = [0, 0, {-120 * scale}], to_mm = [0, 0, {-40 * scale}]"
    holder = f'{{ kind = "cylinder", {ends}, radius_mm = {20 * scale} }}'
    tip = f'{{ kind = "sphere", radius_mm = {0.5 * scale} }}'
    text = f'name = "a"\n[[tools]]\nname = "MILL"\nshapes = [{holder}, {tip}]\n'
    tool = cell(tmp_path, text).tool("MILL")
    if not size:
        assert [piece.name for piece in arm_pieces(load_robot("irb2400"), tool)][-1] == "MILL"
        return
    with pytest.raises(InputError, match=f"tool MILL: found a thing of {size}.*numbers metres"):
        arm_pieces(load_robot("irb2400"), tool)


@pytest.mark.parametrize(
    ("turn", "says"),
    [
        ("[0, 0, 1.5708]", "has an angle of 1.5708 degrees, which are 90 degrees as radians"),
        ("[-3.14, 0, 0]", "has an angle of -3.14 degrees, which are 180 degrees as radians"),
        ("[0, 0, 1.6]", ""),
        ("[0.5, 90, 180]", ""),
    ],
)
def test_angles_in_radians_are_asked_about(tmp_path: Path, turn: str, says: str) -> None:
    placed = cell(tmp_path, f"{PLACE}turn_deg = {turn}\n")
    box = BOX.replace("}", f", turn_deg = {turn} }}")
    turned = cell(tmp_path, 'name = "a"\n' + THING.format(shape=box))
    asked = [radians_typed(None, placed.work_frame), radians_typed(turned, None)]
    told = [f"{what} {says}: state it in degrees" for what in ("the work frame", "box")]
    assert asked == (told if says else [None, None])


def test_a_positioner_in_radians_is_asked_about(tmp_path: Path) -> None:
    head = PLACE + "[positioner]\nposition_deg = [0, 90]\n"
    turn = "turn = { direction = [0, 0, 1], point_mm = [0, 0, 0], range_deg = [-RANGE, RANGE] }\n"
    for reach in ("180", "360"):
        assert radians_typed(cell(tmp_path, head + turn.replace("RANGE", reach)), None) is None
    small = head.replace("90", "1.5707963") + turn.replace("RANGE", "180")
    asked = str(radians_typed(cell(tmp_path, small), None))
    assert "the positioner has an angle of 1.5708 " in asked


@pytest.mark.parametrize(
    ("tip", "says"),
    [
        ("[0, 0, 0.3]", "at 0, 0, 0.3 mm, which is next to nothing: if these are metres, state "),
        ("[0, 0, 0]", ""),
        ("[0, 0, 0.004]", ""),
        ("[0.2, 0, 80]", ""),
    ],
)
def test_a_tip_in_metres_is_asked_about(tmp_path: Path, tip: str, says: str) -> None:
    """The tip was where the robot file has it, and the part 0.3 m too near."""
    shape = BOX.replace("centre_mm = [0, 0, 0]", "centre_mm = [0, 0, -20]")
    text = f'name = "a"\n[[tools]]\nname = "MILL"\noffset_mm = {tip}\nshapes = [{shape}]\n'
    asked = metres_typed(cell(tmp_path, text), None)
    told = f"tool MILL has its tip (offset_mm) {says}0, 0, 300"
    assert asked == (told if says else None)


def test_a_work_frame_in_metres_is_asked_about() -> None:
    assert metres_typed(None, pose((0.9, 0.0, 0.5), (0, 0, 0))) == (
        "the work frame stands at 0.9, 0, 0.5 mm, which is next to nothing: if these are metres, "
        "state 900, 0, 500"
    )
    for sound in ((0.0, 0.0, 0.0), (900.0, 0.0, 500.0), (0.0, 0.0, 6.0)):
        assert metres_typed(None, pose(sound, (0, 0, 0))) is None


@pytest.mark.parametrize("reach", ["[0, 3]", "[1000, 0]"])
def test_a_rail_in_metres_is_refused(tmp_path: Path, reach: str) -> None:
    rail = 'name = "a"\n[rail]\ndirection = [0, 1, 0]\nrange_mm = '
    assert cell(tmp_path, rail + "[-10, 20]\n").rail is not None
    with pytest.raises(InputError, match=r"lower end first, 10 mm or more \(not metres\)"):
        cell(tmp_path, rail + reach + "\n")


def test_plan_asks(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text("G21 G90\nG0 X0 Y0 Z40\nG1 X60 F600\n")
    placed = cell(tmp_path, PLACE + "turn_deg = [0, 0, 1.5708]\n")
    options = PlanOptions(cell=placed)
    asked = doubts(load_robot("irb2400"), read_program(file), options)
    assert any("90 degrees as radians" in question for question in asked)
    assert any("stands at 1, 2, 3 mm, which is next to nothing" in question for question in asked)
