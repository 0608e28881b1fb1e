"""Words that belong to nothing in their block, or stand there twice, are refused; no others are."""

from __future__ import annotations

from pathlib import Path

import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90\nG0 X10 Y0 Z0\nG1 Z-1 F600\n"


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("G3 X10 Y0 Z-5 I-10 J0 L5", r"found L5 beside G3, .*the turns of a helix"),
        ("G2 X0 Y0 R5 L2", "found L2 beside G2"),
        ("G1 X20 L3", "found L3 beside G1"),
        ("X20 P7", r"found P7 beside G1, .*the turns of G2 and G3"),
        ("G0 X20 P7", "found P7 beside G0"),
        ("G1 X20 D4", r"found D4 beside G1, .*G41"),
        ("G3 X0 Y0 R5 Q4", r"found Q4 beside G3, .*a step of G73"),
        ("G1 X20 Q4", "Q in a straight move"),
        ("G1 X20 F100 F200", "found F100 and F200 in one block"),
        ("S100 S2000 M3", "found S100 and S2000 in one block"),
    ],
)
def test_a_word_that_says_nothing_is_refused(tmp_path: Path, block: str, says: str) -> None:
    with pytest.raises(InputError, match=f"line 4: {says}"):
        program(tmp_path, f"{HEAD}{block}\nG1 X0\nM30\n")


@pytest.mark.parametrize(
    "block",
    [
        "G4 P0.5 G1 X20",
        "G3 X10 Y0 Z-5 I-10 J0 P2",
        "G0 G40 X20 D0",
        "G43 H1 D1 G0 X20",
        "G187 P1 G1 X20",
        "G64 P0.01 G1 X20",
        "G1 X20 M62 P0",
        "G30 P2 Z9\nG1 X0 Y0 Z0",
        "G83 X20 Y0 Z-9 R2 Q3 P1 L1\nG80\nG1 X20",
        "G1 X20 F100 F100",
        "G5 X20 Y0 I5 J0 P0 Q-5",
    ],
)
def test_a_word_that_belongs_to_another_code_is_none(tmp_path: Path, block: str) -> None:
    assert program(tmp_path, f"{HEAD}{block}\nG1 X0\nM30\n").operations


def test_the_edge_of_a_tool_and_its_change_beside_a_motion(tmp_path: Path) -> None:
    file = tmp_path / "part.mpf"
    file.write_text("G710 G90\nT1 L6\nG0 X0 Y0 Z9 D1\nG1 X5 F100 D1\nT2 L6 G0 X9\nG1 X0\nM30\n")
    assert [operation.tool.number for operation in read_program(file).operations] == [1, 2]
