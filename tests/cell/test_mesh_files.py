"""Meshes as a CAD system may leave them: cut short, in another unit, with corners that are no
numbers; and a part that is not where the path is."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import load_cell
from irb2400_ctrl.cell.piece import cell_pieces, open_meshes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.clearance.beside_part import beside_part

pytest.importorskip("trimesh")
SIZE = np.array([100.0, 60.0, 20.0])
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (-1, 0)]) * SIZE
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
FACES += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
CELL = """name = "a"
work_object = { place_mm = [850, 0, 500] }

[[things]]
name = "block"
role = "part"
frame = "work_object"
shapes = [{ kind = "mesh", file = "FILE"UNIT }]
"""
PATH = "G21 G90\nG1 X10.0 Y10.0 Z0.0 F600\nX90.0\nY50.0\nX10.0\nM30\n"


def stl(corners: Array, faces: Sequence[tuple[int, ...]] = FACES) -> bytes:
    """A box, or some faces of it, as a binary STL file; its title begins as texts do."""
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *corners[list(f)].ravel(), 0) for f in faces)
    return b"solid of some CAD".ljust(80) + struct.pack("<I", len(faces)) + triangles


def cell_with(folder: Path, content: bytes, name: str = "part.stl", unit: str = "") -> Path:
    (folder / name).write_bytes(content)
    text = CELL.replace("FILE", name).replace("UNIT", f', unit = "{unit}"' if unit else "")
    (folder / "cell.toml").write_text(text)
    return folder / "cell.toml"


@pytest.mark.parametrize(
    ("scale", "unit"), [(1, "mm"), (0.1, "cm"), (1e-3, "m"), (1 / 25.4, "inch")]
)
def test_a_mesh_is_as_large_as_its_unit_says(tmp_path: Path, scale: float, unit: str) -> None:
    cell = load_cell(cell_with(tmp_path, stl(scale * CORNERS), unit=unit))
    (block,) = cell_pieces(cell)
    assert 2e3 * block.half_size() == pytest.approx(SIZE, rel=1e-5)
    assert block.shape.closed  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("scale", "unit", "size"), [(1e-3, "mm", r"0\.1 mm"), (1, "m", r"1e\+05 mm")]
)
def test_another_unit_is_asked_about(tmp_path: Path, scale: float, unit: str, size: str) -> None:
    cell = load_cell(cell_with(tmp_path, stl(scale * CORNERS), unit=unit))
    with pytest.raises(InputError, match=f"a thing of {size} with unit = '{unit}'"):
        cell_pieces(cell)


def test_a_wall_in_metres_is_no_speck(tmp_path: Path) -> None:
    """Without a unit it would be 3 mm large, and nothing would ever touch it."""
    wall = stl(CORNERS * 0.03)
    with pytest.raises(InputError, match=r"a thing of 3 mm, taken for.*write unit = .inch. or"):
        cell_pieces(load_cell(cell_with(tmp_path, wall)))
    (pin,) = cell_pieces(load_cell(cell_with(tmp_path, wall, unit="mm")))
    assert 2e3 * pin.half_size()[0] == pytest.approx(3.0, rel=1e-5)


def test_a_mesh_with_a_gap_is_asked_about(tmp_path: Path) -> None:
    """A tool went in through the gap, and what it cut was free of it by 14 mm."""
    whole = cell_pieces(load_cell(cell_with(tmp_path, stl(CORNERS))))
    assert open_meshes(whole) is None
    without_top = stl(CORNERS, [f for f in FACES if any(CORNERS[k][2] < 0 for k in f)])
    both_ways = stl(CORNERS, [f if k % 2 else f[::-1] for k, f in enumerate(FACES)])
    for content in (without_top, both_ways):
        found = cell_pieces(load_cell(cell_with(tmp_path, content)))
        assert "the triangles of block do not close, or are turned" in str(open_meshes(found))


def test_corners_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    """A reader that leaves such triangles out would show a part with a hole."""
    corners = CORNERS.copy()
    corners[3] = np.nan
    with pytest.raises(InputError, match="corners that are no numbers"):
        cell_pieces(load_cell(cell_with(tmp_path, stl(corners))))


def test_a_file_cut_short_says_how_much_is_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found 400 bytes, expected 684 of a binary STL file"):
        cell_pieces(load_cell(cell_with(tmp_path, stl(CORNERS)[:400])))


@pytest.mark.parametrize("tail", [b"\0" * 37, stl(CORNERS)[84:]])
def test_bytes_behind_the_last_triangle_are_named(tmp_path: Path, tail: bytes) -> None:
    """It was said that there are no triangles."""
    says = "found [0-9,]+ bytes, expected 684 .*: a count that is wrong, or bytes behind its end"
    with pytest.raises(InputError, match=says):
        cell_pieces(load_cell(cell_with(tmp_path, stl(CORNERS) + tail)))


@pytest.mark.parametrize("name", ["part.step", "part.STP", "part.igs"])
def test_a_cad_model_is_no_mesh(tmp_path: Path, name: str) -> None:
    cell = load_cell(cell_with(tmp_path, b"ISO-10303-21;\nHEADER;\n", name))
    with pytest.raises(InputError, match="a CAD model; expected triangles: export it as STL"):
        cell_pieces(cell)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"ply\nformat ascii 1.0\n", "a PLY file.* the ending .ply, or export it as STL"),
        (b"# Blender\nmtllib a.mtl\no part\nv 0 0 -1.5\nv 1 0 0\nf 1 2 2\n", "an OBJ file.* .obj"),
        (b"v 0.0 1e-3 0 1 1 1\nv 1 0 0\nf 1 2 2\n", "an OBJ file"),
        (b"PK\x03\x04\x14\0" + b"\0" * 200, "a ZIP archive, such as a 3MF file"),
        (b"glTF\2\0\0\0" + b"\0" * 200, "a glTF file"),
        (b"OFF\n8 6 0\n", "an OFF file"),
        (b"ISO-10303-21;\nHEADER;\n", "a STEP file, expected an STL file: export it as STL"),
        (b"made by a CAD system".ljust(72) + b"S      1\n", "an IGES file"),
        (b'<?xml version="1.0"?><COLLADA/>', "an XML file"),
    ],
)
def test_another_kind_of_file_is_named(tmp_path: Path, content: bytes, says: str) -> None:
    """They had no triangles, or bytes that no one could count."""
    with pytest.raises(InputError, match=f"cannot be read: found what begins as {says}"):
        cell_pieces(load_cell(cell_with(tmp_path, content)))


def test_a_title_that_begins_as_another_kind_is_a_title(tmp_path: Path) -> None:
    for title in (b"ply\nconverted", b"PK\x03\x04", b"OFF "):
        content = title.ljust(80) + stl(CORNERS)[80:]
        assert len(cell_pieces(load_cell(cell_with(tmp_path, content)))) == 1


def test_a_part_that_is_not_where_the_path_is_is_asked_about(tmp_path: Path) -> None:
    (tmp_path / "path.nc").write_text(PATH)
    program = read_program(tmp_path / "path.nc")
    right = load_cell(cell_with(tmp_path, stl(CORNERS)))
    assert beside_part(program, cell_pieces(right), right.work_frame) is None
    # inches read as millimetres: a part of 4.7 mm, the path 10 mm from it
    small = load_cell(cell_with(tmp_path, stl(CORNERS / 25.4), "small.stl", unit="mm"))
    assert "mm to block, which is 4.658 mm large" in str(
        beside_part(program, cell_pieces(small), small.work_frame)
    )
    # the path in the robot base, the part on the work object
    assert "is the unit of its mesh right" in str(beside_part(program, cell_pieces(right), None))
