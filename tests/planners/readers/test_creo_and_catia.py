"""Creo NCL and CATIA aptsource: what they say in comments, their arcs and their holes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program

CREO = """$$*          Pro/CLfile  Version 8.0 - 8.0.3.0
$$-> MFGNO / PART1
PARTNO / PART1
$$-> FEATNO / 41
MACHIN / UNCX01, 1
UNITS / MM
LOADTL / 4, OSETNO, 9
$$-> CUTTER / 8.000000
$$-> CSYS / 1.0000000000, 0.0000000000, 0.0000000000, 5.0000000000,  $
            0.0000000000, 1.0000000000, 0.0000000000, 6.0000000000,  $
            0.0000000000, 0.0000000000, 1.0000000000, 7.0000000000
SPINDL / RPM, 4000.000000,  CLW
"""
CATIA = """$$ -----------------------------------------------------------------
$$     Généré le jeudi
$$     CATIA APT VERSION 1.0
$$*CATIA0
$$ Programme.1
$$     1.00000     0.00000     0.00000   -20.00000
$$     0.00000     1.00000     0.00000   -30.00000
$$     0.00000     0.00000     1.00000    40.00000
PARTNO PART 1, SIDE A
$$ OPERATION NAME : Changement outil.1
CUTTER/ 12.000000,  0.500000,  5.500000,  0.500000,  0.000000,$
         0.000000, 60.000000
TOOLNO/5,   12.000000
TPRINT/T5 Fraise D12
LOADTL/5
$$ OPERATION NAME : Contour.1
SPINDL/ 3000.0000,RPM,CLW
FEDRAT/  240.0000,MMPM
"""


def creo(tmp_path: Path, body: str) -> CamProgram:
    file = tmp_path / "part.ncl.12"
    file.write_text(CREO + body + "$$-> END /\nFINI\n")
    return read_program(file)


def catia(tmp_path: Path, body: str) -> CamProgram:
    file = tmp_path / "part.aptsource"
    file.write_text(CATIA + body + "REWIND/0\nEND\n", encoding="latin-1")
    return read_program(file)


def test_creo_head(tmp_path: Path) -> None:
    read = creo(
        tmp_path, "RAPID\nGOTO / 1.0, 2.0, 30.0\nFEDRAT / 90.0, MMPM\nGOTO / 1.0,$\n2.0, 3\n"
    )
    operation = read.operation()
    assert read.dialect == "Creo NCL"
    assert operation.name == "feature 41"
    assert operation.tool.number == 4
    assert operation.tool.length_offset == 9
    assert operation.tool.diameter == pytest.approx(8e-3)
    assert operation.frame is not None
    assert np.allclose(operation.frame[:3, 3], [5e-3, 6e-3, 7e-3])
    assert np.allclose(1e3 * operation.path.position, [[1, 2, 30], [1, 2, 3]])
    assert operation.path.feed[1] == pytest.approx(1.5e-3)


def test_creo_arc_turns_right_handed_through_all_its_points(tmp_path: Path) -> None:
    points = [(10 * np.cos(a), 10 * np.sin(a)) for a in np.radians([100, 200, 300])]
    rows = "".join(f"GOTO / {x:.10f}, {y:.10f}, 4.0\n" for x, y in points)
    body = f"GOTO / 10, 0, 4\nCIRCLE / 0.0, 0.0, 4.0, $\n0, 0, 1.0, 10.0\n{rows}GOTO / 20, -20, 4\n"
    operation = creo(tmp_path, body).operation()
    p = 1e3 * operation.path.position
    on_circle = p[:-1]
    assert np.allclose(np.linalg.norm(on_circle[:, :2], axis=1), 10, atol=1e-8)
    angle = np.degrees(np.unwrap(np.arctan2(on_circle[:, 1], on_circle[:, 0])))
    assert angle[-1] - angle[0] == pytest.approx(300)
    assert (np.diff(angle) > 0).all()
    # chords of 0.05 mm under radius 10, not the straight ways between the three points
    assert np.diff(angle).max() < 12


def on_a_circle(*degrees: float) -> str:
    """GOTO/ to places on the circle of radius 10 about the zero."""
    places = [(10 * np.cos(a), 10 * np.sin(a)) for a in np.radians(degrees)]
    return "".join(f"GOTO / {x:.10f}, {y:.10f}, 4.0\n" for x, y in places)


@pytest.mark.parametrize("sense", [1, -1])
def test_an_arc_without_an_axis_goes_the_shorter_way(tmp_path: Path, sense: int) -> None:
    body = f"{on_a_circle(0)}CIRCLE / 0, 0, 4, 10\n{on_a_circle(sense * 45, sense * 90)}"
    program = creo(tmp_path, body)
    p = program.operation().path.position
    angle = np.degrees(np.arctan2(p[:, 1], p[:, 0]))
    assert (np.diff(sense * angle) > 0).all()
    assert sense * angle[-1] == pytest.approx(90)
    assert "without i,j,k: the shorter way" in str(program.of_kind("assumed"))


def test_creo_points_against_the_axis_of_their_arc_are_refused(tmp_path: Path) -> None:
    """They would be passed after nearly a turn each."""
    body = f"{on_a_circle(0)}CIRCLE / 0, 0, 4, 0, 0, -1, 10\n{on_a_circle(45, 90)}"
    with pytest.raises(InputError, match="go round more than once about its i,j,k"):
        creo(tmp_path, body)


def test_creo_a_place_on_the_circle_behind_a_whole_turn_is_none_of_the_arc(tmp_path: Path) -> None:
    body = f"{on_a_circle(0)}CIRCLE / 0, 0, 4, 0, 0, 1, 10\n{on_a_circle(120, 240, 360, 180)}"
    p = 1e3 * creo(tmp_path, body).operation().path.position
    assert np.allclose(p[-2:], [[10, 0, 4], [-10, 0, 4]], atol=1e-6)


def test_creo_leaves_out_an_axis_along_z(tmp_path: Path) -> None:
    """Its next feature of three axes was cut with the tool inclined as in the one before."""
    body = (
        "MULTAX / ON\nGOTO / 0, 0, 9, 0.6, 0, 0.8\nFEDRAT / 100, MMPM\n"
        "GOTO / 0, 0, 0, 0.6, 0, 0.8\nGOTO / 9, 0, 0\nGOTO / 9, 5, 0, 0, 0.6, 0.8\n"
    )
    found = creo(tmp_path, body)
    axes = found.operation().path.axis
    assert axes is not None
    expected = [[0.6, 0, 0.8], [0.6, 0, 0.8], [0, 0, 1], [0, 0.6, 0.8]]
    assert np.allclose(axes, expected)
    assert "points without i,j,k: the tool stands along z" in str(found.of_kind("assumed"))
    upright = creo(tmp_path, "GOTO / 0, 0, 9\nFEDRAT / 100, MMPM\nGOTO / 0, 0, 0\n")
    assert "without i,j,k" not in str(upright.of_kind("assumed"))


def test_creo_points_of_an_arc_on_lines_of_their_own(tmp_path: Path) -> None:
    body = (
        "GOTO / 10, 0, 4\nCIRCLE / 0, 0, 4, 0, 0, -1, 10\n"
        "GOTO / 0, -10, 4\n-10, 0, 4\n0, 10, 4\nFEDRAT / 5, IPM\nGOTO / 10, 0, 4\n"
    )
    p = 1e3 * creo(tmp_path, body).operation().path.position
    # three quarters of a turn clockwise, then a straight cut: FEDRAT/ ended the arc
    assert np.allclose(np.linalg.norm(p[:-1, :2], axis=1), 10)
    middle = (p[-1] + p[-2]) / 2
    assert np.allclose(p[-2:], [[0, 10, 4], [10, 0, 4]], atol=1e-9)
    assert np.allclose(middle[:2], [5, 5])


def test_creo_helix_from_its_help_page(tmp_path: Path) -> None:
    body = (
        "GOTO / 8.198, 0.0, -.625\nCIRCLE / 8.0, 0.0, -0.625, $ $$ 1ST ORBIT\n"
        "0.0, 0.0, 1.0, 0.198\nGOTO / 8.198, 0.0, -0.583333\n"
    )
    p = 1e3 * creo(tmp_path, body).operation().path.position
    assert p[-1, 2] == pytest.approx(-0.583333)
    assert np.allclose(np.linalg.norm(p[:, :2] - [8, 0], axis=1), 0.198)
    assert len(p) > 5


@pytest.mark.parametrize(("words", "heights"), [
    # point at z = 10; approach from 30
    ("DRILL, DEPTH, 6.0, MMPM, 90.0, CLEAR, 2.0", [30, 12, 4, 12]),
    ("DRILL, DEPTH, 6.0, MMPM, 90.0, CLEAR, 5.0, RAPTO, 3.0", [30, 12, 4, 15]),
    ("DRILL, DEPTH, 6.0, MMPM, 90.0, CLEAR, 2.0, RETURN, 9.0", [30, 12, 4, 19]),
    ("DRILL, DEPTH, 6.0, MMPM, 90.0, CLEAR, 2.0, RETURN, 0", [30, 12, 4, 30]),
    ("TAP, DEPTH, 6.0, MMPM, 90.0, TPI, 20, CLEAR, 2.0", [30, 12, 4, 12]),
    ("BRKCHP, DEPTH, 6.0, STEP, 5, MMPM, 90.0, CLEAR, 2.0", [30, 12, 7, 7.254, 4, 12]),
    ("DEEP, DEPTH, 6.0, STEP, 5, STEP, 2, MMPM, 90.0, CLEAR, 2.0",
     [30, 12, 7, 12, 7.254, 5, 12, 5.254, 4, 12]),
    ("DRILL, 6.0, 90.0, MMPM, 2.0", [30, 12, 4, 12]),
])  # fmt: skip
def test_creo_cycles_point_by_point(tmp_path: Path, words: str, heights: list[float]) -> None:
    body = f"RAPID\nGOTO / 1, 1, 30\nCYCLE / {words}\nGOTO / 1, 1, 10\nCYCLE / OFF\n"
    operation = creo(tmp_path, body).operation()
    assert np.allclose(1e3 * operation.path.position[:, 2], heights)
    cuts = operation.path.feed[~operation.rapid]
    assert np.allclose(cuts, 1.5e-3)
    # a tap comes out at feed, a drill rapidly
    assert operation.rapid[-1] == (not words.startswith("TAP"))


def test_creo_points_on_the_edge_of_the_part_are_refused(tmp_path: Path) -> None:
    body = "$$-> CUTCOM_GEOMETRY_TYPE / OUTPUT_ON_PROFILE\nGOTO / 0, 0, 9\n{}GOTO / 50, 0, 9\n"
    assert len(creo(tmp_path, body.format("")).operation().path) == 2
    with pytest.raises(InputError, match=r"line 15: CUTCOM/ with OUTPUT_ON_PROFILE"):
        creo(tmp_path, body.format("CUTCOM / LEFT, 1\n"))


def test_creo_splines_are_read_by_their_points(tmp_path: Path) -> None:
    body = (
        "GOTO / 0, 0, 0\nMOVNRB / M3AXIS\nMOVNRB / ON,4,8,0,4,30\nMOVNRB / 1,0,0,0,0,1,1,1,1\n"
        "MOVNRB / 2,0,0,0,9,0,0,9,9,0,20,9,0\nMOVNRB / NEXT\n{}MOVNRB / OFF\n"
    )
    points = "GOTO / 9, 3, 0\nGOTO / 20, 9, 0\n"
    assert len(creo(tmp_path, body.format(points)).operation().path) == 3
    with pytest.raises(InputError, match="without points after MOVNRB/NEXT"):
        creo(tmp_path, body.format("") + points)


def test_catia_head(tmp_path: Path) -> None:
    read = catia(tmp_path, "RAPID\nGOTO  /   1.0, 2.0, 30.0, 0.0, 0.0, 1.0\nGOTO/1,2,3\n")
    operation = read.operation()
    assert read.dialect == "CATIA aptsource"
    assert operation.name == "Contour.1"
    assert operation.tool.number == 5
    assert operation.tool.name == "T5 Fraise D12"
    assert operation.tool.diameter == pytest.approx(12e-3)
    assert operation.tool.length == pytest.approx(60e-3)
    assert operation.frame is not None
    assert np.allclose(operation.frame[:3, 3], [-0.02, -0.03, 0.04])
    assert operation.spindle.rpm == pytest.approx(3000)


def test_catia_drilling_with_bare_numbers(tmp_path: Path) -> None:
    body = "RAPID\nGOTO/9,8,25,0,0,1\nCYCLE/DRILL,    3.0,    5.0\nGOTO/9,8,20,0,0,1\nCYCLE/OFF\n"
    operation = catia(tmp_path, body).operation()
    assert np.allclose(1e3 * operation.path.position[:, 2], [25, 17, 25])
    assert operation.path.feed[1] == pytest.approx(4e-3)


@pytest.mark.parametrize(("words", "z", "feed"), [
    ("DRILL, 3.0, MMPM, 90.0, 5.0", [25, 17, 25], 1.5),
    ("DRILL, 3.0, 5.0, MMPM, 90.0", [25, 17, 25], 1.5),
    ("DRILL, 3.0, 90.0, MMPM", [25, 20, 17, 20], 1.5),
    ("DRILL, DEPTH, 3.0, CLEAR, 2.0, 90.0, MMPM", [25, 22, 17, 22], 1.5),
    ("REAM, 3.0, 5.0, DWELL, 2.0", [25, 17, 25], 4.0),
])  # fmt: skip
def test_bare_numbers_beside_a_unit(
    tmp_path: Path, words: str, z: list[float], feed: float
) -> None:
    body = f"RAPID\nGOTO/9,8,25,0,0,1\nCYCLE/{words}\nGOTO/9,8,20,0,0,1\nCYCLE/OFF\n"
    read = catia(tmp_path, body)
    operation = read.operation()
    assert np.allclose(1e3 * operation.path.position[:, 2], z)
    assert np.allclose(1e3 * operation.path.feed[~operation.rapid], feed)
    without = ["without a clearance" in note.text for note in read.of_kind("assumed")]
    assert any(without) == (len(z) == 4 and z[1] == 20)


@pytest.mark.parametrize("words", ["DRILL, 3.0, 5.0, 7.0", "DEEPHL, 9.0, 2.0, 5.0", "WOBBLE, 3"])
def test_bare_numbers_without_a_known_meaning_are_refused(tmp_path: Path, words: str) -> None:
    body = f"GOTO/9,8,25,0,0,1\nCYCLE/{words}\nGOTO/9,8,20,0,0,1\n"
    with pytest.raises(InputError, match=r"line 20: CYCLE/"):
        catia(tmp_path, body)


ARC = "AUTOPS\nINDIRV/ {}\nTLON,GOFWD/ (CIRCLE/ 0.0, 0.0, 5.0,$\n 10.0),ON,{}(LINE/ 0.0, 0.0, 5.0,$\n {})\n"  # noqa: E501


@pytest.mark.parametrize(("direction", "times", "end", "turn"), [
    ("0.0, 1.0, 0.0", "", "0.0, 10.0, 5.0", 90),
    ("0.0, -1.0, 0.0", "2,INTOF,$\n", "0.0, 10.0, 5.0", -270),
    ("0.0, -1.0, 0.0", "", "-7.0710678, -7.0710678, 5.0", -135),
])  # fmt: skip
def test_catia_arcs(tmp_path: Path, direction: str, times: str, end: str, turn: float) -> None:
    body = f"GOTO/10,0,5,0,0,1\n{ARC.format(direction, times, end)}"
    p = 1e3 * catia(tmp_path, body).operation().path.position
    angle = np.degrees(np.unwrap(np.arctan2(p[:, 1], p[:, 0])))
    assert angle[-1] - angle[0] == pytest.approx(turn, abs=1e-4)
    assert np.allclose(np.linalg.norm(p[:, :2], axis=1), 10)
    assert np.allclose(p[:, 2], 5)
    # the same without INDIRV: which meeting of the diameter says which way
    without = body.replace(f"INDIRV/ {direction}\n", "")
    q = 1e3 * catia(tmp_path, without).operation().path.position
    assert np.allclose(p, q)


def test_an_arc_in_canonical_form_towards_a_point(tmp_path: Path) -> None:
    body = (
        "GOTO/10,0,5,0,0,1\nINDIRP/10,{},5\n"
        "TLON,GOFWD/(CIRCLE/CANON,0,0,5,$\n0,0,1,10),ON,(LINE/0,0,5,0,10,5)\n"
    )
    for beside, turn in ((3, 90), (-3, -270)):
        p = 1e3 * catia(tmp_path, body.format(beside)).operation().path.position
        angle = np.degrees(np.unwrap(np.arctan2(p[:, 1], p[:, 0])))
        assert angle[-1] - angle[0] == pytest.approx(turn, abs=1e-4)
    with pytest.raises(InputError, match="INDIRP/ expects three numbers"):
        catia(tmp_path, "GOTO/10,0,5\nINDIRP/1,2\n")


def test_catia_arc_about_another_axis(tmp_path: Path) -> None:
    body = (
        "GOTO/0,10,0,0,0,1\nPSIS/(PLANE/(POINT/0,10,0),PERPTO,(VECTOR/0,0,1))\nINDIRV/0,0,1\n"
        "TLON,GOFWD/(CYLNDR/0,0,0,1,0,0,10),ON,(PLANE/(POINT/0,0,0),PERPTO,$\n"
        "(VECTOR/1,0,0)),(POINT/0,0,0),(POINT/0,0,10)\n"
    )
    p = 1e3 * catia(tmp_path, body).operation().path.position
    assert np.allclose(np.linalg.norm(p, axis=1), 10)
    assert np.allclose(p[-1], [0, 0, 10])
    assert (np.diff(p[:, 2]) > 0).all()


def test_an_arc_up_to_any_line(tmp_path: Path) -> None:
    # Creo's "APT format": the exit line need not go through the centre
    arc = (
        "INDIRV / 0, 1, 0\nTLON\nGOFWD / (CIRCLE / 0, 0, 4, 10), ON, {}(LINE / -9, 6, 4, 9, 6, 4)\n"
    )
    for times, x in (("", 8.0), ("2,INTOF,", -8.0)):
        p = (
            1e3
            * creo(tmp_path, f"GOTO / 10, 0, 4\n{arc.format(times)}\n").operation().path.position
        )
        assert np.allclose(p[-1], [x, 6, 4])
        assert (p[:, 1] > -1e-9).all()


@pytest.mark.parametrize(("statement", "says"), [
    ("INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/0,0,5,10),ON,(LINE/0,0,5,0,10,5)", "points across"),
    ("TLON,GOFWD/(CIRCLE/0,0,5,10),ON,(LINE/0,0,5,-10,0,5)", "half a circle without INDIRV"),
    ("INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,10)", "no end of the arc"),
    ("INDIRV/0,1,0\nTLON,GOFWD/(ELLIPS/0,0,5,10),ON,(LINE/0,0,5,0,10,5)", "is read along"),
    ("INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,10),ON,(LINE/-9,16,5,9,16,5)", "does not meet"),
])  # fmt: skip
def test_unclear_arcs_are_refused(tmp_path: Path, statement: str, says: str) -> None:
    with pytest.raises(InputError) as caught:
        catia(tmp_path, f"GOTO/10,0,5,0,0,1\n{statement}\n")
    assert says in str(caught.value)


@pytest.mark.parametrize(
    "words",
    [
        "DRILL, 10.0, 2.0, MMPM, 300.0",
        "DRILL, 10.0, 300.0, MMPM, 2.0",
    ],
)
def test_feed_and_clearance_are_told_apart_by_size(tmp_path: Path, words: str) -> None:
    body = f"GOTO/0,0,50\nCYCLE/{words}\nGOTO/0,0,0\nCYCLE/OFF\n"
    operation = catia(tmp_path, body).operation()
    cut = operation.path.feed[np.isfinite(operation.path.feed)]
    assert cut.max() == pytest.approx(0.3 / 60)
    assert np.allclose(operation.path.position[:, 2].min(), -0.01)
    assert np.isclose(operation.path.position[:, 2], 0.002).any()


def test_the_diameter_of_a_countersink_is_no_depth(tmp_path: Path) -> None:
    body = "GOTO/0,0,50\nCYCLE/CSINK, CSINK, 12.0, DEPTH, 3.0, MMPM, 60, CLEAR, 5.0\nGOTO/0,0,0\n"
    operation = creo(tmp_path, body + "CYCLE/OFF\nFINI\n").operation()
    assert operation.path.position[:, 2].min() == pytest.approx(-3e-3)


def test_catia_tools_with_their_kind_between(tmp_path: Path) -> None:
    body = "CUTTER/ 10.0\nTOOLNO/1,MILL,1,3,50.0\nLOADTL/1\nGOTO/0,0,0\nGOTO/9,0,0\n"
    tool = catia(tmp_path, body).operation().tool
    assert (tool.number, tool.diameter) == (1, pytest.approx(0.01))
