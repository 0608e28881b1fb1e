"""G-code of controls: moved zeros, splines, dwells, cycles, words of Siemens."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from gcode_files import operation, positions, program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

Array = npt.NDArray[np.float64]


def test_axis_words_after_a_cycle_go_on_as_before_it(tmp_path: Path) -> None:
    text = "G21 G90 G0 X0 Y0 Z9\nG81 X5 Z-3 R1 F60\nG80\nZ20\nX7\nM30\n"
    read = program(tmp_path, text)
    found = read.operation()
    assert np.allclose(1e3 * found.path.position[-2:], [[5, 0, 20], [7, 0, 20]])
    assert found.rapid[-2:].all()
    assert "after G80" in str(read.of_kind("assumed")[0])
    with pytest.raises(InputError, match="axis words after G80"):
        program(tmp_path, "G21 G90\nG80\nX5\n")


def test_a_dwell_in_seconds_and_in_milliseconds(tmp_path: Path) -> None:
    text = (
        "G21 G90 G0 X0 Y0 Z9\nG4 P0.5\nG1 Z1 F60\nG4 P1500\nG4 X2\nG4 F3\nX9\n"
        "G82 X5 Z-3 R1 P250\nM30\n"
    )
    found = operation(tmp_path, text)
    assert [e.seconds for e in found.events] == [0.5, 1.5, 2.0, 3.0, 0.25]
    assert found.feed_range() == (pytest.approx(1e-3), pytest.approx(1e-3))


@pytest.mark.parametrize("block", ["G1 X7 F120 G4 P0.5", "G4 P0.5 G1 X7 F120"])
def test_a_move_in_the_block_of_a_dwell_comes_after_it(tmp_path: Path, block: str) -> None:
    found = operation(tmp_path, f"G21 G90 G0 X0 Y0 Z9\nG1 Z1 F60\n{block}\nY2\nM2\n")
    ends = [[0, 0, 9], [0, 0, 1], [7, 0, 1], [7, 2, 1]]
    assert np.allclose(1e3 * found.path.position, ends)
    assert np.allclose(1e3 * found.path.feed[1:], [1, 2, 2])
    assert [(e.kind, e.point) for e in found.events] == [("dwell", 1)]


@pytest.mark.parametrize(
    ("codes", "start"),
    [
        ("G52 X100 Y50", (100, 50, 0)),
        ("G52 X9\nG52 X100 Y50", (100, 50, 0)),
        ("G92 X-100 Y-50 Z5", (100, 50, 0)),
        ("G92 X7 Y3\nG92 X-100 Y-50", (100, 50, 0)),
        ("G52 X9\nG52 X0", (0, 0, 0)),
        ("G92 X9\nG92.1", (0, 0, 0)),
        ("G92 X9 Y1\nG68 X0 Y0 R30\nG69\nG92.2", (0, 0, 0)),
    ],
)
def test_a_moved_zero(tmp_path: Path, codes: str, start: tuple[float, ...]) -> None:
    head = "G21 G90 G54\nG0 X0 Y0 Z5\n"
    found = positions(tmp_path, f"{head}{codes}\nG0 X0 Y0\nG1 Z0 F60\nX10\n")
    assert np.allclose(found[-2], start)
    assert np.allclose(found[-1], np.add(start, (10, 0, 0)))


def test_turned_coordinates_about_a_point(tmp_path: Path) -> None:
    text = "G21 G90\nG0 X0 Y0 Z5\nG68 X10 Y0 R90\nG1 X20 Y0 F60\nG3 X10 Y10 I-10\nG69\nG1 X0 Y0\n"
    found = positions(tmp_path, text)
    # (20, 0) turned by 90 deg about (10, 0) is (10, 10); (10, 10) is (0, 0)
    assert np.allclose(found[1], (10, 10, 5))
    assert np.allclose(found[-2], (0, 0, 5), atol=1e-9)
    radius = np.linalg.norm(found[1:-1, :2] - (10, 0), axis=1)
    assert np.allclose(radius, 10)


def test_splines_are_followed_within_the_chord(tmp_path: Path) -> None:
    t = np.linspace(0, 1, 2001)[:, None]
    start, one, two, end = (np.array(p) for p in ([0, 0], [5, 0], [10, 5], [10, 10]))
    cubic = (1 - t) ** 3 * start + 3 * t * (1 - t) ** 2 * one + 3 * t**2 * (1 - t) * two
    curve = cubic + t**3 * end
    head = "G21 G90\nG0 X0 Y0 Z0\n"
    bezier = positions(tmp_path, f"{head}G5 X10 Y10 I5 J0 P0 Q-5 F60\n")
    knots = "K0 X5 Y0 Z0\nK0 X10 Y5 Z0\nK0 X10 Y10 Z0\nK1\nK1\nK1\nK1\nG1 X20\n"
    nurbs = positions(tmp_path, f"{head}G6.2 P4 K0 X0 Y0 Z0 F60\n{knots}")
    assert np.allclose(bezier, nurbs[:-1])
    assert np.allclose(nurbs[-1], (20, 10, 0))
    assert len(bezier) > 5
    for a, b in zip(bezier[:-1, :2], bezier[1:, :2], strict=True):
        along = (b - a) / np.linalg.norm(b - a)
        ahead = (curve - a) @ along
        beside = np.abs((curve - a) @ np.array([-along[1], along[0]]))
        assert beside[(ahead > 0) & (ahead < np.linalg.norm(b - a))].max() < 0.0501


def test_a_rational_spline_is_a_circle(tmp_path: Path) -> None:
    text = (
        "G21 G90\nG0 X10 Y0 Z0\nG6.2 P3 K0 X10 Y0 Z0 R1 F60\nK0 X10 Y10 R0.70710678\n"
        "K0 X0 Y10 R1\nK1\nK1\nK1\n"
    )
    found = positions(tmp_path, text)
    assert np.allclose(np.linalg.norm(found, axis=1), 10, atol=1e-6)
    assert np.allclose(found[-1], (0, 10, 0))


def test_words_of_siemens_controls(tmp_path: Path) -> None:
    text = (
        '; 840D\nN10 G17 G710 G90 G54 G601 FNORM\nN20 T="MILL 10" D1\nN30 M6\nN40 MSG("CONTOUR")\n'
        "N50 G0 X=0 Y=0 Z=5\nN60 G1 Z-2. F=240\nX60\nG3 X80 Y20 CR=20\n"
        "G2 X100 Y40 I=AC(100) J=AC(20)\nG3 X100 Y40 I-5 J0 TURN=1\nSUPA G0 Z0 D0\nM30\n"
    )
    found = operation(tmp_path, text)
    p = 1e3 * found.path.position
    assert found.tool.name == "MILL 10"
    assert ("message", "CONTOUR") in {(e.kind, e.text) for e in found.events}
    assert found.feed_range() == (pytest.approx(4e-3), pytest.approx(4e-3))
    on_first = p[(p[:, 0] > 60.001) & (p[:, 0] <= 80.001)]
    assert np.allclose(np.linalg.norm(on_first[:, :2] - (60, 20), axis=1), 20, atol=1e-6)
    assert np.allclose(p[-1], (100, 40, -2))
    ways = np.linalg.norm(np.diff(p, axis=0), axis=1).sum()
    # 5 down to -2, 60, a quarter of 20 mm, a quarter of 20 mm, two turns of 5 mm
    assert ways == pytest.approx(7 + 60 + 20 * np.pi + 20 * np.pi, rel=5e-3)


def test_tool_vectors_of_siemens_controls(tmp_path: Path) -> None:
    text = "G710 G90\nTRAORI\nG0 X0 Y0 Z9 A3=0 B3=0 C3=2\nG1 Z0 A3=1 C3=1 F60\nX5\n"
    axis = operation(tmp_path, text).path.axis
    assert axis is not None
    half = np.sqrt(0.5)
    assert np.allclose(axis, [[0, 0, 1], [half, 0, half], [half, 0, half]])


def test_fine_boring_goes_in_at_feed_and_out(tmp_path: Path) -> None:
    text = "G21 G90 G0 X0 Y0 Z9\nG76 X5 Z-3 R1 Q0.2 P500 F60\nG88 X9 Z-3 R1 P0.5\nG80\nM30\n"
    read = program(tmp_path, text)
    assert [e.seconds for e in read.operation().events] == [0.5, 0.5]
    assert "without its way aside" in str(read.of_kind("assumed")[0])
    with pytest.raises(InputError, match="cuts a thread"):
        program(tmp_path, "G21 G0 X0 Y0 Z9\nG76 X1 Z-3 R1 P1 I1 J1 K1 F60\n")


def test_a_program_that_begins_again_is_carried_out_once(tmp_path: Path) -> None:
    text = "G21 G90 G0 X0 Y0 Z9\nG1 Z1 F60\nM99\n"
    read = program(tmp_path, text)
    assert len(read.operation().path) == 2
    assert "M99" in str(read.of_kind("assumed")[0])
    with pytest.raises(InputError, match=r"line 4: a block after M99"):
        program(tmp_path, f"{text}O1\nG0 X9\nM98 P1\nM30\n".replace("O1\n", ""))


def test_axis_words_before_any_motion_are_where_the_tool_is(tmp_path: Path) -> None:
    read = program(tmp_path, "G21 G90\nG28 G91 Z0\nG90\nT1 M6\nZ10\nG0 X3 Y4\nZ1\nM30\n")
    assert np.allclose(1e3 * read.operation().path.position, [[3, 4, 10], [3, 4, 1]])
    assert "taken as the place" in " ".join(map(str, read.notes))
    with pytest.raises(InputError, match="no motion is in force"):
        program(tmp_path, "G21 G90\nX1 Y2 Z3\nX5\n")


FIVE_AXES = (
    "G21 G90 G54\nG0 B0 C0\nT2 M6\nG0 B-30 C90\nG68.2 X0 Y0 Z0 I0 J30 K90\nG53.1\nG0 X-18 Y-51\n"
    "G69\nG43.4 H2\nG0 X51 Y-29 Z14 B-30 C90\nG1 Y-20 Z-2 F1000\nX-55\nG0 Z14\nG49\nG0 B0 C0\nM30\n"
)


def test_the_table_turns_before_tool_centre_control(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text(FIVE_AXES)
    found = read_program(file, rotary="C,B").operation()
    assert np.allclose(1e3 * found.path.position[0], [51, -29, 14])
    assert np.allclose(found.path.axis, np.tile([0, -0.5, np.sqrt(0.75)], (4, 1)))
    with pytest.raises(InputError, match=r"line 10: .*--rotary C,A"):
        read_program(file)
    file.write_text(FIVE_AXES.replace("G43.4 H2\n", ""))
    with pytest.raises(InputError, match="without tool centre control"):
        read_program(file, rotary="C,B")


TILTED = "G21 G90 G54\nG0 B30. C0.\nG68.2 X0 Y0 Z0 I90. J30. K-90.\nG53.1\n"


def test_angles_of_a_tilted_plane_are_not_turned_twice(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    cut = "G0 X5. Y0 Z9.\nG1 Z1. F60\nM30\n"
    file.write_text(f"{TILTED}G43.4 H1\n{cut}")
    found = read_program(file, rotary="C,B").operation().path.axis
    assert found is not None
    assert np.allclose(found, [0.5, 0, np.sqrt(0.75)])
    file.write_text(f"{TILTED}G43.4 H1\n{cut.replace('Z1.', 'Z1. B0. C0.')}")
    with pytest.raises(InputError, match=r"the tilted plane and its angles .* differ by 30"):
        read_program(file, rotary="C,B")


def test_the_machines_z_moves_along_all_axes_of_a_tilted_plane(tmp_path: Path) -> None:
    text = f"{TILTED}G0 X5. Y0 Z9.\nG53 Z0\nG0 Z9.\nG1 Z2. F60\nM30\n"
    with pytest.raises(InputError, match="line 8: a cut, but X and Y of the tool is not stated"):
        program(tmp_path, text)
    read = program(tmp_path, text.replace("G0 Z9.\n", "G0 X5. Y0\nZ9.\n"))
    assert len(read.operations[-1].path) == 2


def test_a_comment_with_commas_is_no_header_of_columns(tmp_path: Path) -> None:
    for comment in ("(size x, y, z)", "; x, y, z", "%"):
        text = f"{comment}\nG21 G90 G0 X0 Y0 Z9\nG1 Z1 F60\nM30\n"
        assert program(tmp_path, text).dialect == "G-code"


@pytest.mark.parametrize(
    ("first", "second"), [("G54.1 P1", "G54.1 P2"), ("G154 P1", "G154 P2"), ("G54", "G54.1 P1")]
)
def test_further_offsets_are_told_apart(tmp_path: Path, first: str, second: str) -> None:
    text = f"G21 G90 {first}\nG0 X0 Y0 Z5\n{second}\nG1 X9 F60\nM30\n"
    with pytest.raises(InputError, match=rf"line 4: {second} after motion in {first}"):
        program(tmp_path, text)
    assert len(operation(tmp_path, text.replace(second, first)).path) == 2


def test_a_file_without_any_z_is_flat(tmp_path: Path) -> None:
    read = program(tmp_path, "G21 G90\nG0 X1 Y1\nG1 X5 F600\nG2 X9 I2 J0\nM2\n")
    assert np.allclose(read.operation().path.position[:, 2], 0)
    assert "no Z in the whole file" in str(read.of_kind("assumed")[0])
    with pytest.raises(InputError, match="Z of the tool is not stated yet"):
        program(tmp_path, "G21 G90\nG0 X1 Y1\nG1 X5 F600\nG0 Z9\nM2\n")


def test_seconds_of_a_dwell_are_said(tmp_path: Path) -> None:
    read = program(tmp_path, "G21 G90 G0 X0 Y0 Z9\nG4 P50\nG1 Z1 F60\nM2\n")
    assert "less than 100 is in seconds" in str(read.of_kind("assumed")[0])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("N10 G30 G17 X+0 Y+0 Z-20*", "Heidenhain's DIN/ISO"),
        ("G1 X10,5 F100", "only those with a point"),
    ],
)
def test_why_a_line_is_not_read(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"G21 G90\nG0 X1 Y1 Z1\n{text}\n")


def test_programmed_frames_of_siemens(tmp_path: Path) -> None:
    """TRANS and ROT begin anew, ATRANS and AROT go on; the tool stays where it is."""
    head = "G710 G90 G54\nG0 X0 Y0 Z20\n"
    text = (
        f"{head}TRANS X50 Y20\nX0 Y0\nAROT Z90\nG1 X40 Y0 F600\nY-5\nTRANS\nG0 Z50\n"
        "R1=5\nATRANS X=R1\nATRANS Y2\nX0 Y0\nROT RPL=45\nX10 Y0\nM30\n"
    )
    found = positions(tmp_path, text)
    corner = 10 / np.sqrt(2)
    assert np.allclose(found, [
        [0, 0, 20], [50, 20, 20], [50, 60, 20], [55, 60, 20], [55, 60, 50], [5, 2, 50],
        [corner, corner, 50],
    ])  # fmt: skip


@pytest.mark.parametrize("word", ["DC", "AC", "ACP", "ACN"])
def test_an_angle_to_turn_to_holds_among_differences_too(tmp_path: Path, word: str) -> None:
    file = tmp_path / "part.mpf"
    file.write_text(
        "G710 G90\nTRAORI\nG0 X0 Y0 Z9 A=0 C=0\nG1 X1 A=20 C=90 F600\nG91\n"
        f"X1 A={word}(30) C={word}(180)\nX1 C=-90\nM30\n"
    )
    axis = read_program(file, rotary="C,A").operation().path.axis
    assert axis is not None
    s20 = np.sin(np.radians(20))
    # the spindle leans about A towards -Y, and C turns that
    assert np.allclose(axis[1], [s20, 0, np.sqrt(1 - s20**2)])
    assert np.allclose(axis[2], [0, 0.5, np.sqrt(0.75)])
    assert np.allclose(axis[3], [0.5, 0, np.sqrt(0.75)])


def feeds_of_g70(tmp_path: Path, file: str, text: str, **options: str) -> tuple[float, float, str]:
    """Length of the cut [mm], its feed [mm/min], and what is assumed."""
    path = tmp_path / file
    path.write_text(text)
    read = read_program(path, **options)
    found = read.operation()
    assumed = " ".join(map(str, read.of_kind("assumed")))
    return 1e3 * found.lengths()[0], 6e4 * float(found.path.feed[-1]), assumed


@pytest.mark.parametrize(("file", "sign"), [("part.mpf", ""), ("part.nc", "SUPA"), ("a.nc", "=")])
def test_g70_of_siemens_leaves_feeds_in_mm(tmp_path: Path, file: str, sign: str) -> None:
    order = {"SUPA": "SUPA Z0.\n", "=": "", "": ""}[sign]
    x = "X=4" if sign == "=" else "X4."
    text = f"{order}G71 G90\nG0 X0. Y0. Z10.\nG70\nG1 {x} F250\nM30\n"
    length, feed, assumed = feeds_of_g70(tmp_path, file, text)
    assert length == pytest.approx(101.6)
    assert feed == pytest.approx(250)
    assert "G70 (Siemens): lengths in inch, feeds still in mm" in assumed
    both = feeds_of_g70(tmp_path, file, text.replace("G70\n", "G700\n"))
    assert both[:2] == pytest.approx((101.6, 250 * 25.4))
    assert feeds_of_g70(tmp_path, file, text, units="inch")[1] == pytest.approx(250 * 25.4)


def test_g70_of_siemens_leaves_the_feed_of_a_cycle_in_mm(tmp_path: Path) -> None:
    text = "G70 G90\nG0 X0. Y0. Z1.\nF100\nCYCLE85(1,0,0.1,-1,,0,120,240)\nM30\n"
    length, _, _ = feeds_of_g70(tmp_path, "part.mpf", text)
    found = read_program(tmp_path / "part.mpf").operation().path.feed
    assert length > 25
    assert 6e4 * found[np.isfinite(found)] == pytest.approx([120, 240])


@pytest.mark.parametrize("said", ["#1=4", "(D=10 (CR=0) X=2)\n#1=4", "; X=2\n#1=4"])
def test_g70_of_another_control_is_of_feeds_too_and_said(tmp_path: Path, said: str) -> None:
    text = f"{said}\nG71 G90\nG0 X0. Y0. Z10.\nG70\nG1 X#1 F10.\nM30\n"
    length, feed, assumed = feeds_of_g70(tmp_path, "part.nc", text)
    assert (length, feed) == pytest.approx((101.6, 254))
    assert "G70 is taken for G20, lengths and feeds in inch. On a control of Siemens" in assumed
    assert "feeds stay in mm: if the file is for one, give it the ending .mpf; if not" in assumed
    assert "G70" not in feeds_of_g70(tmp_path, "part.nc", text, units="inch")[2]
    assert feeds_of_g70(tmp_path, "part.mpf", text)[:2] == pytest.approx((101.6, 10))


def test_a_variable_makes_no_control_of_siemens(tmp_path: Path) -> None:
    text = "#1=4\n#<len>=5\nG21 G90\nG0 X0. Y0. Z10.\nG1 X20 F100\nM30\n"
    assert "no decimal point" in feeds_of_g70(tmp_path, "part.nc", text)[2]


def test_reaming_goes_out_at_its_own_feed(tmp_path: Path) -> None:
    """RFF was said not to be carried out."""
    head = "G710 G90 G54\nS900 M3\nG0 X0 Y0 Z9\n"
    for call, feeds in (("60,30", [60, 30]), ("60", [60, 60])):
        read = program(tmp_path, f"{head}CYCLE85(5,0,2,-9,,0,{call})\nG1 X9 F80\nM30\n")
        found = read.operation().path.feed
        assert 6e4 * found[np.isfinite(found)] == pytest.approx([*feeds, 80])
        assert ("CYCLE85 without RFF" in str(read.notes)) == (feeds[1] == 60)
