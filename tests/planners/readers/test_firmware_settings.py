"""G-code of printers' firmwares: numbers behind an M function are its settings, not places."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError

HEAD = "G21 G90\nM3 S1000\nG0 X0. Y0. Z5.\nG1 Z0. F100\n"


@pytest.mark.parametrize("block", [
    "M201 X500 Y500 Z100", "N7 M203 X300 Y300 Z40", "M205 X8.00 Y8.00 E5.00", "M92 X80 Z400 E93",
    "M851 Z-1.2", "M106 S255", "M104 S200", "M204 P500 T500", "M207 S3 F2700", "M84 S0", "M220 S50",
])  # fmt: skip
def test_a_setting_is_no_place_speed_tool_or_feed(tmp_path: Path, block: str) -> None:
    read = program(tmp_path, f"{HEAD}{block}\nX20.\nM30\n")
    operation = read.operation()
    assert np.allclose(1e3 * operation.path.position, [[0, 0, 5], [0, 0, 0], [20, 0, 0]])
    assert operation.path.feed[-1] == pytest.approx(0.1 / 60)
    assert operation.spindle.rpm == pytest.approx(1000)
    assert "not carried out" in " ".join(map(str, read.of_kind("assumed")))


def test_a_place_behind_another_function_is_asked_about(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 5: found M206 X5 Y5: .*a setting of M206"):
        program(tmp_path, f"{HEAD}M206 X5 Y5\nM30\n")


@pytest.mark.parametrize(
    "block", ["M8 X20.", "G1 X20. M201", "X20. M201", "M41 X20.", "M201 M8 X20."]
)
def test_a_place_beside_a_function_of_a_machine_tool_is_gone_to(tmp_path: Path, block: str) -> None:
    found = program(tmp_path, f"{HEAD}{block}\nM30\n").operation().path.position
    assert np.allclose(1e3 * found[-1], [20, 0, 0])
