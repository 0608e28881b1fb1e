"""Canned cycles whose words stay, and holes as calls of Siemens controls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program

HEAD = "G21 G17 G94\nG90 G0 X0 Y0 Z10\n"


def heights(tmp_path: Path, text: str) -> list[tuple[float, ...]]:
    """x and z of all points [mm], and whether each was reached rapidly."""
    found = program(tmp_path, text).operation()
    points = 1e3 * found.path.position
    return [
        (round(float(x), 6), round(float(z), 6), float(r))
        for (x, _, z), r in zip(points, found.rapid, strict=True)
    ]


# what LinuxCNC's own interpreter (rs274) moves for the same blocks
@pytest.mark.parametrize(("code", "up"), [("G99", 2), ("G98", 10)])
def test_a_cycle_in_g91_goes_as_deep_at_each_place(tmp_path: Path, code: str, up: float) -> None:
    found = heights(tmp_path, f"{HEAD}{code} G91 G81 X5 Y0 Z-5 R-8 F100\nX5\nX5\nG80\nM2\n")
    for x in (5, 10, 15):
        assert [(z, r) for at, z, r in found if at == x][-3:] == [(2, 1), (-3, 0), (up, 1)]


def test_places_in_g91_of_a_cycle_in_g90_and_back(tmp_path: Path) -> None:
    text = f"{HEAD}G99 G81 X5 Z-5 R2 F100\nG91 X5 L2\nG90 X30\nG80\nM2\n"
    found = heights(tmp_path, text)
    for x in (10, 15, 30):
        assert [(z, r) for at, z, r in found if at == x] == [(2, 1), (-5, 0), (2, 1)]
    assert "Z and R stay the heights" in " ".join(map(str, program(tmp_path, text).notes))


def test_g98_at_the_last_hole_goes_back_to_the_first_height(tmp_path: Path) -> None:
    found = heights(tmp_path, f"{HEAD}G99 G81 X5 Z-5 R2 F100\nX9\nG98 X15\nG80\nM2\n")
    assert found[-1] == (15, 10, 1)
    assert found[-2] == (15, -5, 0)


SIEMENS = "G17 G710 G90 G94\nS500 M3\nG0 X0 Y0\nZ15\nF600\n"


def test_modal_calls_drill_after_each_move(tmp_path: Path) -> None:
    calls = "MCALL CYCLE81(5, -1, 5, -17.5, , 0, 0, 10)\nX7 Y0\nX20\nMCALL\nX30\n"
    found = heights(tmp_path, f"{SIEMENS}{calls}M30\n")
    for x in (7, 20):
        assert [(z, r) for at, z, r in found if at == x][-3:] == [(4, 1), (-17.5, 0), (5, 1)]
    assert found[-1] == (30, 5, 1)


def test_a_call_drills_where_the_tool_is(tmp_path: Path) -> None:
    found = heights(tmp_path, f"{SIEMENS}CYCLE82(10,0,2,,12,0.5)\nG0 X9\nM30\n")
    assert found[-4:] == [(0, 2, 1), (0, -12, 0), (0, 10, 1), (9, 10, 1)]
    events = program(tmp_path, f"{SIEMENS}CYCLE82(10,0,2,,12,0.5)\nG0 X9\nM30\n").operation().events
    assert [e.seconds for e in events if e.kind == "dwell"] == [0.5]


@pytest.mark.parametrize(("variant", "rises"), [(1, True), (0, False)])
def test_deep_holes_step_by_step(tmp_path: Path, variant: int, rises: bool) -> None:
    """The depths of the same hole as a CAM system writes it out in moves: 1, less 0.1 each time,
    at least 0.5."""
    call = f"MCALL CYCLE83(5,-1,5,-7,,-2,,0.1,0,0,1,{variant},,0.5)\nX0 Y0\nMCALL\n"
    found = heights(tmp_path, f"{SIEMENS}{call}M30\n")
    assert [z for _, z, r in found if not r] == pytest.approx(
        [-2, -2.9, -3.7, -4.4, -5, -5.5, -6, -6.5, -7]
    )
    first = next(r for r in found if r[1] == -2)
    assert (found[found.index(first) + 1][1] == pytest.approx(4)) is rises


def test_what_a_deep_hole_states_and_is_not_carried_out_is_said(tmp_path: Path) -> None:
    call = "MCALL CYCLE83(5,-1,5,-7,,-2,,0.1,0,0,{},1,,0.5,{})\nX0 Y0\nMCALL\nM30\n"
    found = program(tmp_path, SIEMENS + call.format("0.5", "1"))
    says = "FRF (share of the feed for the first depth) 0.5, _VRT (way back at a break) 1 is not"
    assert says in str(found.of_kind("assumed"))
    found = program(tmp_path, SIEMENS + call.format("1", ""))
    assert "not carried out" not in str(found.of_kind("assumed"))


def test_tapping_feeds_pitch_times_speed(tmp_path: Path) -> None:
    call = "MCALL CYCLE84(16,10,5,1,,0,3,,1.5,0,400,400,0,1)\nX-20 Y20\nMCALL\nG0 X0\n"
    found = program(tmp_path, f"{SIEMENS}{call}M30\n").operation()
    feeds = found.path.feed[~found.rapid]
    assert feeds == pytest.approx(np.full(len(feeds), 0.6 / 60))
    assert len(feeds) == 2


@pytest.mark.parametrize(
    ("call", "says"),
    [
        ("CYCLE87(5,0,2,-9)", "CYCLE87 is not read; expected one of CYCLE81"),
        ("CYCLE81(5,0,2)", "CYCLE81 states no depth"),
        ("CYCLE81(5,0,2,-9,8)", "DP -9 and DPR 8 differ"),
        ("CYCLE81(5,0,2,3)", "expected retraction plane over reference plane over depth"),
        ("CYCLE81(5,0,2,-9,,0,10)", "counts the depth at the shank"),
        ("CYCLE81(5,0,2,R1)", "found 'R1', expected a number"),
        ("CYCLE84(5,0,2,-9,,0,3,8,,0,400)", "CYCLE84 without PIT and SST"),
        ("MCALL POCKET3(5,0,2,-9)", "cycles written as calls"),
        ("CYCLE800(1,\"R\",1,57,0,0,0,0,-15,0,0,0,0,-1,0)", "on top of another one"),
        ("CYCLE800(1,\"R\",1000,57,0,0,0,0,-15,0,0,0,0,-1,0)", "aligns a turning tool"),
        ("CYCLE800(1,\"R\",0,64,0,0,0,0,-15,0,0,0,0,-1,0)", "states solid angle"),
        ("CYCLE800(1,\"R\",0,192,0,0,0,0,-15,0,0,0,0,-1,0)", "rotary axes directly"),
        ("CYCLE800(1,\"R\",0,21,0,0,0,0,-15,0,0,0,0,-1,0)", "names no three axes"),
        ("CYCLE800(1,\"R\",0,57,0,0,0,0,-15,0,0,0,0,0,0)", "does not turn the tool"),
        ("CYCLE800(1,\"R\",0,57,0,0,0,0,Q,0,0,0,0,-1,0)", "found 'Q', expected a number"),
    ],
)  # fmt: skip
def test_calls_that_are_not_read(tmp_path: Path, call: str, says: str) -> None:
    with pytest.raises(InputError, match=rf"part\.nc, line 6.*{says}"):
        program(tmp_path, f"{SIEMENS}{call}\nX5\nM30\n")


def test_words_around_a_program_of_siemens_controls(tmp_path: Path) -> None:
    text = (
        'N1 WORKPIECE(,"",,"BOX",112,0,-51,,50,25)\nN2 G500 G17 G710 G90\nSETMS(1)\nCYCLE800()\n'
        "G54\nG0 X1 Y2 Z3 C=DC(0)\nG1 X9 F600\nM30\n"
    )
    assert len(program(tmp_path, text).operation().path) == 2


def holes(found: CamProgram) -> list[tuple[float, float]]:
    """Where the tool is lowest, in the order of the file [mm]."""
    points = 1e3 * found.operation().path.position
    low = points[points[:, 2] < points[:, 2].min() + 1e-6]
    return [(round(float(x), 6), round(float(y), 6)) for x, y, _ in low]


def test_rows_and_circles_of_holes_drill_as_the_modal_call_says(tmp_path: Path) -> None:
    call = "MCALL CYCLE81(10,0,2,-5)\n"
    row = holes(program(tmp_path, f"{HEAD}F100\n{call}HOLES1(20,30,90,5,10,3)\nMCALL\nG0 X9\n"))
    assert row == [(20, 35), (20, 45), (20, 55)]
    circle = holes(program(tmp_path, f"{HEAD}F100\n{call}HOLES2(0,0,20,30,0,4)\nMCALL\n"))
    expected = [(17.320508, 10), (-10, 17.320508), (-17.320508, -10), (10, -17.320508)]
    assert np.allclose(circle, expected)
    arc = holes(program(tmp_path, f"{HEAD}F100\n{call}HOLES2(5,0,10,0,90,2)\nMCALL\n"))
    assert arc == [(15, 0), (5, 10)]


def test_a_row_of_holes_begins_at_its_nearer_end(tmp_path: Path) -> None:
    calls = "F100\nMCALL CYCLE81(10,0,2,-5)\nHOLES1(0,0,0,10,10,3)\nMCALL\n"
    assert holes(program(tmp_path, f"{HEAD}X90\n{calls}")) == [(30, 0), (20, 0), (10, 0)]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("HOLES1(0,0,0,10,10,3)", "line 4.*MCALL CYCLE81"),
        ("MCALL CYCLE81(10,0,2,-5)\nHOLES1(0,0,0,10,10)", "line 5.*NUM from 1"),
        ("MCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,0,0,0,4)", "line 5.*positive radius"),
        ("MCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,9,0,0,4,1010)", "line 5.*1010 behind NUM"),
    ],
)
def test_a_pattern_that_says_too_little_is_refused(tmp_path: Path, call: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        program(tmp_path, f"{HEAD}F100\n{call}\nMCALL\nG0 X9\n")


def test_polar_coordinates(tmp_path: Path) -> None:
    # Fanuc, bolt hole circle: absolute angles, and as ways from one to the next
    absolute = "G16\nG81 X100 Y30 Z-20 R2 F200\nY150\nY270\nG15 G80\nG0 X0 Y0\n"
    ways = "G16\nG81 X100 Y30 Z-20 R2 F200\nG91 Y120 K2\nG90 G15 G80\nG0 X0 Y0\n"
    expected = [(86.60254, 50), (-86.60254, 50), (0, -100)]
    for code in (absolute, ways):
        found = program(tmp_path, HEAD + code)
        assert np.allclose(holes(found), expected)
        assert np.allclose(found.operation().path.position[-1, :2], 0)


@pytest.mark.parametrize(
    ("code", "said"),
    [("G16 G91 X10 Y20", "radius X in G91"), ("G18 G16 X10 Y20", "plane G18")],
)
def test_polar_coordinates_that_are_not_read(tmp_path: Path, code: str, said: str) -> None:
    with pytest.raises(InputError, match=f"line 3.*{said}"):
        program(tmp_path, f"{HEAD}{code}\nG15\nG0 X9\n")


def test_one_word_absolute_or_as_a_way(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G1 X=IC(5) Y=AC(7) F100\nG91 X=AC(1) Y=IC(2) Z1\n")
    points = 1e3 * found.operation().path.position
    assert np.allclose(points, [(0, 0, 10), (5, 7, 10), (1, 9, 11)])


def test_an_axis_that_turns_by_an_angle(tmp_path: Path) -> None:
    head = f"{HEAD}TRAORI\nG1 X5 A20 C30 F100\n"
    axes = []
    for word in ("C=IC(45)", "C75", "C=AC(75)"):
        file = tmp_path / "part.nc"
        file.write_text(f"{head}X10 {word}\n")
        axes.append(read_program(file, rotary="C,A").operation().path.axis)
    assert axes[0] is not None
    assert np.allclose(axes[0], axes[1])
    assert np.allclose(axes[0], axes[2])
    assert not np.allclose(axes[0][-1], axes[0][-2])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("G73 X5 Y0 Z-10 R2 Q2 K0.5 F100", r"line 3: G73 with K0.5: K says how often .* length"),
        ("G83 X5 Y0 Z-10 R2 Q2 K0.2 F100", "G83 with K0.2"),
        ("G81 X5 Y0 Z-10 R2 L1.5 F100", "G81 with L1.5"),
        ("G81 X5 Y0 Z-10 R2 K-1 F100", "G81 with K-1"),
        ("G81 X5 Y0 Z-10 R2 L2 K3 F100", "found L2 and K3 in a cycle"),
    ],
)
def test_a_count_that_is_none_loses_no_hole(tmp_path: Path, words: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"{HEAD}{words}\nX9\nG80\nM2\n")


@pytest.mark.parametrize(
    ("hole", "says"),
    [
        ("G83 X5. Z-9. R2. Q2. I4. J1. F60", "line 3: found I4 in the cycle G83"),
        ("G81 X5. Z-9. R2. D3. F60", "line 3: found D3 in the cycle G81"),
        ("G83 X5. Z-9. R2. Q0.0001 F60", "line 3: G83: a step of 0.0001 mm makes more than 10000"),
    ],
)
def test_steps_that_are_not_carried_out_are_refused(tmp_path: Path, hole: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"{HEAD}{hole}\nG80\nM2\n")
    # how fast a tap turns back moves it no further
    assert heights(tmp_path, f"{HEAD}G84 X5. Z-9. R2. J2. F60\nG80\nM2\n")[-2:]


def test_a_count_of_zero_only_keeps_the_words_and_is_said(tmp_path: Path) -> None:
    text = f"{HEAD}G81 X5 Y0 Z-5 R2 K0 F100\nX9\nG80\nM2\n"
    found = heights(tmp_path, text)
    assert [x for x, z, _ in found if z == -5] == [9]
    assert "K0 in a cycle" in " ".join(map(str, program(tmp_path, text).of_kind("assumed")))


def test_the_same_hole_several_times_is_said(tmp_path: Path) -> None:
    notes = program(tmp_path, f"{HEAD}G73 X5 Y0 Z-5 R2 Q2 K2 F100\nG80\nM2\n").of_kind("assumed")
    assert "the same hole 2 times; on some controls K is a length" in " ".join(map(str, notes))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("part.nc", "G21 G90\nG43.4 H1\nG0 X0 Y0 Z20 A30\nG1 Z10 F100\nG81 X5 Z-5 R2 F100\n"),
        ("part.mpf", "G71 G90\nTRAORI\nG0 X0 Y0 Z20 A30\nG1 Z10 F100\nCYCLE81(20,0,2,-5)\n"),
        (
            "part.h",
            "BEGIN PGM A MM\nM128\nL X+0 Y+0 Z+20 A+30 FMAX\nL Z+10 F100\n"
            "CYCL DEF 200 Q200=2 Q201=-10 Q206=150 Q203=0\nL X+5 F100 M99\n",
        ),
    ],
)
def test_a_hole_with_the_tool_not_along_z_is_refused(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(InputError, match="a cycle with the tool not along its Z"):
        read_program(file, rotary="C,A")


@pytest.mark.parametrize(
    ("word", "seconds", "told"),
    [
        ("P50", 0.05, "from 10 on, is in milliseconds"),
        ("P500", 0.5, "from 10 on, is in milliseconds"),
        ("P2", 2.0, "below 10, is in seconds"),
        ("P0.5", 0.5, ""),
    ],
)
def test_a_dwell_in_a_hole(tmp_path: Path, word: str, seconds: float, told: str) -> None:
    """P50 stood in each hole for 50 s."""
    read = program(tmp_path, f"{HEAD}S900 M3\nG82 X5 Y0 Z-5 R2 {word} F100\nG80\nM2\n")
    events = read.operation().events
    assert [event.seconds for event in events if event.kind == "dwell"] == [seconds]
    notes = [note for note in map(str, read.of_kind("assumed")) if "P of a cycle" in note]
    assert [told in note for note in notes] == [True] * bool(told)
