"""G-code: how often sub-programs are called, and those that begin at a block (M97 of Haas)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import positions, program

from irb2400_ctrl.errors import InputError

HEAD = "%\nO1\nG21 G90 G54\n#25=3.\nG0 X0. Y0. Z5.\nG1 Z0. F100.\n"
SUB = "G91 G1 X10.\nG90\nM99\n"


@pytest.mark.parametrize("often", ["L3", "L#25", "L[#25]", "L[[#25-1]*2-1]", "K#25"])
def test_a_count_may_be_an_expression(tmp_path: Path, often: str) -> None:
    found = positions(tmp_path, f"{HEAD}M98 P1000 {often}\nM30\nO1000\n{SUB}%\n")
    assert np.allclose(found[2:, 0], [10, 20, 30])


@pytest.mark.parametrize(
    ("often", "says"),
    [("L#9", "found #9, which the file does not set"), ("L[#25/2]", "L\\[#25/2\\] of 1.5"),
     ("L[0-#25]", "of -3, expected a whole number of times")],
)  # fmt: skip
def test_a_count_that_is_none_is_refused(tmp_path: Path, often: str, says: str) -> None:
    with pytest.raises(InputError, match=f"line 7: .*{says}"):
        program(tmp_path, f"{HEAD}M98 P1000 {often}\nM30\nO1000\n{SUB}%\n")


@pytest.mark.parametrize("label", ["N5", "N0005 (HOLE)", "N5 M8"])
def test_a_block_behind_the_end_is_a_sub_program(tmp_path: Path, label: str) -> None:
    read = program(tmp_path, f"{HEAD}M97 P5 L#25\nG0 Z5.\nM30\n{label}\n{SUB}%\n")
    found = 1e3 * read.operation().path.position
    assert np.allclose(found[2:], [[10, 0, 0], [20, 0, 0], [30, 0, 0], [30, 0, 5]])
    assert "left out" not in " ".join(map(str, read.of_kind("assumed")))


def test_a_block_before_the_end_is_carried_out_in_its_place_too(tmp_path: Path) -> None:
    found = positions(tmp_path, f"{HEAD}M97 P7\nG1 Y9.\nGOTO 9\nN7 G91 G1 X10.\nG90\nM99\nN9 M30\n")
    assert np.allclose(found[2:], [[10, 0, 0], [10, 9, 0]])


def test_sub_programs_call_their_own_blocks(tmp_path: Path) -> None:
    sub = "O1000\nM97 P5 L2\nM99\nN5 G91 G1 X10.\nG90\nM99\n"
    found = positions(tmp_path, f"{HEAD}M98 P1000\nG1 Y1.\nM30\n{sub}%\n")
    assert np.allclose(found[2:], [[10, 0, 0], [20, 0, 0], [20, 1, 0]])


def test_a_block_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 7: M97 calls a sub-program that is not in the file"):
        program(tmp_path, f"{HEAD}M97 P6\nM30\nN5\n{SUB}%\n")
