"""Lengths of tools that a CAM file states are not applied, and this is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400

from irb2400_ctrl.planners import read_program


def said(tmp_path: Path, name: str, text: str) -> list[str]:
    file = tmp_path / name
    file.write_text(text)
    return [str(n) for n in read_program(file).of_kind("assumed") if "not applied" in n.text]


def nx(*tools: tuple[int, str, float]) -> str:
    """Operations of Siemens NX, one a tool: number, name and length [mm]."""
    lines = []
    for number, name, length in tools:
        lines += [
            f"TOOL PATH/OP{number},TOOL,{name}",
            f"TLDATA/MILL,10.0,0.0,{length},0.0,0.0",
            "MSYS/0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0",
            f"LOAD/TOOL,{number}",
            "RAPID",
            "GOTO/0.0,0.0,20.0,0.0,0.0,1.0",
            "FEDRAT/MMPM,1200.0",
            "GOTO/60.0,0.0,0.0",
            "END-OF-PATH",
        ]
    return "\n".join(lines) + "\n"


def test_tools_of_several_lengths_are_named_with_what_to_do(tmp_path: Path) -> None:
    (note,) = said(tmp_path, "part.cls", nx((1, "MILL_10", 50.0), (2, "DRILL_5", 160.0)))
    assert "line 15: " in note
    assert "tool 1 MILL_10 (50 mm); tool 2 DRILL_5 (160 mm)." in note
    assert "--cell: [[tools]] with number and offset_mm, docs/cells.md" in note
    assert "without one all have the TCP of the robot file" in note


def test_one_tool_gets_a_short_note(tmp_path: Path) -> None:
    (note,) = said(tmp_path, "part.cls", nx((1, "MILL_10", 50.0)))
    assert note == (
        "line 6: tool 1 MILL_10 (50 mm): its length is not applied, the tip is the TCP of the "
        "robot file or of the cell's tool"
    )


CUT = "G0 X0. Y0. Z5.\nG1 X9. F60\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"T1 M6\nG43 H1\n{CUT}T2 M6\nG43 H2\n{CUT}", "tool 1 (offset H1); tool 2 (offset H2)."),
        (f"T1 M6\n{CUT}T2 M6\nG43 H2\n{CUT}", "tool 1 (none stated); tool 2 (offset H2)."),
        (f"T1 M6\nG43 H1\n{CUT}M0\nG43 H5\n{CUT}", "tool 1 (offset H1, offset H5)."),
        (f"T1 M6\nG43 H1\n{CUT}", "tool 1 (offset H1): its length is not applied"),
    ],
)
def test_registers_of_g_code(tmp_path: Path, text: str, says: str) -> None:
    (note,) = said(tmp_path, "part.nc", f"G21 G90\n{text}M30\n")
    assert says in note


def test_tools_without_lengths_are_said_to_need_tips_of_a_cell(tmp_path: Path) -> None:
    text = "".join(f"T{n} M6\n{CUT}" for n in range(1, 11))
    assert said(tmp_path, "part.nc", f"G21 G90\n{text}M30\n") == []
    notes = " ".join(map(str, read_program(tmp_path / "part.nc").of_kind("assumed")))
    assert "the file states no length of any: tool 1; tool 2; " in notes
    assert "tool 8; and 2 more. Each tool has the tip that the cell gives it (--cell:" in notes


@pytest.mark.parametrize("text", [f"T1 M6\n{CUT}", CUT, f"T1 M6\nG43 H0\n{CUT}"])
def test_one_tool_without_a_length_needs_no_note(tmp_path: Path, text: str) -> None:
    assert said(tmp_path, "part.nc", f"G21 G90\n{text}M30\n") == []


def test_many_tools_are_not_all_named(tmp_path: Path) -> None:
    text = nx(*((n, f"MILL_{n}", 40.0 + n) for n in range(1, 13)))
    (note,) = said(tmp_path, "part.cls", text)
    assert "tool 8 MILL_8 (48 mm); and 4 more." in note


def test_path_show_prints_it(tmp_path: Path) -> None:
    (tmp_path / "part.cls").write_text(nx((1, "MILL_10", 50.0), (2, "DRILL_5", 160.0)))
    done = irb2400("path", "show", "part.cls", cwd=tmp_path)
    assert "lengths of tools in the file are not applied: tool 1 MILL_10 (50 mm)" in done.stdout


PART = "G0 X0 Y0 S900 M3\n{length}Z9\nG1 Z-5 F100\nX5\nG0 Z3\n"


@pytest.mark.parametrize(
    ("end", "heights", "told"),
    [
        # without a length the spindle goes to zero, up where its axis begins
        ("Y-7\nG49 Z0 M5\nX20\nM30\n", [9, -5, -5, 3, 3], True),
        ("G49 G0 Y-7 Z40\nM30\n", [9, -5, -5, 3], True),
        ("G91 G28 Z0 G49\nM30\n", [9, -5, -5, 3], False),
        ("G49\nM30\n", [9, -5, -5, 3], False),
    ],
)
def test_a_height_beside_g49_is_the_spindles(
    tmp_path: Path, end: str, heights: list[float], told: bool
) -> None:
    file = tmp_path / "part.nc"
    file.write_text(f"G21 G90 G40 G49 G80\n{PART.format(length='G43 H1 ')}{end}")
    found = read_program(file)
    assert np.allclose(1e3 * found.operation().path.position[:, 2], heights)
    assert ("Z beside G49" in str(found.of_kind("assumed"))) is told


def test_without_lengths_the_height_beside_g49_is_the_tips(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text(f"G21 G90\nG0 G40 G49 G80 Z9\n{PART.format(length='')}G0 G49 Z30\nM30\n")
    heights = (1e3 * read_program(file).operation().path.position[:, 2]).round(6)
    assert np.allclose(np.unique(heights), [-5, 3, 9, 30])


@pytest.mark.parametrize(
    ("end", "heights"),
    [
        ("G0 D0 Z0\n", [9, -5, -5, 3]),
        ("SUPA G0 Z0 D0\n", [9, -5, -5, 3]),
        ("G0 D1 Z30\n", [9, -5, -5, 3, 30]),
    ],
)
def test_a_height_beside_d0_is_the_spindles(tmp_path: Path, end: str, heights: list[float]) -> None:
    file = tmp_path / "part.mpf"
    file.write_text(f"G17 G90 G71 G54\nT1 D1\nM6\n{PART.format(length='')}{end}M30\n")
    found = read_program(file)
    assert np.allclose(1e3 * found.operation().path.position[:, 2], heights)
    assert ("Z beside D0" in str(found.of_kind("assumed"))) is end.startswith("G0 D0")
