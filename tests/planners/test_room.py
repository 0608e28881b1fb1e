"""What is moved to another place does not stand in what stays where it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cell import Scene, load_cell
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.placement import Area, place, rail_position
from irb2400_ctrl.planners.placement.room import Room
from irb2400_ctrl.robot.shape import pose

pytest.importorskip("coal")

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
HEAD = 'schema_version = 1\nname = "cell"\n[work_object]\nplace_mm = [1000, 0, 500]\n'
BLOCK = '{ kind = "box", centre_mm = [0, 0, -100], size_mm = [200, 200, 200] }'
TABLE = '{ kind = "box", centre_mm = [1000, 0, HEIGHT], size_mm = [900, 1600, 100] }'


def thing(name: str, frame: str, shape: str) -> str:
    role = "part" if frame == "work_object" else "table"
    return f'[[things]]\nname = "{name}"\nrole = "{role}"\nframe = "{frame}"\nshapes = [{shape}]\n'


def cell_file(folder: Path, *things: str, head: str = HEAD) -> Path:
    path = folder / "cell.toml"
    path.write_text(head + "".join(things), encoding="utf-8")
    return path


def room(path: Path) -> Room:
    return Room.of_part(Scene.of(MODEL, ROBOT, load_cell(path)))


def box_stl(path: Path) -> str:
    """The block as a file, its triangles turned inwards."""
    trimesh: Any = pytest.importorskip("trimesh")
    mesh = trimesh.creation.box((200, 200, 200))
    mesh.apply_translation((0, 0, -100))
    mesh.invert()
    mesh.export(path)
    return f'{{ kind = "mesh", file = "{path.name}", unit = "mm" }}'


@pytest.mark.parametrize("as_mesh", [False, True])
def test_a_part_may_rest_on_a_table_and_not_stand_in_it(as_mesh: bool, tmp_path: Path) -> None:
    block = box_stl(tmp_path / "block.stl") if as_mesh else BLOCK
    table = thing("table", "base", TABLE.replace("HEIGHT", "250"))
    floor = HEAD.replace("[work", "floor_mm = 0\n[work")
    where = room(cell_file(tmp_path, thing("block", "work_object", block), table, head=floor))
    assert not where.overlapping
    for height, says in ((0.0, ""), (300.0, ""), (-3.0, "table"), (-1000.0, "floor")):
        found = where.taken(pose((0, 0, height)))
        assert found == (f"block would stand in {says}" if says else "")
    assert where.taken(pose((-900, 0, -100))) == "block would stand in base"


def test_what_stands_in_another_at_the_start_may_do_so(tmp_path: Path) -> None:
    table = thing("table", "base", TABLE.replace("HEIGHT", "300"))
    where = room(cell_file(tmp_path, thing("block", "work_object", BLOCK), table))
    assert where.overlapping == ("block in table",)
    assert not where.taken(pose((0, 0, -20)))


@pytest.mark.parametrize(("height", "free"), [(150, True), (270, False)])
def test_no_place_is_found_inside_a_table(height: int, free: bool, tmp_path: Path) -> None:
    path = tmp_path / "part.csv"
    rows = ["0,0,0,40,0,0,1", "60,0,0,40,0,0,1", "60,40,0,40,0,0,1"]
    path.write_text("\n".join(["x_mm,y_mm,z_mm,feed_mm_s,i,j,k", *rows]) + "\n", encoding="utf-8")
    block = thing("block", "work_object", BLOCK)
    table = thing("table", "base", TABLE.replace("HEIGHT", str(height)))
    area = Area(np.array([0.9, 0.0, 0.4]), np.array([1.1, 0.1, 0.45]), np.zeros(1), False)
    cell = load_cell(cell_file(tmp_path, block, table, head=HEAD.replace("500]", "700]")))
    program = [read_program(path)]
    if free:
        assert not place(ROBOT, program, area=area, cell=cell).proof.refused
    else:
        with pytest.raises(UnreachableError, match="block would stand in table"):
            place(ROBOT, program, area=area, cell=cell)


def test_an_arm_on_a_rail_does_not_stand_in_a_bench(tmp_path: Path) -> None:
    path = tmp_path / "part.csv"
    rows = ["0,0,0,40,0,0,1", "60,0,0,40,0,0,1"]
    path.write_text("\n".join(["x_mm,y_mm,z_mm,feed_mm_s,i,j,k", *rows]) + "\n", encoding="utf-8")
    rail = "[rail]\ndirection = [0, 1, 0]\nrange_mm = [0, 2000]\nposition_mm = 2000\n"
    head = HEAD.replace("1000, 0, 500", "1000, 1000, 500") + rail
    program = [read_program(path)]
    best = rail_position(ROBOT, program, load_cell(cell_file(tmp_path, head=head))).position_mm
    bench = f'{{ kind = "box", centre_mm = [500, {best}, 60], size_mm = [600, 300, 60] }}'
    cell = load_cell(cell_file(tmp_path, thing("bench", "base", bench), head=head))
    found = rail_position(ROBOT, program, cell)
    # half of the base and half of the bench
    assert abs(found.position_mm - best) > 300 + 150 - 1
    assert any("bench would stand in base" in seen.refused for _, seen in found.seen)
