"""G-code of Haas, Okuma, Brother and Mazak: tool centre, turned offsets, smoothing, names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError

CUT = "G0 X1. Y2. Z9.\nG1 Z3. F60.\n"


def test_coordinates_that_turn_with_the_axes(tmp_path: Path) -> None:
    text = f"G21 G90 G54\nG0 B30. C90.\nG254\n{CUT}G0 Z9.\nG255\nG0 B0. C0.\n{CUT}M30\n"
    read = program(tmp_path, text, rotary="C,B")
    tilted, straight = (operation.path for operation in read.operations)
    c = np.cos(np.pi / 6)
    # about y by 30 deg, then about z by 90 deg
    turned = np.array([[0, -1, 0], [c, 0, 0.5], [-0.5, 0, c]])
    assert tilted.axis is not None
    assert np.allclose(tilted.axis, turned[:, 2])
    assert np.allclose(1e3 * tilted.position[1], turned @ [1, 2, 3])
    assert straight.axis is not None
    assert np.allclose(straight.axis, [0, 0, 1])
    assert np.allclose(1e3 * straight.position[-1], [1, 2, 3])
    with pytest.raises(InputError, match="state its rotations from part to tool"):
        program(tmp_path, text)
    # axes that stand at zero turn nothing
    assert len(program(tmp_path, f"G21 G90\nG254\n{CUT}M30\n").operations) == 1


def test_tool_centre_control_of_haas(tmp_path: Path) -> None:
    text = f"G21 G90 G54\nG0 B30. C0.\nG234 H7\n{CUT}X5. B60.\nG49\nM30\n"
    found = program(tmp_path, text, rotary="C,B").operation()
    assert found.path.axis is not None
    assert np.allclose(found.path.axis[-1], [np.sin(np.pi / 3), 0, 0.5])
    assert found.tool.length_offset == 7


@pytest.mark.parametrize(
    "block",
    ["G187 P3 E.01", "G187 E0.02 P1", "G332 R5", "G131 R2", "G61.1 ,A1", "$PART-1.MIN%", "OPRT"],
)
def test_smoothing_and_names_move_nothing(tmp_path: Path, block: str) -> None:
    found = program(tmp_path, f"G21 G90 G54\nG0 X0 Y0 Z9\n{block}\nG1 Z1 F60\nM30\n").operation()
    assert np.allclose(1e3 * found.path.position, [[0, 0, 9], [0, 0, 1]])


@pytest.mark.parametrize("block", ["G61", "G9", "G1 G9 X3", "G60", "G61.1"])
def test_exact_stops_are_said_not_to_be_made(tmp_path: Path, block: str) -> None:
    """They were listed as what moves nothing, and the corners were cut by the tolerance."""
    read = program(tmp_path, f"G21 G90 G54 G64\nG0 X0 Y0 Z9\nG1 F60 Z1\n{block}\nG1 X9\nM30\n")
    assert "exact stops, which are not made: corners may be cut" in str(read.of_kind("assumed"))
    assert "G64" in str(read.of_kind("ignored"))
    plain = program(tmp_path, "G21 G90 G54\nG0 X0 Y0 Z9\nG1 F60 Z1\nG4 P1\nX9\nM30\n")
    assert "exact" not in str(plain.notes)


def test_the_tools_length_of_okuma_is_no_work_frame(tmp_path: Path) -> None:
    text = "G21 G90\nG15 H1\nG0 X0 Y0\nG56 H4 Z50.\nG1 Z1 F60\nX5\nM2\n"
    read = program(tmp_path, text)
    assert np.allclose(1e3 * read.operation().path.position, [[0, 0, 50], [0, 0, 1], [5, 0, 1]])
    assert read.operation().tool.length_offset == 4
    assert "G56 H is the tool's length offset (Okuma)" in str(read.of_kind("assumed"))
    # beside G43 its H is the tool's, and G15 ends polar coordinates
    polar = "G21 G90 G54\nG0 X0 Y0 Z9\nG15 G43 H2 Z8\nG1 Z1 F60\nM2\n"
    assert program(tmp_path, polar).operation().tool.length_offset == 2
    both = "G21 G90\nG56\nG0 X0 Y0\nG43 G56 H4 Z50.\nG1 Z1 F60\nM2\n"
    assert "Okuma" not in str(program(tmp_path, both).notes)


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("G12 I5. F60.", "G12 is a circular pocket"),
        ("G150 P2000", "G150 is a pocket"),
        ("G268 X0 Y0 Z0 I0 J0 K0", "G268 is a tilted plane of Haas"),
        ("G44 H1 Z5.", "G44 is a tool's length with the other sign"),
    ],
)
def test_what_is_not_read_is_named(tmp_path: Path, block: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"G21 G90 G54\nG0 X0 Y0 Z9\n{block}\nG1 Z1 F60\nM30\n")


def test_further_work_frames_of_haas(tmp_path: Path) -> None:
    found = program(tmp_path, f"G21 G90 G110\n{CUT}M30\n")
    assert np.allclose(1e3 * found.operation().path.position, [[1, 2, 9], [1, 2, 3]])
    assert "G110 is a work frame of the control (Haas)" in str(found.of_kind("assumed"))
    with pytest.raises(InputError, match="G111 after motion in G110"):
        program(tmp_path, f"G21 G90 G110\n{CUT}G0 Z9.\nG111\n{CUT}M30\n")
    # on a control of Siemens it is a pole, on a lathe G112 turns XY to polar coordinates
    for text in (f"G110\nG1 X=5 F60\n{CUT}", f"G112\n{CUT}"):
        with pytest.raises(InputError, match="is a pole"):
            program(tmp_path, f"G21 G90 G0 X0 Y0 Z0\n{text}M30\n")


def test_okuma_goes_back_to_the_level_of_g71_after_each_hole(tmp_path: Path) -> None:
    """G71 Z was a move, and changed inches to millimetres; M53 was not carried out."""
    holes = "G81 X1. Y1. Z-.5 R.1 F10. M53\nX2.\nG80\n"
    text = f"G20 G90\nG0 X0. Y0. Z4.\nG71 Z2.\n{holes}G1 X3. F10.\nM2\n"
    found = program(tmp_path, text)
    inches = found.operation().path.position / 25.4e-3
    assert np.allclose(inches[:2], [[0, 0, 4], [1, 1, 4]])
    assert np.allclose(inches[2:5], [[1, 1, 0.1], [1, 1, -0.5], [1, 1, 2]])
    assert np.allclose(inches[-1], [3, 1, 2])
    assert "M53" not in str(found.notes)
    # M54 is the level of R
    lower = program(tmp_path, text.replace("X2.\n", "X2. M54\n")).operation().path.position
    assert np.allclose(lower[-2:] / 25.4e-3, [[2, 1, 0.1], [3, 1, 0.1]])
    # on other controls G71 is millimetres alone
    other = program(tmp_path, "G71 G90\nG0 X0. Y0. Z9.\nG1 G71 Z2. F60\nX5.\nM30\n")
    assert np.allclose(1e3 * other.operation().path.position[1], [0, 0, 2])
    with pytest.raises(InputError, match=r"M53 .Okuma. goes back to the level of G71"):
        program(tmp_path, text.replace("G71 Z2.\n", ""))
    with pytest.raises(InputError, match="top of the machine"):
        program(tmp_path, text.replace("X2.\n", "X2. M52\n"))


@pytest.mark.parametrize(("call", "times"), [("CALL O200", 1), ("CALL O0200 Q3", 3)])
def test_a_sub_program_of_okuma_is_called(tmp_path: Path, call: str, times: int) -> None:
    sub = "O200\nG91 G1 Y10\nG90\nRTS\n"
    text = f"$PART.MIN%\nO100\nG90 G0 X0 Y0 Z5\nG1 Z-1 F300\n{call}\nG0 Z50\nM2\n{sub}"
    found = 1e3 * program(tmp_path, text).operation().path.position
    assert np.allclose(found[-1], [0, 10 * times, 50])


@pytest.mark.parametrize("line", ["CALL O200 Q2 VC5=3", "MODIN O200", "VC1=5", "CALL O300"])
def test_calls_of_okuma_with_variables_are_refused(tmp_path: Path, line: str) -> None:
    with pytest.raises(InputError, match=r"line 3: found .*of calls on controls of Okuma"):
        program(tmp_path, f"O100\nG90 G0 X0 Y0 Z5\n{line}\nG1 Z0\nM2\nO200\nG91 G1 Y1\nRTS\n")
