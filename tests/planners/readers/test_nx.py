"""Siemens NX CLSF: operations, tools, frames, arcs clockwise about their axis, splines, holes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_path, read_program

HEAD = """TOOL PATH/FINISH_A,TOOL,BALL_6
TLDATA/MILL,6.0000,3.0000,40.0000,0.0000,0.0000
MSYS/10.0,20.0,30.0,0.0,1.0,0.0,-1.0,0.0,0.0
$$ centerline data
PAINT/PATH
LOAD/TOOL,7,ADJUST,3
FEDRAT/MMPM,600.0
"""


def program(tmp_path: Path, body: str, head: str = HEAD) -> CamProgram:
    file = tmp_path / "part.cls"
    file.write_text(head + body + "END-OF-PATH\n")
    return read_program(file)


def test_points_of_contact_are_said_and_refused_with_compensation(tmp_path: Path) -> None:
    head = HEAD.replace("centerline data", "contact contour data")
    body = "GOTO/0,0,5\n{}GOTO/9,0,5\n"
    read = program(tmp_path, body.format(""), head)
    assert "where the cutter touches the part" in " ".join(map(str, read.of_kind("assumed")))
    with pytest.raises(InputError, match=r"line 9: CUTCOM/ with .* or contact contour data"):
        program(tmp_path, body.format("CUTCOM/LEFT\n"), head)
    # the next operation states those of the tool's centre
    second = HEAD.replace("FINISH_A", "FINISH_B") + body.format("CUTCOM/LEFT\n")
    assert len(program(tmp_path, body.format("") + second, head).operations) == 2


def test_a_cut_behind_a_change_of_tool_begins_at_its_end_and_says_so(tmp_path: Path) -> None:
    body = "GOTO/0,0,5\nGOTO/9,0,5\nLOAD/TOOL,8\nGOTO/9,9,5\nGOTO/0,9,5\n"
    read = program(tmp_path, body)
    assert np.allclose(1e3 * read.operations[1].path.position, [[9, 9, 5], [0, 9, 5]])
    assert ["line 11" in str(n) for n in read.of_kind("assumed") if "change of tool" in n.text] == [
        True
    ]


def test_head_of_an_operation(tmp_path: Path) -> None:
    read = program(tmp_path, "SPINDL/RPM,5000,CLW\nRAPID\nGOTO/1,2,50,0,0,1\nGOTO/1,2,3\n")
    operation = read.operation()
    assert read.dialect == "NX CLSF"
    assert operation.name == "FINISH_A"
    assert operation.tool.name == "BALL_6"
    assert operation.tool.number == 7
    assert operation.tool.length_offset == 3
    assert operation.tool.diameter == pytest.approx(6e-3)
    assert operation.tool.length == pytest.approx(40e-3)
    assert operation.spindle.rpm == pytest.approx(5000)
    assert operation.frame is not None
    assert np.allclose(operation.frame[:3, 3], [0.01, 0.02, 0.03])
    # z completes x = (0, 1, 0) and y = (-1, 0, 0)
    assert np.allclose(operation.frame[:3, 2], [0, 0, 1])
    assert list(operation.rapid) == [True, False]
    assert list(operation.line) == [10, 11]
    # stated in the frame MSYS, which is the program's
    assert np.allclose(1e3 * operation.path.position, [[1, 2, 50], [1, 2, 3]])
    assert np.isinf(operation.path.feed[0])
    assert operation.path.feed[1] == pytest.approx(0.01)


def test_rapid_holds_for_one_move_and_the_axis_stays(tmp_path: Path) -> None:
    path = program(tmp_path, "GOTO/0,0,9,0,0.6,0.8\nRAPID\nPAINT/COLOR,3\nGOTO/5,0,9\nGOTO/9,0,9\n")
    operation = path.operation()
    assert list(operation.rapid[1:]) == [True, False]
    assert operation.path.axis is not None
    assert np.allclose(operation.path.axis, [0, 0.6, 0.8])


@pytest.mark.parametrize(("k", "middle"), [(1.0, [0, 10]), (-1.0, [0, -10])])
def test_an_arc_turns_clockwise_about_its_axis(
    tmp_path: Path, k: float, middle: list[float]
) -> None:
    body = f"GOTO/-10,0,5\nCIRCLE/0,0,5,0,0,{k},10.0,0.06,0.5,6.0,3.0\nGOTO/10,0,5\n"
    p = 1e3 * program(tmp_path, body).operation().path.position
    assert np.allclose(np.linalg.norm(p[:, :2], axis=1), 10, atol=1e-9)
    assert np.allclose(p[len(p) // 2, :2], middle, atol=0.2)
    # the chords keep within 0.05 mm of the circle
    middles = np.linalg.norm((p[1:, :2] + p[:-1, :2]) / 2, axis=1)
    assert 10 - middles.min() <= 0.05 + 1e-9
    assert len(p) < 25


def test_a_helix_ends_in_its_nth_turn(tmp_path: Path) -> None:
    body = "GOTO/10,0,6\nCIRCLE/0,0,0,0,0,-1,10,0.06,0.5,6,3,TIMES,3\nGOTO/0,10,0\n"
    read = program(tmp_path, body)
    p = 1e3 * read.operation().path.position
    angle = np.unwrap(np.arctan2(p[:, 1], p[:, 0]))
    assert angle[-1] - angle[0] == pytest.approx(4 * np.pi + np.pi / 2)
    # the height falls with the angle
    assert np.allclose(p[:, 2], 6 * (1 - (angle - angle[0]) / (angle[-1] - angle[0])))
    assert any("n-th turn" in note.text for note in read.of_kind("assumed"))


def test_a_full_circle_comes_back(tmp_path: Path) -> None:
    body = "GOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/10,0,0\n"
    operation = program(tmp_path, body).operation()
    assert operation.lengths()[0] == pytest.approx(2 * np.pi * 10e-3, rel=5e-3)


def test_ends_beside_the_circle_are_refused(tmp_path: Path) -> None:
    body = "GOTO/-10,0,5\nCIRCLE/0,0,5,0,0,1,10.0\nGOTO/10.2,0,5\n"
    with pytest.raises(InputError, match=r"line 10: start and end are not on one circle.*0\.2 mm"):
        program(tmp_path, body)


def test_a_spline_is_the_clamped_cubic_of_its_control_points(tmp_path: Path) -> None:
    control = [[0, 0, 0], [1, 5, 0], [4, 9, 1], [8, 9, 2], [12, 4, 2], [13, 0, 1]]
    rows = "".join(f"CNTRL/{x},{y},{z}\n" for x, y, z in control[1:])
    body = "GOTO/0,0,0\nNURBS/\nKNOT/0.4,0.7\nKNOT/1.0\n" + rows + "PAINT/COLOR,1\nGOTO/13,0,9\n"
    p = 1e3 * program(tmp_path, body).operation().path.position
    curve = BSpline([0, 0, 0, 0, 0.4, 0.7, 1, 1, 1, 1], np.array(control, dtype=float), 3)
    dense = curve(np.linspace(0, 1, 2001))
    assert np.allclose(p[-1], [13, 0, 9])
    polygon = p[:-1]
    assert np.allclose(polygon[-1], control[-1])
    # way-points on the curve, the curve within 0.05 mm of the polygon
    assert max(np.linalg.norm(dense - q, axis=1).min() for q in polygon) < 0.01
    side = np.diff(polygon, axis=0)
    square = (side**2).sum(axis=1)
    t = np.clip(np.einsum("nmk,mk->nm", dense[:, None] - polygon[:-1], side) / square, 0, 1)
    foot = polygon[:-1] + t[..., None] * side
    assert np.linalg.norm(dense[:, None] - foot, axis=2).min(axis=1).max() <= 0.05


@pytest.mark.parametrize("body", [
    "GOTO/0,0,0\nNURBS/\nKNOT/0.5,1\nCNTRL/1,0,0\nCNTRL/2,0,0\nGOTO/3,0,0\n",
    "GOTO/0,0,0\nNURBS/\nKNOT/1,0.5\nCNTRL/1,0,0\nCNTRL/2,0,0\nCNTRL/3,1,0\nCNTRL/4,1,0\n",
    "GOTO/0,0,0\nKNOT/1\n",
    "NURBS/\nKNOT/1\nCNTRL/1,0,0\nCNTRL/2,0,0\nCNTRL/3,0,0\n",
])  # fmt: skip
def test_broken_splines_are_refused(tmp_path: Path, body: str) -> None:
    with pytest.raises(InputError, match=r"part\.cls, line"):
        program(tmp_path, body)


def test_a_drilling_cycle_point_by_point(tmp_path: Path) -> None:
    body = (
        "RAPID\nGOTO/0,0,50,0,0,1\nCYCLE/DRILL,RAPTO,3.0,FEDTO,-12.0,MMPM,120.0\n"
        "GOTO/10,0,20\nGOTO/30,0,20\nCYCLE/OFF\nRAPID\nGOTO/30,0,50\n"
    )
    operation = program(tmp_path, body).operation()
    expected = [
        (0, 50, True), (10, 50, True), (10, 23, True), (10, 8, False), (10, 23, True),
        (30, 23, True), (30, 8, False), (30, 23, True), (30, 50, True),
    ]  # fmt: skip
    p = 1e3 * operation.path.position
    found = [(x, z, bool(r)) for (x, _, z), r in zip(p.round(9), operation.rapid, strict=True)]
    assert found == expected
    assert np.allclose(operation.path.feed[~operation.rapid], 2e-3)


def test_deep_holes_and_a_return_to_where_the_tool_came_from(tmp_path: Path) -> None:
    body = (
        "GOTO/0,0,50\nCYCLE/DRILL,DEEP,RAPTO,2,FEDTO,-5,RTRCTO,AUTO,STEP1,4.0,MMPM,60\n"
        "GOTO/0,0,20\nCYCLE/OFF\n"
    )
    z = 1e3 * program(tmp_path, body).operation().path.position[:, 2]
    # 22 -> 18 -> out, back to 0.254 mm above, -> 15 -> to the old height
    assert np.allclose(z, [50, 22, 18, 22, 18.254, 15, 50])


def test_a_higher_hole_is_reached_from_above(tmp_path: Path) -> None:
    body = (
        "GOTO/0,0,5,0,0,1\nCYCLE/DRILL,RAPTO,3,FEDTO,-2,MMPM,60\nGOTO/0,0,0\nGOTO/30,0,20\n"
        "CYCLE/OFF\n"
    )
    p = 1e3 * program(tmp_path, body).operation().path.position[:, [0, 2]]
    expected = [[0, 5], [0, 3], [0, -2], [0, 3], [0, 23], [30, 23], [30, 18], [30, 23]]
    assert np.allclose(p, expected)


def test_holes_along_a_tilted_axis(tmp_path: Path) -> None:
    body = "GOTO/0,0,50,0,0.6,0.8\nCYCLE/DRILL,RAPTO,5,FEDTO,-10,MMPM,60\nGOTO/10,0,0\nCYCLE/OFF\n"
    p = 1e3 * program(tmp_path, body).operation().path.position
    axis = np.array([0, 0.6, 0.8])
    assert np.allclose(p[-3:], np.array([10, 0, 0]) + np.outer([5, -10, 5], axis))


def test_the_axis_of_the_operation_before_is_said(tmp_path: Path) -> None:
    """A file for three axes behind one for five cut askew without a word."""
    second = "TOOL PATH/B,TOOL,BALL_6\n"
    tilted = "GOTO/0,0,50,0,0.6,0.8\nGOTO/8,0,50\nEND-OF-PATH\n"

    def said(body: str) -> list[str]:
        notes = map(str, program(tmp_path, body).of_kind("assumed"))
        return [note for note in notes if "without i,j,k" in note]

    rest = "GOTO/5,0,40\nGOTO/5,2,40\n"
    (found,) = said(f"{tilted}{second}{rest}")
    assert "line 12: an operation that begins without i,j,k: the tool stands as at" in found
    assert found.endswith("the one before, 0,0.6,0.8")
    axes = program(tmp_path, f"{tilted}{second}{rest}").operations[1].path.axis
    assert np.allclose(axes, [0, 0.6, 0.8])
    # where it is stated, or along z, or within an operation
    assert not said(f"{tilted}{second}GOTO/5,0,40,0,0,1\n{rest}")
    assert not said(f"{tilted}{second}GOTO/5,0,40,0,0.6,0.8\n{rest}")
    assert not said(f"{tilted.replace('0,0.6,0.8', '0,0,1')}{second}{rest}")
    assert not said(tilted)


def test_operations_of_a_file_in_the_frame_of_the_first(tmp_path: Path) -> None:
    second = HEAD.replace("FINISH_A", "DRILL_B").replace("BALL_6", "DRILL_4").replace(
        "MSYS/10.0,20.0,30.0,0.0,1.0,0.0,-1.0,0.0,0.0", "MSYS/10.0,20.0,70.0,1,0,0,0,1,0"
    )  # fmt: skip
    body = "GOTO/0,0,5\nGOTO/8,0,5\nEND-OF-PATH\n" + second + "GOTO/5,0,0\nGOTO/5,2,0\n"
    read = program(tmp_path, body)
    assert [o.name for o in read.operations] == ["FINISH_A", "DRILL_B"]
    assert read.operations[1].tool.name == "DRILL_4"
    # the first frame has its x along the part's y
    assert np.allclose(1e3 * read.operations[1].path.position, [[0, -5, 40], [2, -5, 40]])
    with pytest.raises(InputError, match=r"found 2 operations, expected one.*1: FINISH_A; 2: DRI"):
        read_path(tmp_path / "part.cls")
    by_name = read_path(tmp_path / "part.cls", operation="DRILL_B")
    by_number = read_path(tmp_path / "part.cls", operation=2)
    assert np.array_equal(by_name.position, by_number.position)
    with pytest.raises(InputError, match=r"found 0 operations called 'X'"):
        read_path(tmp_path / "part.cls", operation="X")


def test_home_and_stops(tmp_path: Path) -> None:
    body = (
        "FROM/0,0,100,0,0,1\nGOTO/0,0,10\nSTOP\nGOTO/5,0,10\nSPINDL/RPM,900,CCLW\nGOTO/9,0,10\n"
        "COOLNT/ON\nGOTO/9,5,10\nGOHOME/0,0,100\n"
    )
    read = program(tmp_path, body)
    ways = [1e3 * o.path.position for o in read.operations]
    assert np.allclose(ways[0], [[0, 0, 100], [0, 0, 10]])
    # after a stop the motion goes on from where it stopped
    assert np.allclose(ways[1], [[0, 0, 10], [5, 0, 10]])
    assert np.allclose(ways[2], [[5, 0, 10], [9, 0, 10], [9, 5, 10], [0, 0, 100]])
    assert [o.name for o in read.operations] == ["FINISH_A", "FINISH_A (2)", "FINISH_A (3)"]
    assert read.operations[2].rapid[-1]
    assert not read.operations[2].spindle.clockwise
    events = [(e.kind, e.point) for o in read.operations for e in o.events]
    assert ("stop", 1) in events
    assert ("coolant", 1) in events


@pytest.mark.parametrize(("statement", "says"), [
    ("GOCLER/", "GOCLER/ moves the tool or the part and is not read"),
    ("ROTATE/TABLE,AAXIS,ATANGL,90", "ROTATE/ moves the tool or the part"),
    ("@17", "found '@17', expected an APT statement"),
    ("WOBBLE/3", "unknown statement 'WOBBLE'"),
    ("CYCLE/MILL,DEPTH,3", "CYCLE/MILL is not read"),
    ("CYCLE/DRILL,RAPTO,3", "states no depth"),
    ("MSYS/1,2,3", "MSYS/ has 3 numbers, expected 9"),
    ("MSYS/0,0,0,1,0,0,1,0,0", "not at right angles"),
])  # fmt: skip
def test_what_may_move_is_refused_and_shown(tmp_path: Path, statement: str, says: str) -> None:
    body = f"GOTO/0,0,100\n{statement}\nGOTO/0,0,10\n"
    with pytest.raises(InputError, match=r"line 9: ") as caught:
        program(tmp_path, body)
    assert says in str(caught.value)
    shown = read_program(tmp_path / "part.cls", strict=False)
    assert [note.line for note in shown.of_kind("unknown")] == [9]
    assert says in shown.of_kind("unknown")[0].text
    assert "part.cls" not in shown.of_kind("unknown")[0].text
