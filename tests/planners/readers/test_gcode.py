"""G-code: straight moves, arcs in all planes, cycles, feeds, tools, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from gcode_files import operation, positions, program
from hypothesis import given, settings
from hypothesis import strategies as st

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import ToolPath, read_program

Array = npt.NDArray[np.float64]


def test_modal_words_blanks_numbers_and_comments(tmp_path: Path) -> None:
    text = (
        "%\nO1234\n/N10 g21 g90 (inch? no)\nN20 G0X10.Y-.5 Z5 ; to the start\nN30 G1 Z-1 F120\n"
        "X20\n(G1 X99)\n N40 Y 3\nG91 X1 Z+1.\nM30\nG1 X500\n"
    )
    found = operation(tmp_path, text)
    expected = [[10, -0.5, 5], [10, -0.5, -1], [20, -0.5, -1], [20, 3, -1], [21, 3, 0]]
    assert np.allclose(1e3 * found.path.position, expected)
    assert list(found.rapid) == [True, False, False, False, False]
    assert list(found.line) == [4, 5, 6, 8, 9]
    assert np.allclose(found.path.feed[1:], 2e-3)
    assert found.path.axis is not None
    assert np.allclose(found.path.axis, [0, 0, 1])


@pytest.mark.parametrize(("code", "unit"), [("G20", 25.4), ("G21", 1.0)])
def test_units_and_feeds(tmp_path: Path, code: str, unit: float) -> None:
    head = f"{code} G90\nG0 X0 Y0 Z0\n"
    per_minute = operation(tmp_path, head + "G1 X10 F30\n")
    assert np.allclose(1e3 * per_minute.path.position[-1, 0], 10 * unit)
    assert per_minute.path.feed[-1] == pytest.approx(30 * unit / 60e3)
    per_turn = operation(tmp_path, head + "S1200 M3\nG95 G1 X10 F0.5\n")
    assert per_turn.path.feed[-1] == pytest.approx(0.5 * unit * 20 / 1e3)
    inverse = operation(tmp_path, head + "G93 G1 X10 F30\n")
    # the move takes 1/30 of a minute
    assert inverse.path.feed[-1] == pytest.approx(10 * unit / 2 / 1e3)
    with pytest.raises(InputError, match=r"line 4: G93 .* needs F in every cutting block"):
        operation(tmp_path, head + "G93 G1 X10 F30\nX20\n")
    with pytest.raises(InputError, match=r"line 3: the feed is per revolution, but no spindle"):
        operation(tmp_path, head + "G95 G1 X10 F0.5\n")


PLANES = [("G17", "X", "Y", "Z", "I", "J"), ("G18", "Z", "X", "Y", "K", "I"),
          ("G19", "Y", "Z", "X", "J", "K")]  # fmt: skip


@pytest.mark.parametrize(("plane", "u", "v", "w", "cu", "cv"), PLANES)
@pytest.mark.parametrize(("code", "turn"), [(2, -1), (3, 1)])
def test_arcs_and_helices_in_all_planes(
    tmp_path: Path, plane: str, u: str, v: str, w: str, cu: str, cv: str, code: int, turn: int
) -> None:
    # from (20, 5) about (10, 5) by a quarter; 4 along the normal
    head = f"G21 G90 {plane}\nG0 {u}20 {v}5 {w}1\n"
    end = f"{u}10 {v}{5 + 10 * turn} {w}5"
    ways = {
        "incremental centre": f"G{code} {end} {cu}-10 {cv}0 F60\n",
        "absolute centre": f"G90.1\nG{code} {end} {cu}10 {cv}5 F60\n",
        "radius": f"G{code} {end} R10 F60\n",
        "incremental end": f"G91\nG{code} {u}-10 {v}{10 * turn} {w}4 {cu}-10 F60\n",
    }
    index = ["XYZ".index(letter) for letter in (u, v, w)]
    for name, way in ways.items():
        p = positions(tmp_path, head + way)[:, index]
        angle = np.unwrap(np.arctan2(p[:, 1] - 5, p[:, 0] - 10))
        assert angle[-1] - angle[0] == pytest.approx(turn * np.pi / 2), name
        assert np.allclose(np.hypot(p[:, 0] - 10, p[:, 1] - 5), 10), name
        assert np.allclose(p[:, 2], 1 + 4 * (angle - angle[0]) / (angle[-1] - angle[0])), name


@pytest.mark.parametrize(("radius", "degrees"), [(10.0, 90), (-10.0, 270)])
def test_a_negative_radius_is_the_longer_way(tmp_path: Path, radius: float, degrees: float) -> None:
    p = positions(tmp_path, f"G21\nG0 X10 Y0 Z0\nG3 X0 Y10 R{radius} F60\n")
    centre = np.array([0, 0]) if radius > 0 else np.array([10, 10])
    angle = np.degrees(np.unwrap(np.arctan2(*(p[:, :2] - centre).T[::-1])))
    assert angle[-1] - angle[0] == pytest.approx(degrees)


def test_full_circles_and_several_turns(tmp_path: Path) -> None:
    full = operation(tmp_path, "G21\nG0 X10 Y0 Z0\nG2 I-10 F60\n")
    assert full.lengths()[0] == pytest.approx(2 * np.pi * 0.01, rel=5e-3)
    turns = positions(tmp_path, "G21\nG0 X10 Y0 Z0\nG2 X0 Y-10 Z-3 I-10 P3 F60\n")
    angle = np.unwrap(np.arctan2(turns[:, 1], turns[:, 0]))
    assert angle[-1] - angle[0] == pytest.approx(-4 * np.pi - np.pi / 2)


def test_the_first_moves_until_the_place_is_known(tmp_path: Path) -> None:
    read = program(tmp_path, "G21 G90\nG0 Z6\nG0 X1 Y2\nG1 Z0 F60\n")
    assert np.allclose(1e3 * read.operation().path.position, [[1, 2, 6], [1, 2, 0]])
    assert "left out" in str(read.of_kind("assumed")[0])
    with pytest.raises(InputError, match=r"line 2: a cut, but X and Y of the tool is not stated"):
        program(tmp_path, "G21 G90\nG1 Z6 F60\nG0 X1 Y2\n")


Z = {
    # from Z 30 at X0; holes at X10 and X20; R 5, bottom -4
    "G99 G81 X10 Z-4 R5 F60\nX20": [30, 30, 5, -4, 5, 5, -4, 5],
    "G98 G81 X10 Z-4 R5 F60\nX20": [30, 30, 5, -4, 30, 30, 5, -4, 30],
    "G99 G82 X10 Z-4 R5 P0.5 F60": [30, 30, 5, -4, 5],
    "G99 G83 X10 Z-4 R5 Q4 F60": [30, 30, 5, 1, 5, 1.254, -3, 5, -2.746, -4, 5],
    "G99 G73 X10 Z-4 R5 Q4 F60": [30, 30, 5, 1, 1.254, -3, -2.746, -4, 5],
    "G99 G85 X10 Z-4 R5 F60": [30, 30, 5, -4, 5],
    "G99 G86 X10 Z-4 R5 P2 F60": [30, 30, 5, -4, 5],
    # R counts from where the tool is, Z from R; repeats keep both (LinuxCNC)
    "G91 G99 G81 X10 Z-2 R-10 F60 L2": [30, 30, 20, 18, 20, 20, 18, 20],
}


@pytest.mark.parametrize("cycle", Z)
def test_canned_cycles_point_by_point(tmp_path: Path, cycle: str) -> None:
    tail = "\nG80\nG90 G0 X0 Z40\n"
    found = operation(tmp_path, "G21 G90\nG0 X0 Y0 Z30\n" + cycle + tail)
    z = 1e3 * found.path.position[:, 2]
    x = 1e3 * found.path.position[:, 0]
    assert np.allclose(z[:-1], Z[cycle])
    assert x[-1] == pytest.approx(0)
    cuts = ~found.rapid
    assert (z[1:][cuts[1:]] < z[:-1][cuts[1:]]).all() or "G85" in cycle
    assert found.rapid[-2] == ("G85" not in cycle)
    assert [e.kind for e in found.events] == (["dwell"] if " P" in cycle else [])


@pytest.mark.parametrize(("text", "says"), [
    ("G81 X1 Z-4 F60", "line 3: G81 without R"),
    ("G83 X1 Z-4 R5 F60", "without a positive Q"),
    ("G81 X1 Z9 R5 F60", "Z is above R"),
    ("G18 G81 X1 Z-4 R5 F60", "in the plane G18"),
    ("G2 X5 Y5 F60", "without a centre; expected I, J or R"),
    ("G2 X5 Y5 I1 J1 F60", "not on one circle"),
    ("G2 X50 Y0 R5 F60", "less than half the way"),
    ("G2 X0 Y0 R5 F60", "a full turn by R"),
    ("G2 X5 Y5 I5 K2 F60", "K lies across the plane G17"),
    ("G41 D1 G1 X5 F60", "G41 is the offset by the tool's radius"),
    ("G28 X1\nG92 X0", "G92 X, but the tool's place is not known"),
    ("G18 G68 X0 Y0 R30", "G68 is read as G17 G68 X Y R only"),
    ("G5 X1 Y1 I1 J1", "G5 without P and Q"),
    ("G6.2 P4 K0 X0 Y0 Z30\nG1 X1 F60", "G6.2 ends after 1 points"),
    ("G1 X1 A3=0 B3=0 C3=1", "without TRAORI"),
    ("MCALL POCKET3(50,0,2,-12)", "cycles written as calls"),
    ("SCALE X2", "TRANS, ATRANS, ROT and AROT are read"),
    ("AROT X30", "AROT X is not read; expected TRANS X Y Z, or ROT Z"),
    ("TRANS A5", "TRANS A is not read"),
    ("G1 X5 ,R3", "corners written as ,R or ,C"),
    ("G4", "G4 states no time"),
    ("G70 I10. J0. L6", "G70 and G71 with such words are cycles"),
    ("G71 P10 Q20 F0.2", "G70 and G71 with such words are cycles"),
    ("G1 X5 F60 X7", "found X5 and X7 in one block"),
    ("G1 X5 F60 E2", "the word E, which is not read; E pushes plastic"),
    ("G17.5", "unknown code G17.5"),
    ("G68 A5. B0. R30.", "G68 is read as G17 G68 X Y R only"),
    ("G8 X20. Y5.", "G8 with X20 and no motion code: on some controls an arc that begins along"),
    ("G93 I5. J0.", "G93 with I5 and no motion code: on some controls a pole"),
    ("G93 X9. Y5.", "G93 with X9 and no motion code: on some controls a pole or another zero"),
    ("R1=5\nANF: G1 X=R1 F60", "found 'ANF: G1 X=R1 F60'"),
    ("R1=5\nFOR R1=1 TO 3", "jumps and loops of Siemens, and labels"),
    ("$P_UIFR[1]=CTRANS(X,9)", "found '$P_UIFR[1]=CTRANS(X,9)', expected words"),
    ("G1 X5 A5=0 F60", "found 'A5=0 F60'"),
    ("G41.2 D1 G1 X5 F60", "G41.2 is the offset by the tool's radius"),
    ("G1 X5 (to the left Y7 F60", "a comment ( without its )"),
    ("G1 X#1 F60", "found #1, which the file does not set"),
    ("G1 X[1+] F60", "in an expression, expected a number"),
    ("O100 IF [1]", "o100 IF without ENDIF"),
    ("M98 P1000", "M98 calls a sub-program that is not in the file"),
    ("G1 X=R1 F60", "found R1, which the file does not set"),
    ("G1 X=IC(R1) F60", "found R1, which the file does not set"),
    ("G1 X5 E3 F60", "the word E, which is not read"),
    ("G1 X5 F-3", "expected a positive feed"),
    ("G0 G1 X5", "G0 and G1 in one block"),
    ("G1 X5 R3 F60", "R in a straight move"),
    ("G1 A30 X5 F60", "A, B and C turn a table or a head"),
    ("G55 G0 X5", "G55 after motion in G54"),
    ("G68.2 P1 X0", "G68.2 P"),
])  # fmt: skip
def test_what_is_not_read_is_refused_with_its_line(tmp_path: Path, text: str, says: str) -> None:
    head = "G21 G90 G54\nG0 X0 Y0 Z30\n"
    with pytest.raises(InputError, match=r"part\.nc, line [34]: ") as caught:
        program(tmp_path, f"{head}{text}\nG0 X1\n")
    assert says in str(caught.value)
    line = int(str(caught.value).split("line ")[1].split(":")[0])
    shown = read_program(tmp_path / "part.nc", strict=False)
    assert shown.of_kind("unknown")[0].line == line


def test_machine_functions_tools_and_operations(tmp_path: Path) -> None:
    text = (
        "G21 G90\n(begin operation: Pocket)\nT3 M6\nG43 H3\nS6000 M3 M8\nG0 X0 Y0 Z9\nG1 Z-1 F60\n"
        "M9\nG4 P1.5\nX5\n(MSG, clean the chips)\nM1\nX9\nM123\n(finish operation: Pocket)\n"
        "(begin operation: Holes)\nT4 M6\nS900 M4\nG0 X20 Y0 Z9\nG1 Z-2\nM5\nM2\n"
    )
    read = program(tmp_path, text)
    assert [o.name for o in read.operations] == ["Pocket", "Pocket (2)", "Holes"]
    first = read.operations[0]
    assert (first.tool.number, first.tool.length_offset) == (3, 3)
    assert first.spindle.rpm == pytest.approx(6000)
    assert first.coolant == "flood"
    kinds = [(e.kind, e.point) for e in first.events]
    assert kinds == [("tool", -1), ("coolant", 1), ("dwell", 1), ("message", 2),
                     ("optional stop", 2)]  # fmt: skip
    assert not read.operations[2].spindle.clockwise
    assert read.operations[2].tool.number == 4
    # after the stop the cut goes on; with another tool it begins at its own first point
    assert np.allclose(1e3 * read.operations[1].path.position[:, 0], [5, 9])
    assert np.allclose(1e3 * read.operations[2].path.position[:, 2], [9, -2])
    assert "M123" in str(read.of_kind("assumed"))


def test_a_spindle_that_stops_does_not_hold_the_tool_up(tmp_path: Path) -> None:
    text = "G21 G90\nM3 S900\nG0 X0 Y0 Z9\nG1 Z-1 F60\nM5\nG0 Z50\nM2\n"
    found = operation(tmp_path, text)
    assert np.allclose(1e3 * found.path.position[:, 2], [9, -1, 50])
    assert [(e.kind, e.text, e.point) for e in found.events] == [("spindle", "off", 1)]
    assert found.spindle.rpm == pytest.approx(900)
    again = program(tmp_path, text.replace("G0 Z50", "G0 Z50\nM3\nG1 Z40"))
    assert [len(o.path) for o in again.operations] == [3, 2]


def test_places_of_the_machine(tmp_path: Path) -> None:
    text = (
        "G21 G90\nG0 X0 Y0 Z9\nG1 Z-1 F60\nG91 G28 Z0\nG90 G0 X30 Y0\nG0 Z9\nG1 Z-1\n"
        "G53 G0 Z-5\nG0 X1 Y1 Z9\nG28 X1 Y1 Z20\n"
    )
    read = program(tmp_path, text)
    ways = [1e3 * o.path.position for o in read.operations]
    assert np.allclose(ways[0], [[0, 0, 9], [0, 0, -1]])
    assert np.allclose(ways[1], [[30, 0, 9], [30, 0, -1]])
    assert np.allclose(ways[2], [[1, 1, 9], [1, 1, 20]])
    assert "places of the machine tool" in str(read.of_kind("assumed"))


def test_a_tilted_plane(tmp_path: Path) -> None:
    # z axis of the plane: Rz(90) Rx(30) z = (0.5, 0, 0.866); a hole and an arc in it
    text = (
        "G21 G90\nG68.2 X100 Y50 Z10 I90 J30 K0\nG53.1\nG0 X0 Y0 Z20\nG81 Z-3 R2 F60\nG80\n"
        "G0 X10 Y0\nG1 Z0 F60\nG3 X0 Y10 I-10\nG69\nG0 X0 Y0 Z200\n"
    )
    found = operation(tmp_path, text)
    axis = np.array([0.5, 0, np.sqrt(0.75)])
    origin = np.array([100, 50, 10])
    p = 1e3 * found.path.position
    assert np.allclose(p[:4], origin + np.outer([20, 2, -3, 20], axis))
    arc = p[6:-1] - origin
    assert np.allclose(arc @ axis, 0, atol=1e-9)
    assert np.allclose(np.linalg.norm(arc, axis=1), 10)
    assert found.path.axis is not None
    assert np.allclose(found.path.axis[:-1], axis)
    assert np.allclose(p[-1], [0, 0, 200])
    assert np.allclose(found.path.axis[-1], [0, 0, 1])


def axes_at(path: ToolPath, places: list[float]) -> Array:
    """Tool axes at places along x [mm]; others stand between those of the file."""
    away = np.abs(1e3 * path.position[:, 0] - np.array(places)[:, None])
    assert np.allclose(away.min(axis=1), 0)
    return np.asarray(path.axis)[away.argmin(axis=1)]


@pytest.mark.parametrize("on", ["G43.4 H1", "M128", "TRAORI", "TRAORI(1)"])
def test_five_axes_with_stated_kinematics(tmp_path: Path, on: str) -> None:
    text = f"G21 G90\n{on}\nG0 X0 Y0 Z50 A0 C0\nG1 X10 A30 C90 F600\nX20 A-30\n"
    with pytest.raises(InputError, match=r"line 4: A, B and C turn a table or a head"):
        program(tmp_path, text)
    found = program(tmp_path, text, rotary="C,A").operation()
    # Rz(90) Rx(30) z
    expected = [[0, 0, 1], [0.5, 0, np.sqrt(0.75)], [-0.5, 0, np.sqrt(0.75)]]
    assert np.allclose(axes_at(found.path, [0, 10, 20]), expected)
    turned = program(tmp_path, text, rotary="-C,A").operation()
    assert np.allclose(axes_at(turned.path, [10]), [[-0.5, 0, np.sqrt(0.75)]])
    with pytest.raises(InputError, match="axis A turns, but only C, B are stated"):
        program(tmp_path, text, rotary="C,B")
    with pytest.raises(InputError, match="expected the rotary axes from part to tool"):
        program(tmp_path, text, rotary="table")
    # without tool centre control the place of the tip depends on the machine
    with pytest.raises(InputError, match="A, B and C turn"):
        program(tmp_path, text.replace(on, "G54"), rotary="C,A")


def test_tool_vectors_need_no_kinematics(tmp_path: Path) -> None:
    found = operation(tmp_path, "G21 G90\nG43.5 H1\nG0 X0 Y0 Z5 I0 J0 K1\nG1 X9 I0 J0.6 K0.8 F60\n")
    assert found.path.axis is not None
    assert np.allclose(found.path.axis[-1], [0, 0.6, 0.8])


def test_a_cut_without_feed_is_noted(tmp_path: Path) -> None:
    read = program(tmp_path, "G21\nG0 X0 Y0 Z0\nG1 X9\nY9\n")
    assert np.isinf(read.operation().path.feed).all()
    assert "a cut without a stated feed" in str(read.of_kind("assumed")[0])


LETTERS = st.sampled_from("GGGGGMMXYZZIJKRFSTHPQLABCNEO%()#;/[ ")
NUMBERS = st.one_of(
    st.integers(-3, 100).map(str),
    st.floats(-100, 100).map(lambda v: f"{v:.3f}"),
    st.sampled_from(
        ["0", "1", "2", "3", "17", "81", "83", "43.4", "68.2", "91", ".", "-", "9" * 400]
    ),
)


@settings(max_examples=400, deadline=None)
@given(
    st.lists(st.lists(st.tuples(LETTERS, NUMBERS), max_size=6), min_size=1, max_size=12),
    st.booleans(),
)
def test_random_blocks_never_raise_anything_else(
    tmp_path_factory: pytest.TempPathFactory,
    blocks: list[list[tuple[str, str]]],
    strict: bool,
) -> None:
    file = tmp_path_factory.getbasetemp() / "random.nc"
    body = "\n".join(" ".join(letter + number for letter, number in block) for block in blocks)
    file.write_text(f"G21 G90\nG0 X0 Y0 Z10\nG1 X9 F60\n{body}\n")
    try:
        read = read_program(file, strict=strict, most_points=20_000, rotary="C,A")
    except InputError:
        return
    assert all(np.isfinite(o.path.position).all() for o in read.operations)


@pytest.mark.parametrize(
    "head",
    [
        "G0 G17 G40 G49 G80 G90",
        "G80 G0 X0",
        "G05 P10000",
        "G187 P1",
        "<BRACKET>",
        "O1001(BRACKET)",
        "(TOOL (10 MM) FOR THE POCKET)",
        "(A SMILE :( IN A COMMENT)",
    ],
)
def test_heads_of_controls_move_nothing(tmp_path: Path, head: str) -> None:
    body = "G0 X0 Y0 Z5\nG1 Z0 F600\nX10\nM30\n"
    plain = positions(tmp_path, f"G21 G90\n{body}")
    assert np.array_equal(positions(tmp_path, f"G21 G90\n{head}\n{body}"), plain)


def test_a_motion_beside_the_end_of_a_cycle_is_carried_out(tmp_path: Path) -> None:
    text = "G21 G90 G0 X0 Y0 Z9\nG81 X5 Z-3 R1 F60\nG80 G0 X20\nG81 X30 Z-4 R1\nM30\n"
    found = positions(tmp_path, text)
    assert found[:, 2].min() == pytest.approx(-4.0)
    assert (np.abs(found[:, 0] - 20) < 1e-9).sum() == 1
