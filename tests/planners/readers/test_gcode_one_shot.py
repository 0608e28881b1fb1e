"""Codes of G-code that hold for their block alone, and what they leave as it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

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
