"""G-code: the work frames that a file names, and sub-programs that it does not hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

CUT = "G21 G90\n{first}\nG0 X1 Y1 Z9\nG1 Z1 F100\nG0 Z9\n{second}\nG0 X2 Y1 Z9\nG1 Z1 F100\nM30\n"


@pytest.mark.parametrize(
    ("first", "second", "says"),
    [
        ("G15 H1", "G15 H2", "G15 H2 after motion in G15 H1"),
        ("G54 P1", "G54 P2", "G54 P2 after motion in G54 P1"),
        ("G54", "G54 P2 G17", "G54 P2 after motion in G54"),
        ("", "G55", "G55 after motion in no stated frame: .*in the frame of the one in force"),
        ("G54", "G16 H2", "G16 H2 takes another work frame for one block"),
    ],
)
def test_another_work_frame_is_not_taken_for_the_same(
    tmp_path: Path, first: str, second: str, says: str
) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, CUT.format(first=first, second=second))


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("G15 H1", "G15 H1"),
        ("G54", "G54 G64 P0.01"),
        ("G54", "G54 G8 P1"),
        ("G54", "G54.2 P0"),
        ("G54.1 P3", "G54.1 P3 G17"),
        ("G54", "G67"),
        ("", "G54"),
        ("G0 Z50", "G0 Z40"),
    ],
)
def test_the_same_work_frame_named_again(tmp_path: Path, first: str, second: str) -> None:
    found = program(tmp_path, CUT.format(first=first, second=second)).operation()
    assert np.allclose(1e3 * found.path.position[-1], [2, 1, 1])


@pytest.mark.parametrize("name", ["G55", "G54.1 P3", "G15 H2"])
def test_a_work_frame_whose_place_is_stated(tmp_path: Path, name: str) -> None:
    file = tmp_path / "part.nc"
    file.write_text(CUT.format(first="G54", second=name).replace("M30", "G0 Z9\nG54\nX7\nM30"))
    said = [f"{name.replace(' ', '').lower()}=100,0,10,0,0,90"]
    read = read_program(file, work_offsets=said)
    points = 1e3 * read.operation().path.position
    # X2 Y1 of a frame turned by 90 deg is X-1 Y2; G54 is where it was
    expected = [[1, 1, 9], [1, 1, 1], [1, 1, 9], [99, 2, 19], [99, 2, 11], [99, 2, 19], [7, 2, 19]]
    assert np.allclose(points, expected)
    with pytest.raises(InputError, match=r"state it \(--work-offset"):
        read_program(file, work_offsets=["G57=1,2,3"])


@pytest.mark.parametrize("said", [["G55"], ["=1,2,3"], ["G55=1,2"], ["G55=1,2,3", "g55=0,0,0"]])
def test_work_frames_that_are_stated_wrongly(tmp_path: Path, said: list[str]) -> None:
    file = tmp_path / "part.nc"
    file.write_text(CUT.format(first="G54", second="G55"))
    with pytest.raises(InputError, match=r"work (offset|frame): found"):
        read_program(file, work_offsets=said)


def test_a_preset_whose_place_is_stated(tmp_path: Path) -> None:
    file = tmp_path / "part.h"
    file.write_text(
        "BEGIN PGM A MM\nCYCL DEF 247 DATUM ~\n Q339=+1\nL X+0 Y+0 Z+9 FMAX\nL Z+1 F60\n"
        "CYCL DEF 247 DATUM ~\n Q339=+2\nL X+1\nEND PGM A MM\n"
    )
    found = read_program(file, work_offsets=["PRESET 2=50,0,0"]).operation().path.position
    assert np.allclose(1e3 * found[-1], [51, 0, 1])
    with pytest.raises(InputError, match="preset 2 after motion in preset 1"):
        read_program(file)


def test_sub_programs_of_another_file_are_not_passed_over(tmp_path: Path) -> None:
    file = tmp_path / "part.mpf"
    file.write_text("G710 G90\nG0 X0 Y0 Z9\nL100 P2\nG1 X5 F100\nM30\n")
    with pytest.raises(InputError, match="line 3: L100 calls a sub-program that is not in the"):
        read_program(file)
    with pytest.raises(InputError, match="M198 calls a sub-program that is not in the file"):
        program(tmp_path, "G21 G90\nG0 X0 Y0 Z9\nM198 P20\nG1 X5 F100\nM30\n")


def test_l6_changes_the_tool(tmp_path: Path) -> None:
    file = tmp_path / "part.mpf"
    file.write_text("G710 G90\nT7 L6\nG0 X0 Y0 Z9\nG1 X5 F100\nM30\n")
    read = read_program(file)
    assert read.operation().tool.number == 7
    assert "L6 changes the tool" in str(read.of_kind("assumed")[0])


@pytest.mark.parametrize("shift", ["G58 X100 Y20", "G59 Z-3"])
def test_a_programmed_shift_of_siemens_is_no_place(tmp_path: Path, shift: str) -> None:
    text = CUT.format(first="G54", second=shift)
    file = tmp_path / "part.mpf"
    file.write_text(text)
    with pytest.raises(InputError, match=rf"line 6: {shift[:3]} with {shift[4]} .* as TRANS"):
        read_program(file)
    # a frame of the table, as on other controls
    file.write_text(CUT.format(first="G58", second="G58 G0 X4"))
    assert len(read_program(file).operation().path) == 6
