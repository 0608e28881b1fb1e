"""Arcs whose ends all but agree: short where they differ, a full circle where they do not."""

from __future__ import annotations

from pathlib import Path

import pytest
from gcode_files import program

from irb2400_ctrl.planners import read_program

CIRCLE = 62.8319
"""about a radius of 10 mm [mm]"""


def cut(tmp_path: Path, name: str, text: str) -> float:
    """Length of the last way [mm]."""
    file = tmp_path / name
    file.write_text(text)
    return 1e3 * read_program(file).operation().lengths()[0]


@pytest.mark.parametrize(
    ("block", "length"),
    [
        ("G3 X10 Y0.001 I-10 J0", 0.001),
        ("G2 X10 Y-0.001 I-10 J0", 0.001),
        ("G3 X10 Y0.0001 I-10 J0", 0.0001),
        ("G3 X10 Y0.001 R10", 0.001),
        ("G3 X10 Y-0.001 I-10 J0", CIRCLE - 0.001),
        ("G3 X10 Y0.001 R-10", CIRCLE - 0.001),
        ("G3 X10 Y0.001 I-10 J0 P2", CIRCLE + 0.001),
        ("G3 X10 Y0 I-10 J0", CIRCLE),
        ("G91 G3 X0 Y0 I-10", CIRCLE),
        # sums and turned coordinates round
        ("G91\nX0.1\nX0.2\nG90\nG3 X10.3 Y0 I-10.3", 0.3 + 1.03 * CIRCLE),
        ("G68 X10 Y0 R33\nX10 Y0\nG3 X10 Y0 I-10 J0", CIRCLE),
        # the last digit of six, which is no turn on any control
        ("G3 X10 Y0.000009 I-10 J0", CIRCLE),
        ("G3 X10 Y-0.000009 I-10 J0", CIRCLE),
        # beside the start only across the circle
        ("G3 X10.0005 Y0 I-10 J0", CIRCLE),
    ],
)
def test_a_short_arc_is_no_full_circle(tmp_path: Path, block: str, length: float) -> None:
    text = f"G21 G90\nG0 X10 Y0 Z0\nF600\nG1 X10\n{block}\nG1 Z-5\nM30\n"
    assert cut(tmp_path, "part.nc", text) == pytest.approx(length + 5, rel=2e-3, abs=1e-7)


def test_a_full_circle_in_inches(tmp_path: Path) -> None:
    found = program(tmp_path, "G20 G90\nG0 X.3 Y.1 Z0\nG91\nG1 X.1 F9\nG90\nG3 X.4 Y.1 I-.4\nM30\n")
    assert 1e3 * found.operation().lengths()[0] == pytest.approx(25.4 * (0.1 + 0.8 * 3.14159), 2e-3)


def test_short_arcs_of_other_languages(tmp_path: Path) -> None:
    siemens = "G21 G90\nG0 X10 Y0 Z0\nG1 Z-5 F600\nG3 X10 Y0.001 I=AC(0) J=AC(0)\nM30\n"
    assert cut(tmp_path, "part.mpf", siemens) == pytest.approx(5.001, abs=1e-6)
    plain = (
        "0 BEGIN PGM P MM\n1 L X+10 Y+0 Z+0 R0 FMAX\n2 L Z-5 F600\n3 CC X+0 Y+0\n"
        "4 C X+10 Y+{} DR+\n5 END PGM P MM\n"
    )
    assert cut(tmp_path, "part.h", plain.format("0.001")) == pytest.approx(5.001, abs=1e-6)
    assert cut(tmp_path, "part.h", plain.format("0")) == pytest.approx(5 + CIRCLE, rel=2e-3)
    apt = (
        "UNITS/MM\nFEDRAT/600,MMPM\nGOTO/10,0,5\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\n"
        "GOTO/10.0000,{},0\n"
    )
    assert cut(tmp_path, "part.apt", apt.format("0.0005")) == pytest.approx(5.0005, abs=1e-6)
    # to the digits of the file it closes
    assert cut(tmp_path, "part.apt", apt.format("0.0001")) == pytest.approx(5 + CIRCLE, rel=2e-3)
