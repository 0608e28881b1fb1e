"""Codes of G-code that hold for their block alone, and what they leave as it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError

HEAD = "G21 G90\nG0 X0 Y0 Z2\nG1 Z-1 F600\n"


@pytest.mark.parametrize("code", ["G28", "G30"])
def test_the_motion_goes_on_behind_a_place_of_the_machine(tmp_path: Path, code: str) -> None:
    found = program(tmp_path, f"{HEAD}{code} Z30\nX0 Y0 Z2\nZ-1\nX60\nM30\n")
    first, second = found.operations
    # up to the place on the way rapidly, and then cuts as before
    assert list(first.rapid) == [True, False, True]
    assert np.allclose(1e3 * second.path.position, [[0, 0, 2], [0, 0, -1], [60, 0, -1]])
    assert not second.rapid[1:].any()
    assert np.allclose(second.path.feed[1:], 10e-3)


def test_a_rotation_on_top_of_one_in_g91_is_refused(tmp_path: Path) -> None:
    again = "G91 G68 X0 Y0 R90\nG90\nG0 X5 Y0\n"
    with pytest.raises(InputError, match=r"line 7: G68 R90 in G91 .* expected G90, or G69"):
        program(tmp_path, f"{HEAD}{2 * again}M30\n")
    # the first one, one behind G69, and one in G90 are to R on all controls
    found = program(tmp_path, f"{HEAD}{again}G69\n{again}G68 X0 Y0 R180\nX5 Y0\nM30\n")
    places = 1e3 * found.operation().path.position
    assert np.allclose(places[-3:], [[0, 5, -1], [0, 5, -1], [-5, 0, -1]])
