"""G-code of small controls: LinuxCNC, GRBL, printers, jets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90 G17\n"


def test_torches_are_named_by_a_dollar(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G0 X0 Y0 Z1\nM3 $0 S1\nG1 X5 F900\nM5 $0\nG0 Z9\nM30\n")
    assert found.operations[-1].spindle.rpm == 1
    assert not any("$" in str(note) for note in found.notes)
    other = program(tmp_path, f"{HEAD}G0 X0 Y0 Z1\nM3 $1 S1\nG1 X5 F900\nM30\n")
    assert "$1: one of several spindles or torches" in str(other.of_kind("assumed"))


def test_the_kinematics_of_the_demos_are_tool_centre_control(tmp_path: Path) -> None:
    text = f"{HEAD}M428\nG0 X0 Y0 Z9 A0 C0\nG1 X5 Y0 Z1 A30 C90 F900\nM429\nM30\n"
    found = program(tmp_path, text, "C,A")
    assert np.allclose(1e3 * found.operation().path.position[[0, -1]], [[0, 0, 9], [5, 0, 1]])
    assert "M428 is tool centre control" in str(found.of_kind("assumed"))
    axis = found.operation().path.axis
    assert axis is not None
    assert np.allclose(axis[-1], [0.5, 0, np.cos(np.radians(30))])


def test_values_of_the_control_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 2: found #<_hal\[…\]>, a value of the control"):
        program(tmp_path, f"{HEAD}F#<_hal[plasmac.cut-feed-rate]>\nG1 X5\n")


def test_a_word_e_says_whose_it_may_be(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="3D printing, is a work frame on Fadal"):
        program(tmp_path, f"{HEAD}E1 X0 Y0 Z5\nG1 X5 F100\n")


def test_axes_without_numbers_go_home(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G28 X Y ; home\nG28 Z\nG0 X0 Y0 Z5\nG1 X5 F600\n")
    assert np.allclose(1e3 * found.operation().path.position, [[0, 0, 5], [5, 0, 5]])
    with pytest.raises(InputError, match="line 2: found 'X Y'"):
        program(tmp_path, f"{HEAD}G0 X Y\nG1 X5 F600\n")


def test_orders_to_grbl_itself_move_nothing(tmp_path: Path) -> None:
    orders = "$H\n$X ; unlock\n$$\n?\n$110=500\n"
    found = program(tmp_path, f"{orders}{HEAD}G0 X0 Y0 Z5\nG1 X5 F600\n")
    assert np.allclose(1e3 * found.operation().path.position, [[0, 0, 5], [5, 0, 5]])
    with pytest.raises(InputError, match="line 1: found '"):
        program(tmp_path, f"$J=X10 Y5 F100\n{HEAD}G0 X0 Y0 Z5\nG1 X5 F600\n")


def test_a_setting_of_a_printer_is_no_tool(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}M204 P500 R1000 T500\nG0 X0 Y0 Z5\nG1 X5 F600\n")
    assert found.operation().tool.number is None


@pytest.mark.parametrize(("start", "ends"), [("", "off"), ("M3 S1\n", "flood"), ("M9\n", "flood")])
def test_m8_ends_a_jet_where_no_m9_does(tmp_path: Path, start: str, ends: str) -> None:
    text = f"{HEAD}{start}G0 X0 Y0 Z0\nM7\nG1 X5 F600\nM8\nG0 X9\nM30\n"
    found = program(tmp_path, text)
    coolant = [event.text for event in found.operation().events if event.kind == "coolant"]
    assert coolant == ["mist", ends]
    assert ("M8 ends the jet" in str(found.of_kind("assumed"))) is (ends == "off")


def test_numbers_with_an_exponent_as_scripts_print_them(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G0 X0 Y0 Z5\nG1 X6.123e-17 Y-1.5e+01 Z5 F600\n")
    assert np.allclose(1e3 * found.operation().path.position[-1], [0, -15, 5])
    for pushed in ("E-5", "E0.5", "E-0.5", " E-10"):
        with pytest.raises(InputError, match="line 3: found the word E"):
            program(tmp_path, f"{HEAD}G0 X0 Y0 Z5\nG1 X1.5{pushed}\n")


def test_a_work_frame_that_the_file_sets_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 2: G10 is a change .* delete the line"):
        program(tmp_path, f"{HEAD}G10 L2 P1 X-315. Y-315. Z-689.\nG0 X0 Y0 Z5\nG1 X5 F600\n")


@pytest.mark.parametrize("order", [70, 71, 72, 73])
def test_modes_that_linuxcnc_keeps_and_brings_back_are_refused(tmp_path: Path, order: int) -> None:
    """M73 of other controls blows air or shows how far a print is."""
    sub = f"o<inches> sub\nM{order}\nG20 G91\nG1 X1 F9\no<inches> endsub\n"
    with pytest.raises(InputError, match=f"line 3: M{order} keeps G20, G91, F"):
        program(tmp_path, f"G0 X0 Y0 Z5\n{sub}o<inches> call\nG1 X20\nM2\n")
    found = program(tmp_path, f"{HEAD}G0 X0 Y0 Z5\nM{order}\nG1 X20 F9\nM2\n")
    assert f"M{order}: a function of the machine" in str(found.of_kind("assumed"))


def test_sub_programs_may_have_any_name(tmp_path: Path) -> None:
    sub = "o<hole-1 b> sub\nG1 X[#1] F600\no<hole-1 b> endsub\n"
    calls = "o<hole-1 b> call [20]\no<hole-1 b> call [30]\n"
    found = program(tmp_path, f"{sub}{HEAD}G0 X0 Y0 Z5\n{calls}M2\n")
    assert np.allclose(1e3 * found.operation().path.position[:, 0], [0, 20, 30])


@pytest.mark.parametrize("name", ["o<facing>", "o100"])
def test_a_file_of_a_sub_program_alone_says_so(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"line 1: .* that no line of the file calls"):
        program(tmp_path, f"{name} sub\n{HEAD}G0 X0 Y0 Z5\nG1 X5 F600\n{name} endsub\nM2\n")


def test_lengths_without_a_point_are_those_of_the_unit_on_linuxcnc(tmp_path: Path) -> None:
    file = tmp_path / "part.ngc"
    file.write_text(f"{HEAD}G0 X0 Y0 Z5\nG1 X5 F600\nM2\n")
    assert "decimal point" not in str(read_program(file).notes)
    assert "decimal point" in str(program(tmp_path, file.read_text()).notes)


@pytest.mark.parametrize(
    ("line", "said"),
    [("G1 X5; N30 G1 Y5;", True), ("G1 X5 ; F100 X9 Y2", True), ("G1 X5 ; to X9", False),
     ("; G1 X9", False), ("G1 X5 (G1 X9)", False), ("G1 X5 ; 3 mm", False)],
)  # fmt: skip
def test_a_block_behind_a_semicolon_is_said_to_be_left_out(
    tmp_path: Path, line: str, said: bool
) -> None:
    text = f"G21 G90\nG0 X0 Y0 Z5\nG1 Z0 F100\n{line}\nG1 X5 Y0\nG1 X7\nM30\n"
    read = program(tmp_path, text)
    assert np.isclose(1e3 * read.operation().path.position[:, 1], 0).all()
    notes = " ".join(map(str, read.of_kind("assumed")))
    assert ("line 4: what stands behind ; is a comment" in notes) is said
