"""What a thing of a cell may be called, and which rights it may state."""

from __future__ import annotations

from pathlib import Path

import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Scene, load_cell
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model

pytest.importorskip("coal")
ROBOT = load_robot("irb2400")


def scene(folder: Path, name: str, role: str = "obstacle", more: str = "", head: str = "") -> Scene:
    box = f'{{ kind = "box", centre_mm = [1500, 0, 0], size_mm = [99, 99, 99]{more} }}'
    thing = f'[[things]]\nname = "{name}"\nrole = "{role}"\nshapes = [{box}]\n'
    file = folder / "cell.toml"
    file.write_text(f'name = "c"\n{head}{thing}')
    found = Scene.of(Model(ROBOT), ROBOT, load_cell(file))
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["link_3", "base", "tool of the electric spindle"])
def test_a_thing_is_not_called_as_a_body_of_the_arm(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=f"a thing called '{name}', as a body of the arm"):
        scene(tmp_path, name)
    assert scene(tmp_path, f"{name} of the press").things


def test_one_floor(tmp_path: Path) -> None:
    """The picture left the thing out, and messages did not say which floor they meant."""
    with pytest.raises(InputError, match="a thing called 'floor', as the floor at floor_mm is"):
        scene(tmp_path, "floor", head="floor_mm = -500\n")
    assert len(scene(tmp_path, "floor").things) == 1
    assert len(scene(tmp_path, "pit", head="floor_mm = -500\n").things) == 2


def test_what_is_no_part_has_no_shapes_that_cut(tmp_path: Path) -> None:
    """Whoever wrote it meant that the fixture may be cut, and nothing was said."""
    with pytest.raises(InputError, match=r'cuts = true.*"part" or "stock", and this is "fixture"'):
        scene(tmp_path, "vise", "fixture", ", cuts = true")
    assert scene(tmp_path, "vise", "fixture", ", cuts = false").things
    assert scene(tmp_path, "blank", "stock", ", cuts = true").things
