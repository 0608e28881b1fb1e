"""G-code: words that say two things, and feeds that say none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90 G17\nG0 X0. Y0. Z0.\nF600\n"


def way(tmp_path: Path, text: str) -> float:
    """Length of the feed moves [mm]."""
    return 1e3 * program(tmp_path, f"{HEAD}{text}\nM30\n").operation().lengths()[0]


QUARTER = 10 * np.pi / 2


@pytest.mark.parametrize(
    ("arc", "length"),
    [
        ("G3 X10. Y10. I0. J10. R10.", QUARTER),
        ("G3 X10. Y10. I0. J10. R10.02", QUARTER),
        ("G2 X10. Y10. I0. J10. R-10.", 3 * QUARTER),
        ("G3 X0. Y20. I0. J10. R10.", 2 * QUARTER),
        # half a turn but for rounding
        ("G3 X0.01 Y20. I0. J10. R10.", 2 * QUARTER),
        ("G3 X-0.01 Y20. I0. J10. R10.", 2 * QUARTER),
        ("G3 X0. Y0. I0. J10. R10.", 4 * QUARTER),
        ("G3 X0. Y0. Z1. I0. J10. R10.", 4 * QUARTER),
        ("G3 X10. Y10. I0. J10. R10. P2", 5 * QUARTER),
    ],
)
def test_centre_and_radius_that_agree(tmp_path: Path, arc: str, length: float) -> None:
    assert way(tmp_path, arc) == pytest.approx(length, rel=1e-2)


@pytest.mark.parametrize(
    ("arc", "says"),
    [
        ("G3 X10. Y10. I0. J10. R20.", r"line 4: the centre .* R \(20 mm\) .* radii differ by 10"),
        ("G3 X10. Y10. I0. J10. R10.2", "their radii differ by 0.2 mm"),
        ("G3 X10. Y10. I0. J10. R-10.", "the one turns by 90 deg, the other by the rest"),
        ("G2 X10. Y10. I0. J10. R10.", "the one turns by 270 deg"),
        ("G3 X-0.2 Y0. I0. J10. R10.", "the one turns by 359 deg"),
    ],
)
def test_centre_and_radius_that_differ_are_refused(tmp_path: Path, arc: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        way(tmp_path, arc)


@pytest.mark.parametrize(
    "call", ["M98 P2 Q10", "M98 P2 H10", "G43 M98 P2 H10", "G43 H1 M98 P2 Q10"]
)
def test_a_sub_program_from_a_block_on_is_refused(tmp_path: Path, call: str) -> None:
    sub = "O2\nX5.\nN10 X9.\nM99\n"
    with pytest.raises(InputError, match=r"line 5: M98 calls .* by a line's number \(P, Q, H\)"):
        program(tmp_path, f"O1\n{HEAD}{call}\nM30\n{sub}")


@pytest.mark.parametrize("block", ["G43 H4", "G43.4 Z0. H04", "N5G43H4"])
def test_the_register_of_a_length_is_no_block_of_a_sub_program(tmp_path: Path, block: str) -> None:
    sub = "O2\nG1 X5.\nN4 X9.\nM99\n"
    found = program(tmp_path, f"O1\n{HEAD}{block} M98 P2\nM30\n{sub}").operation()
    assert found.tool.length_offset == 4
    assert found.lengths()[0] == pytest.approx(9e-3)


def test_a_call_of_no_times_is_said(tmp_path: Path) -> None:
    read = program(tmp_path, f"O1\n{HEAD}G1 X1.\nM98 P2 L0\nM30\nO2\nX5.\nM99\n")
    assert 1e3 * read.operation().path.position[-1, 0] == pytest.approx(1)
    notes = " ".join(map(str, read.of_kind("assumed")))
    assert "line 6: M98 P2 L0: the sub-program is called no times" in notes


@pytest.mark.parametrize(
    "both",
    ["G90 G91", "G20 G21", "G71 G20", "G17 G18", "G94 G93", "G98 G99", "G90.1 G91.1"],
)
def test_two_codes_of_a_group_in_one_block_are_refused(tmp_path: Path, both: str) -> None:
    first, second = sorted(both.split(), key=lambda code: float(code[1:]))
    with pytest.raises(InputError, match=rf"line 4: found {first} and {second} in one block"):
        way(tmp_path, f"{both} G1 X9. F600.")


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("G81 X5. Y5. Z-9. R2. F10.", r"line 5: G81 in inverse time \(G93\)"),
        ("G5 X10. Y0. I2. J2. P-2. Q2.", "line 5: G93 .* needs F in every cutting block"),
    ],
)
def test_what_has_no_time_of_its_own_in_inverse_time(tmp_path: Path, block: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        way(tmp_path, f"G93 G1 X5. F10.\n{block}")


PLANE = "G68.2 X0. Y0. Z0. I0. J30. K0.\n"


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (f"{PLANE}G1 X9. F60.\nG69\n", [4]),
        (f"{PLANE}G53.1\nG1 X9. F60.\nG69\n", []),
        (f"G0 A30. C0.\n{PLANE}G0 X0. Y0. Z0.\nG1 X9. F60.\nG69\n", []),
        (f"{PLANE}G1 X9. F60.\n{PLANE}G53.1\nG0 X5.\nG69\n{PLANE}G0 X1.\n", [4, 10]),
        ("G68.2 X9. Y0. Z0. I0. J0. K45.\nG1 X9. F60.\nG69\n", []),
    ],
)
def test_a_plane_that_nothing_turns_the_tool_to_is_said(
    text: str, lines: list[int], tmp_path: Path
) -> None:
    notes = program(tmp_path, f"{HEAD}{text}M30\n", "C,A").of_kind("assumed")
    found = {note.line: note.count for note in notes if "G68.2 without G53.1" in note.text}
    assert sum(found.values()) == len(lines)
    assert list(found) == lines[:1]


@pytest.mark.parametrize("feed", ["F0", "F0.", "G93 F0"])
def test_a_cut_at_feed_zero_is_refused(tmp_path: Path, feed: str) -> None:
    with pytest.raises(InputError, match="line 4: a cut with the feed zero"):
        way(tmp_path, f"G1 X9. {feed}")
    assert way(tmp_path, "G0 X9. F0\nG1 X10. F60") == pytest.approx(1)


@pytest.mark.parametrize("cells", [("", ""), (",feed_mm_s", ",")])
def test_a_table_without_feeds_says_so(tmp_path: Path, cells: tuple[str, str]) -> None:
    file = tmp_path / "path.csv"
    head, row = cells
    rows = "".join(f"{x},0,0,0,0,1{row}\n" for x in (0, 100))
    file.write_text(f"# drawn\nx_mm,y_mm,z_mm,i,j,k{head}\n{rows}")
    (note,) = read_program(file).of_kind("assumed")
    assert note.line == 2
    assert "feed_mm_s" in note.text
    assert "no feed is stated, and the moves are as fast as the limits of the arm" in note.text


def test_a_table_with_a_feed_says_nothing(tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text("x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n0,0,0,0,0,1,\n100,0,0,0,0,1,20\n")
    assert read_program(file).of_kind("assumed") == []


@pytest.mark.parametrize("switch", ["/", "/2 ", "/2", "/ 9"])
def test_blocks_behind_a_switch_are_carried_out_and_it_is_said(tmp_path: Path, switch: str) -> None:
    assert way(tmp_path, f"{switch}G1 X9.") == pytest.approx(9)
    sub = f"O1\n{HEAD}{switch}M98 P2\nM30\nO2\nG1 X9.\nM99\n"
    read = program(tmp_path, sub)
    assert read.operation().lengths()[0] == pytest.approx(9e-3)
    assert "line 5: blocks behind / are carried out" in map(str, read.of_kind("assumed"))


@pytest.mark.parametrize("line", ["// Note: G70 is inch", "//G1 X50.", "//O0001 rail", "// M98 P2"])
def test_a_line_behind_two_slashes_is_a_comment_and_it_is_said(tmp_path: Path, line: str) -> None:
    read = program(tmp_path, f"O1\n{HEAD}{line}\nG1 X9.\nM30\nO2\nG1 X50.\nM99\n")
    assert read.operation().lengths()[0] == pytest.approx(9e-3)
    assert "line 5: lines behind // are comments" in map(str, read.of_kind("assumed"))


@pytest.mark.parametrize(
    ("comment", "code", "says"),
    [
        ("(UNITS: INCHES)", "", "line 1: the unit of lengths from the comment (UNITS: INCHES)"),
        ("(INCH)", "", "line 1: the unit of lengths from the comment (INCH)"),
        (
            "(ALL UNITS IN INCH)",
            "G21",
            "(ALL UNITS IN INCH) and the code differ: lengths are in mm",
        ),
        ("(METRIC)", "G20", "(METRIC) and the code differ: lengths are in inch (G20)"),
        ("(1/2 INCH ENDMILL)", "", "neither G20 nor G21 in the file: lengths in mm"),
        ("(Units: mm)", "G21", ""),
    ],
)
def test_a_unit_in_a_comment(tmp_path: Path, comment: str, code: str, says: str) -> None:
    read = program(tmp_path, f"{comment}\n{code} G90\nG0 X0. Y0. Z9.\nG1 X60. F100.\nM30\n")
    inch = code == "G20" or (not code and "unit of lengths from" in says)
    assert read.operation().lengths()[0] == pytest.approx(60 * (25.4e-3 if inch else 1e-3))
    assert says in " ".join(map(str, read.notes))
    assert bool(says) == any("comment" in str(n) or "neither" in str(n) for n in read.notes)


@pytest.mark.parametrize("text", ["", "(only a comment)\n", "M3 S600\n"])
def test_a_file_without_motion_is_not_said_to_lack_z(tmp_path: Path, text: str) -> None:
    file = tmp_path / "part.nc"
    file.write_text(text)
    notes = " ".join(map(str, read_program(file, strict=False).notes))
    assert "no Z" not in notes
    assert "line 1: no motion in the whole file" in notes
    with pytest.raises(InputError, match="found 0 point"):
        read_program(file)
