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
    ],
)
def test_the_same_work_frame_named_again(tmp_path: Path, first: str, second: str) -> None:
    found = program(tmp_path, CUT.format(first=first, second=second)).operation()
    assert np.allclose(1e3 * found.path.position[-1], [2, 1, 1])


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
