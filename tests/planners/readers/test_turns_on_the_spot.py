"""Cuts in which the tip stands and the tool turns, under tool centre control."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90\nG43.4 H1\nG0 X0 Y0 Z20 A0\n"
SAID = "a cut that turns the tool on the spot: F"


@pytest.mark.parametrize("block", ["G1 A30 F2", "G1 X0.001 A30 F2"])
def test_a_turn_on_the_spot_in_inverse_time_is_refused(tmp_path: Path, block: str) -> None:
    text = f"{HEAD}G93 G1 Z0 F10\n{block}\nG1 X20 F10\nM30\n"
    with pytest.raises(InputError, match=r"line 5: .*inverse time .*on the spot.* expected G94"):
        program(tmp_path, text, "C,A")


@pytest.mark.parametrize("block", ["G1 X9 A30 F2", "G1 X0.05 A0.1 F2", "G1 Z0 F2", "G0 A30"])
def test_a_turn_on_the_way_has_its_time(tmp_path: Path, block: str) -> None:
    found = program(tmp_path, f"{HEAD}G93 G1 Z0 F10\n{block}\nG1 X20 F10\nM30\n", "C,A")
    assert SAID not in str(found.of_kind("assumed"))


def test_a_turn_on_the_spot_at_a_feed_is_said(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G1 Z0 F600\nG1 A30\nG1 X20\nM30\n", "C,A")
    assert [note.line for note in found.of_kind("assumed") if SAID in note.text] == [5]
    path = found.operation().path
    assert path.axis is not None
    assert np.allclose(path.axis[-1], [0, -0.5, 0.75**0.5])


def test_the_first_point_turns_nothing(tmp_path: Path) -> None:
    text = "UNITS/MM\nMULTAX\nFEDRAT/2,INVERS\nGOTO/0,0,0,0,0.6,0.8\nGOTO/9,0,0,0,0.6,0.8\n{}"
    file = tmp_path / "part.apt"
    file.write_text(text.format(""))
    assert len(read_program(file).operation().path) == 2
    file.write_text(text.format("GOTO/9,0,0,0,0,1\n"))
    with pytest.raises(InputError, match=r"line 6: .*INVERS"):
        read_program(file)
