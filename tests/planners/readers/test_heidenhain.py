"""Heidenhain's plain language: straight moves, arcs, feeds, datums, planes, tool axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from gcode_files import program as gcode

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program

Array = npt.NDArray[np.float64]
HEAD = "0 BEGIN PGM PART MM\n1 TOOL CALL 3 Z S2000\n2 L X+0 Y+0 R0 FMAX M3\n3 L Z+9 R0 FMAX\n"


def program(tmp_path: Path, body: str, rotary: str | None = None, head: str = HEAD) -> CamProgram:
    file = tmp_path / "part.h"
    file.write_text(f"{head}{body}99 END PGM PART MM\n")
    return read_program(file, rotary=rotary)


def points(tmp_path: Path, body: str, rotary: str | None = None) -> Array:
    """[mm]"""
    return np.asarray(1e3 * program(tmp_path, body, rotary).operations[-1].path.position)


def test_lines_feeds_and_what_the_machine_is_told(tmp_path: Path) -> None:
    body = (
        "4 * - OUTSIDE\n5 L Z-1,5 F120 M8\n6 L IX+10 ; and so on\n7 L X+10 Y+5 Z+9 FMAX\n"
        "8 L Z-1.5 F240\n9 L Y+0\n10 L M5\n11 M30\n12 L X+99 F10\n"
    )
    read = program(tmp_path, body)
    found = read.operation()
    expected = [[0, 0, 9], [0, 0, -1.5], [10, 0, -1.5], [10, 5, 9], [10, 5, -1.5], [10, 0, -1.5]]
    assert np.allclose(1e3 * found.path.position, expected)
    assert np.allclose(1e3 * found.path.feed, [np.inf, 2, 2, np.inf, 4, 4])
    assert (found.name, found.tool.number) == ("OUTSIDE", 3)
    assert found.spindle.rpm == pytest.approx(2000)
    assert (read.dialect, read.units) == ("Heidenhain", "mm")
    assert [event.text for event in found.events if event.kind != "tool"] == ["flood", "off"]


def test_comments_and_blocks_over_several_lines(tmp_path: Path) -> None:
    body = "4 ; a machine with axes on the~\n Head\n5 L X+5~\n  Y+6 ;there ~\n  F60\n"
    found = program(tmp_path, body).operation().path
    assert np.allclose(1e3 * found.position[-1], [5, 6, 9])
    assert found.feed[-1] == pytest.approx(1e-3)


@pytest.mark.parametrize("unit", ["INCH", "IN"])
def test_inches_and_their_feeds(tmp_path: Path, unit: str) -> None:
    text = HEAD.replace("PART MM", f"PART {unit}")
    read = program(tmp_path, "4 L Z-1 F300\n5 L X+2\n", head=text)
    assert np.allclose(read.operation().path.position[-1], [2 * 25.4e-3, 0, -25.4e-3])
    # tenths of an inch per minute
    assert read.operation().path.feed[-1] == pytest.approx(30 * 25.4e-3 / 60)
    assert "feeds are in tenths of inch/min" in str(read.of_kind("assumed"))


def test_another_unit_is_asked_about(tmp_path: Path) -> None:
    head = HEAD.replace("PART MM", "PART")
    with pytest.raises(InputError, match="line 1: found 'BEGIN PGM PART', expected BEGIN PGM"):
        program(tmp_path, "4 L Z-1 F300\n", head=head)
    assert read_program(tmp_path / "part.h", units="inch").units == "inch"


@pytest.mark.parametrize(
    ("blocks", "same"),
    [
        ("L X+10\nCC X+10 Y+10\nC X+20 Y+10 DR+\n", "G1 X10\nG3 X20 Y10 I0 J10\n"),
        ("L X+10\nCC X+10 Y+10\nC X+20 Y+10 DR-\n", "G1 X10\nG2 X20 Y10 I0 J10\n"),
        ("L X+10\nCC IX+0 IY+10\nC X+10 Y+0 DR+\n", "G1 X10\nG3 X10 Y0 I0 J10\n"),
        ("L X+10\nCR X+20 Y+10 R+10 DR-\n", "G1 X10\nG2 X20 Y10 R10\n"),
        ("L X+10\nCR X+20 Y+10 R-10 DR-\n", "G1 X10\nG2 X20 Y10 R-10\n"),
        ("L X+10\nCC X+10 Y+10\nCP IPA+90 DR+\n", "G1 X10\nG3 X20 Y10 I0 J10\n"),
        ("L X+10\nCC X+10 Y+10\nCP PA+0 DR+\n", "G1 X10\nG3 X20 Y10 I0 J10\n"),
        ("L X+10\nCC X+10 Y+10\nCP IPA-360\n", "G1 X10\nG2 X10 Y0 I0 J10\n"),
        ("L X+10\nCC X+10 Y+10\nCP IPA+810 IZ-6 DR+\n", "G1 X10\nG3 X20 Y10 Z-5 I0 J10 P3\n"),
        ("L X+10\nCC X+9 Z+1\nCP IPA+90 DR+\n", "G1 X10\nG18 G3 X9 Z0 I-1 K0\n"),
        (
            "CC X+0 Z+0\nL X+1\nL X+10\nCR X+20 Y+10 R+10 DR+\n",
            "G1 X1\nX10\nG3 X20 Y10 R10\n",
        ),
        ("CR X+10 Z-9 R+10 DR+\n", "G18 G3 X10 Z-9 R10\n"),
        ("L X+10\nCC X+0 Y+0\nLP PR+20 PA+90\nLP IPA+90\n", "G1 X10\nX0 Y20\nX-20 Y0\n"),
    ],
)
def test_arcs_and_polar_places_as_in_g_code(tmp_path: Path, blocks: str, same: str) -> None:
    found = program(tmp_path, f"L Z+1 F600\n{blocks}").operation().path
    head = "G21 G90\nG0 X0 Y0 Z9\nG1 Z1 F600\n"
    expected = gcode(tmp_path, f"{head}{same}M30\n").operation().path
    assert np.allclose(found.position, expected.position, atol=1e-9)
    assert np.allclose(found.feed, expected.feed)


def test_datum_shift_and_rotation(tmp_path: Path) -> None:
    shifted = "CYCL DEF 7.0 DATUM\nCYCL DEF 7.1 X+ 100\nCYCL DEF 7.2 IY+50\n"
    turned = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n"
    back = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0\nCYCL DEF 7.0 DATUM\nCYCL DEF 7.1 X+0 Y+0\n"
    found = points(tmp_path, f"{shifted}{turned}L X+2 Y+0 Z+1 F60\n{back}L X+3 Y+0 Z+1\n")
    assert np.allclose(found[-2:], [[100, 52, 1], [3, 0, 1]])


TILTED = [0.5, 0.0, np.sqrt(0.75)]


@pytest.mark.parametrize(
    ("plane", "first"),
    [
        ("PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN MB MAX FMAX SEQ- TABLE ROT", (0.8660254, 0, -0.5)),
        ("PLANE AXIAL B+30 C+0 TURN FMAX", (0.8660254, 0, -0.5)),
        ("PLANE EULER EULPR+90 EULNU+30 EULROT-90 TURN FMAX", (0.8660254, 0, -0.5)),
        ("PLANE VECTOR BX+0 BY+1 BZ+0 NX+0.5 NY+0 NZ+0.8660254 TURN FMAX", (0, 1, 0)),
        ("PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY\nL B+Q121 C+Q122 FMAX", (0.8660254, 0, -0.5)),
    ],
)
def test_tilted_planes(tmp_path: Path, plane: str, first: tuple[float, ...]) -> None:
    body = f"CYCL DEF 7.1 X+100\n{plane}\nL X+10 Y+0 FMAX\nL Z+5 FMAX\nL Z+0 F60\n"
    read = program(tmp_path, f"{body}L Z+5 FMAX\nPLANE RESET TURN FMAX\nCYCL DEF 7.1 X+0\n", "C,B")
    found = read.operations[-1].path
    assert found.axis is not None
    assert np.allclose(found.axis, TILTED)
    origin = np.array([100.0, 0, 0])
    assert np.allclose(1e3 * found.position[1], origin + 10 * np.array(first), atol=1e-5)
    assert np.allclose(1e3 * found.position[0], 1e3 * found.position[1] + 5 * np.array(TILTED))


def test_angles_in_space_turn_about_the_fixed_axes(tmp_path: Path) -> None:
    plane = "PLANE SPATIAL SPA+90 SPB+0 SPC+180 TURN FMAX\n"
    found = program(tmp_path, f"{plane}L X+1 Y+2 Z+9 FMAX\nL Z+3 F60\n").operations[-1].path
    assert found.axis is not None
    assert np.allclose(found.axis, [0, 1, 0])
    assert np.allclose(1e3 * found.position[-1], [-1, 3, 2])


def test_a_plane_that_the_tool_is_not_turned_to(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a cut in a tilted plane \(STAY\) that the tool is not"):
        program(tmp_path, "PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY\nL X+0 Y+0 Z+1 FMAX\nL Z+0 F9\n")


def test_tool_axes_with_tool_centre_control(tmp_path: Path) -> None:
    body = "L Z+1 F60 M128\nL X+5 B+30 C+90\nL IB+10\n"
    found = program(tmp_path, body, "C,B").operation().path.axis
    assert found is not None
    assert np.allclose(found[-2:], [[0, 0.5, np.sqrt(0.75)], [0, *np.sin(np.radians([40, 50]))]])
    space = "FUNCTION TCPM F TCP AXIS SPAT PATHCTRL AXIS\nL X+5 A+0 B+30 C+90 F60\n"
    found = program(tmp_path, space).operation().path.axis
    assert found is not None
    assert np.allclose(found[-1], [0, 0.5, np.sqrt(0.75)])
    vector = "M128\nLN X+5 Y+0 Z+1 NX+0 NY+0 NZ+1 TX+0.6 TY+0 TZ+0.8 F60\nL X+9\n"
    found = program(tmp_path, vector).operation().path.axis
    assert found is not None
    assert np.allclose(found[-2:], [0.6, 0, 0.8])
    with pytest.raises(InputError, match="state its rotations from part to tool"):
        program(tmp_path, body)


def test_without_an_axis_the_tool_stands_across_the_surface(tmp_path: Path) -> None:
    across = "LN X+5 Y+0 Z+1 NX+0 NY+0.6 NZ+0.8 F60\n"
    read = program(tmp_path, f"M128\n{across}")
    found = read.operation().path.axis
    assert found is not None
    assert np.allclose(found[-1], [0, 0.6, 0.8])
    assert "the tool stands across the surface" in " ".join(map(str, read.of_kind("assumed")))
    # without tool centre control the control turns nothing
    found = program(tmp_path, across).operation().path.axis
    assert found is not None
    assert np.allclose(found, [0, 0, 1])


def test_what_ends_with_tool_centre_control(tmp_path: Path) -> None:
    space = "FUNCTION TCPM F TCP AXIS SPAT\nL Z+1 A+0 B+30 C+90 F60\nL A+0 B+0 C+0\n"
    body = f"{space}FUNCTION RESET TCPM\nM128\nL X+5 B+30 C+90\n"
    # the machine's axes again, C then B the other way
    path = program(tmp_path, body, "-C,B").operation().path
    assert path.axis is not None
    up = int(np.argmax(np.isclose(path.position[:, 2], 1e-3)))
    assert np.allclose(path.axis[[up, -1]], [[0, 0.5, np.sqrt(0.75)], [0, -0.5, np.sqrt(0.75)]])
    upright = "M128\nLN X+5 TX+0.6 TY+0 TZ+0.8 F60\nM129\nL B+0 C+0 FMAX M91\nL X+0 Y+0 Z+9 FMAX\n"
    found = program(tmp_path, f"{upright}L Z+1 F60\n").operations[-1].path.axis
    assert found is not None
    assert np.allclose(found[-1], [0, 0, 1])
    # the F behind M128 is that of its own turning
    read = program(tmp_path, "L Z+1 F60 M128 F9000\nL X+5\n").operation()
    assert np.allclose(1e3 * read.path.feed[-1], 1)


def test_steps_of_datum_and_rotation(tmp_path: Path) -> None:
    body = "CYCL DEF 7.1 X+10\nCYCL DEF 7.1 IX+5\nCYCL DEF 10.1 ROT+30\nCYCL DEF 10.1 IROT+60\n"
    assert np.allclose(points(tmp_path, f"{body}L X+2 Y+0 Z+1 F60\n")[-1], [15, 2, 1])


def test_angles_under_tool_centre_control_are_none_of_the_plane(tmp_path: Path) -> None:
    plane = "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nL X+0 Y+0 Z+9 FMAX\nM128\n"
    found = program(tmp_path, f"{plane}L Z+5 B+30 C+0 F60\nL X+5\n", "C,B").operation().path.axis
    assert found is not None
    assert np.allclose(found, TILTED)
    with pytest.raises(InputError, match="the tilted plane and its angles"):
        program(tmp_path, f"{plane}L Z+5 B+0 C+0 F60\n", "C,B")
    with pytest.raises(InputError, match="state its rotations from part to tool"):
        program(tmp_path, f"{plane}L Z+5 B+30 C+0 F60\n")


def test_words_that_are_no_places_and_names_that_end_nothing(tmp_path: Path) -> None:
    body = "L Z+1 F60 M118 X0.2 Z5\nQ1 = 7\nTOOL CALL Q1 Z SQ1\nL X+0 Y+0 Z+9 FMAX\n"
    body += 'TOOL CALL "BOHRER M2" Z S600 F120\nL X+0 Y+0 Z+5 FMAX\nL X+4 FAUTO\n'
    read = program(tmp_path, f"{body}L X+5\n")
    assert np.allclose(1e3 * read.operations[0].path.position[-1], [0, 0, 1])
    assert [operation.tool.name for operation in read.operations][-1] == "BOHRER M2"
    assert np.allclose(1e3 * read.operations[-1].path.position[-1], [5, 0, 5])
    assert np.allclose(1e3 * read.operations[-1].path.feed[-1], 2)
    with_number = f"{HEAD}Q1 = 7\nTOOL CALL Q1 Z SQ1\nL X+0 Y+0 Z+9 FMAX M3\nL Z+1 F60\n"
    found = program(tmp_path, "", head=with_number).operations[-1]
    assert (found.tool.number, round(found.spindle.rpm)) == (7, 7)


def test_feeds_per_turn_in_inches(tmp_path: Path) -> None:
    head = HEAD.replace("PART MM", "PART INCH")
    found = program(tmp_path, "L Z-1 FU0.01\n", head=head).operation().path.feed[-1]
    assert found == pytest.approx(0.01 * 25.4e-3 * 2000 / 60)
    with pytest.raises(InputError, match="M136 in a program in INCH"):
        program(tmp_path, "L Z-1 F2 M136\n", head=head)


def test_the_datum_of_newer_controls(tmp_path: Path) -> None:
    moved = "TRANS DATUM AXIS X+100 Y+50\nL X+0 Y+0 Z+1 FMAX\nTRANS DATUM AXIS IX+5\nL X+0 F60\n"
    found = program(tmp_path, f"{moved}TRANS DATUM RESET\nL X+0\n").operation().path.position
    assert np.allclose(1e3 * found[-3:, :2], [[100, 50], [105, 50], [0, 50]])
    for order, says in {
        "DATUM TABLE TABLINE5": "from a table",
        "MIRROR AXIS X": "a frame that is mirrored, turned or scaled",
    }.items():
        with pytest.raises(InputError, match=says):
            program(tmp_path, f"TRANS {order}\nL X+5 F60\n")


def test_another_preset_ends_the_datum_shift(tmp_path: Path) -> None:
    preset = "CYCL DEF 247 PRESET ~\nQ339=+1\n"
    body = f"{preset}CYCL DEF 7.1 X+100\nL X+0 Y+0 Z+9 FMAX\n{preset}L X+5 Y+0 Z+1 FMAX\n"
    head = HEAD.split("2 L")[0]
    found = program(tmp_path, f"{body}L X+9 F60\n", head=head).operation().path.position
    assert np.allclose(1e3 * found, [[100, 0, 9], [5, 0, 1], [9, 0, 1]])


def test_places_of_the_machine(tmp_path: Path) -> None:
    body = "L Z-1 F60\nL Z+0 R0 FMAX M91\nL X+5 Y+5 R0 FMAX\nL Z+9 FMAX\nL Z-2 F60\nL M140 MB50\n"
    read = program(tmp_path, body)
    assert [len(operation.path) for operation in read.operations] == [2, 3]
    assert 1e3 * read.operations[-1].path.position[-1, 2] == pytest.approx(48)
    # in a tilted plane the machine's Z moves along all of its axes
    tilted = "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nL X+0 Y+0 Z+5 FMAX\nL Z-1 FMAX M91\n"
    with pytest.raises(InputError, match=r"X and Y of the tool is not stated yet; expected .*FMAX"):
        program(tmp_path, f"{tilted}L Z+5 FMAX\nL Z+0 F60\n")
    assert "M91, M92: places of the machine tool" in str(read.of_kind("assumed"))


@pytest.mark.parametrize(
    ("blocks", "says"),
    [
        ("L X+5 RL F60\n", "line 5: RL is the offset by the tool's radius, .* the wear alone"),
        ("L X+5 F60\nRND R2\n", "a rounded corner; let the CAM system write the arc"),
        ("APPR LT X+5 Y+5 LEN5 RL F9\n", "an approach that the control makes"),
        ("CT X+5 Y+5\n", "an arc by its tangent"),
        ("LN X+5 Y+0 Z+1 TX+0 TY+0.6 TZ+0.8 F60\n", "without M128 or FUNCTION TCPM"),
        ("C X+5 Y+5 DR+\n", "an arc without its centre; expected CC"),
        ("CC X+5 Y+0\nCP IPA+90 DR-\n", "turn against each other"),
        ("FUNCTION TCPM F TCP AXIS POS REFPNT CENTER-CENTER\n", "places of the ball's centre"),
        ("M128\nLN X+5 TX+0.6 TY+0 TZ+0.8 F60\nM129\nL X+9\n", "or by TX, TY, TZ before M129"),
        (
            "FUNCTION TCPM F TCP AXIS POS\nLN X+5 TX+0.6 TY+0 TZ+0.8 F60\nFUNCTION RESET TCPM\n"
            "L X+9\n",
            "or by TX, TY, TZ before M129",
        ),
        ("CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X\n", "CYCL DEF 8 is mirroring"),
        ("CYCL DEF 19.0 PLANE\nCYCL DEF 19.1 A+30\n", "expected PLANE SPATIAL"),
        ("CYCL DEF 7.0 DATUM\nCYCL DEF 7.1 #5\n", "takes its datum from a table of the control"),
        ("PLANE RELATIV SPB+5 TURN\n", "PLANE RELATIV is not read; expected PLANE SPATIAL"),
        ("CALL PGM TNC:\\A.H\n", "a program of another file"),
        ("TCH PROBE 427\n", "a probe"),
        ("L X+Q5 F60\n", "found Q5, which the file does not set before"),
        ("FN 18: SYSREAD Q1 = ID20\n", "asks or tells the control"),
        ("Q1 = 1 /\n", "is no formula that is read"),
        ("CALL LBL 7\n", "LBL 7 is not in the file"),
        ("L X+5 FZ0.1\n", "a feed per tooth"),
        ("L X+5 X+6 F60\n", "found X twice in one block"),
        ("L X+5 WOBBLE\n", "found 'WOBBLE', expected words such as X"),
        ("L X+5 PR+3 F60\n", "found PR in a block L, which it is no word of"),
        ("PLANE SPATIAL SPA+0 SPB+Q121 SPC+0 TURN\n", r"found 'SPB\+Q121' in PLANE"),
        ("PLANE EULER EULPR+0 EULNUT+30 EULROT+0 TURN\n", r"found 'EULNUT\+30' in PLANE"),
        (
            "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nL X+0 Y+0 Z+5 FMAX M130\n",
            "M130 states a place in the untilted coordinates",
        ),
        (
            "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nCC X+0 Y+0\nLP PA+30 FMAX\n",
            "a polar step from a place that is not stated",
        ),
        (
            "CYCL DEF 7.1 X+9\nPLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nCYCL DEF 7.1 Z+5\n",
            "how the two add up is not known here",
        ),
        (
            "PLANE SPATIAL SPA+0 SPB+30 SPC+0 TURN\nL X+0 Y+0 Z+5 FMAX\nPLANE RESET STAY\n"
            "L X+9 F60\n",
            r"turned to a plane that was left \(RESET STAY\)",
        ),
        ("LBL 1\nCALL LBL 1 REP Q5\n", "found 'CALL LBL 1 REP Q5', expected CALL LBL 1"),
        ("TOOL CALL 5 Y S100\n", "with the tool axis Y; expected Z"),
        ("FUNCTION MODE TURN\n", "which is not read"),
        ("WOBBLE\n", "found 'WOBBLE': not known; not read"),
    ],
)
def test_what_is_not_read_says_so(tmp_path: Path, blocks: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, blocks)


def test_what_shows_angles_or_parallel_axes_moves_nothing(tmp_path: Path) -> None:
    cut = "5 L Z-1 F60\n6 L X+9\n"
    told = f"4 FUNCTION PARAXCOMP DISPLAY Z W\n4 M94 C\n4 L M94 B C R0 FMAX\n{cut}"
    assert np.allclose(points(tmp_path, told), points(tmp_path, cut))
    with pytest.raises(InputError, match="found 'C'"):
        program(tmp_path, f"4 M126 C\n{cut}")
