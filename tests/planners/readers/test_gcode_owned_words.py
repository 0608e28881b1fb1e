"""G-code: words that belong to a code which moves nothing are no place to go to."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram

HEAD = "G21 G90 G17\nG0 X0. Y0. Z10.\nG1 X5. F100\n"


def assumed(read: CamProgram) -> str:
    return " ".join(map(str, read.of_kind("assumed")))


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("G43.1 Z-48.2", "line 4: G43.1 Z-48.2: the tool's length offset and no motion"),
        ("G22 X100. Y100. Z100. I-1. J-1. K-1.", "G22 X100 Y100 Z100 I-1 J-1 K-1: limits"),
        ("G25 X-10. Y-10.", "G25 X-10 Y-10: limits"),
        ("G26 P1 Q2 R3 I4", "G26 I4 P1 Q2 R3: limits"),
        ("G50.1 X0.", "G50.1 X0: the axes that are no longer mirrored"),
        ("G92 S2000", "G92 S2000: the highest speed of the spindle, which is not held"),
        ("G50 S2000", "G50 S2000: the highest speed of the spindle, which is not held"),
    ],
)
def test_words_of_a_code_make_no_motion(tmp_path: Path, block: str, says: str) -> None:
    read = program(tmp_path, f"{HEAD}{block}\nX9.\nM30\n")
    points = 1e3 * read.operation().path.position
    assert np.allclose(points, [[0, 0, 10], [5, 0, 10], [9, 0, 10]])
    assert says in assumed(read)
    assert "the zero is moved" not in assumed(read)


def test_limits_are_no_circle(tmp_path: Path) -> None:
    read = program(tmp_path, f"{HEAD}G2 X9. I2.\nG26 P1 Q2 R3 I4\nM30\n")
    assert set(read.operation().line) == {2, 3, 4}


@pytest.mark.parametrize("block", ["G50 G69 G0 X9.", "G1 G50 X9.", "G50 G81 X9. Z1. R10. F60"])
def test_a_place_beside_the_end_of_scaling_is_of_the_motion(tmp_path: Path, block: str) -> None:
    read = program(tmp_path, f"{HEAD}{block}\nG80\nM30\n")
    assert np.allclose(1e3 * read.operation().path.position[-1], [9, 0, 10])
    assert "line 4: G50 beside G" in assumed(read)


@pytest.mark.parametrize("block", ["G92 S3000", "G26 S3000", "G50 S3000"])
def test_a_limit_of_the_spindle_is_not_its_speed(tmp_path: Path, block: str) -> None:
    read = program(tmp_path, f"S600 M3\n{HEAD}{block}\nG95 G1 X9. F0.1\nM30\n")
    assert read.operation().path.feed[-1] == pytest.approx(1e-3)


def test_a_length_offset_with_a_register_goes_to_the_place(tmp_path: Path) -> None:
    read = program(tmp_path, f"{HEAD}G43.1 Z2. H3\nM30\n")
    assert 1e3 * read.operation().path.position[-1, 2] == pytest.approx(2)
    assert read.operation().tool.length_offset == 3


def test_the_number_of_an_offset_is_not_of_the_arc(tmp_path: Path) -> None:
    read = program(tmp_path, "G21 G90\nG54.1 P7 G0 X0. Y0. Z0.\nG54.1 P7 G2 X10. I5. F60\nM30\n")
    path = read.operation().path.position
    way = 1e3 * np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert way == pytest.approx(5 * np.pi, rel=1e-2)


@pytest.mark.parametrize("end", ["G92.1", "G92.1 X0 Y0", "G92.1 X0 Y0 Z0", "G92.2 X0 Y0"])
def test_the_end_of_a_moved_zero_names_the_axes_that_were_moved(tmp_path: Path, end: str) -> None:
    text = f"{HEAD}G52 Z0.\nG92 X50. Y50.\nG1 X60.\n{end}\nX3.\nG92 Z0.\nG92.1 Z0.\nZ9.\nM30\n"
    found = 1e3 * program(tmp_path, text).operation().path.position
    assert np.allclose(found[2:], [[15, 0, 10], [3, 0, 10], [3, 0, 9]])


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("G50 X100. Z50.", "line 4: G50 with X and no motion code sets .* expected G92"),
        ("G50 G80 X100.", "line 4: G50 with X and no motion code"),
        ("G50 G0 X9. S2000", "line 4: G50 and G0 in one block: whose is S2000"),
        ("G0 G43.1 Z-48.2", "line 4: G43.1 and G0 in one block: whose is Z-48.2"),
        ("G0 G22 X100.", "G22 and G0 in one block"),
        ("G92 C0. X0.\nG92 C5.", "line 5: G92 C5 moves the zero of the rotary axis C"),
        ("G52 A5.", "G52 A5 moves the zero of the rotary axis A"),
        ("G92 X0. Y3.\nG92.1 X0.", r"line 5: G92.1 with X .* that of Y stays; .* with X, Y$"),
        ("G52 Z3.\nG92 X0.\nG92.1 X0.", "line 6: G92.1 with X .* that of Z stays"),
        ("G68 X0. Y0. R30.\nG92 X1.\nG69\nG92.1 X0.", "line 7: G92.1 with X .* of Y stays"),
        ("G2 X9. I2. P1.5", "an arc of 1.5 turns .*, expected a whole number"),
        ("G2 X9. I2. P-2", "an arc of -2 turns .*, expected a whole number"),
    ],
)
def test_what_changes_the_coordinates_is_refused(tmp_path: Path, block: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"{HEAD}{block}\nX9.\nM30\n")


@pytest.mark.parametrize(
    ("begin", "cut", "path"),
    [
        ("G90\nG92 X0 Y0 Z9", "G1 Z1 F60", [[0, 0, 9], [0, 0, 1]]),
        ("G91\nG92 X1 Y2\nG92 Z0", "G1 X5 F60", [[1, 2, 0], [6, 2, 0]]),
        ("G90\nG92 X0 Y0", "G1 X5 F60", [[0, 0, 0], [5, 0, 0]]),
        # the place is another one on the machine then
        ("G90\nG92 X0 Y0 Z9\nG28 X0 Y0 Z9", "G1 X4 Y4 Z9 F60\nX5", [[4, 4, 9], [5, 4, 9]]),
    ],
)
def test_the_first_cut_begins_where_g92_says_the_tool_is(
    tmp_path: Path, begin: str, cut: str, path: list[list[float]]
) -> None:
    found = program(tmp_path, f"G21 {begin}\n{cut}\nM30\n").operation()
    assert np.allclose(1e3 * found.path.position[-2:], path)


def test_the_first_arc_begins_where_g92_says_the_tool_is(tmp_path: Path) -> None:
    text = "G21 G90 G92 X0 Y0 Z0\nG2 X10 Y0 I5 J0 F60\nM30\n"
    position = 1e3 * program(tmp_path, text).operation().path.position
    assert np.allclose(position[[0, -1]], [[0, 0, 0], [10, 0, 0]])
    assert np.allclose(np.linalg.norm(position - [5, 0, 0], axis=1), 5)


def test_holes_begin_above_the_first_wherever_g92_says_the_tool_is(tmp_path: Path) -> None:
    text = "G21 G90 G92 X50 Y0 Z9\nG81 X1 Y2 Z-3 R1 F60\nM30\n"
    position = 1e3 * program(tmp_path, text).operation().path.position
    assert np.allclose(position[:, :2], [1, 2])
