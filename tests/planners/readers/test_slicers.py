"""G-code of slicers for 3D printers: the path at its feeds, without plastic."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram

CURA = """;FLAVOR:Marlin
;LAYER_COUNT:2
M140 S60
M82 ;absolute extrusion mode
G92 E0
G28 W ; home
G29
G1 Z2.0 F3000
G1 X5 Y20 Z0.3 F5000.0
G1 X5 Y80 Z0.3 F1500.0 E15 ; prime
G92 E0
G1 F2700 E-5
;LAYER:0
M106 S85
G0 F6000 X100 Y100 Z0.2
G1 F1200 X120 Y100 E0.66
G2 X140 Y100 I10 J0 E.9
M117 Layer 1 of 2
G91
G1 E-2 Z0.2 F2400
G90
M84 X Y E
M104 S0
"""


def assumed(read: CamProgram) -> str:
    return " ".join(map(str, read.of_kind("assumed")))


def test_the_path_is_that_of_the_nozzle(tmp_path: Path) -> None:
    read = program(tmp_path, CURA)
    path = read.operation().path
    points = 1e3 * path.position
    ends = [[5, 20, 0.3], [5, 80, 0.3], [100, 100, 0.2], [120, 100, 0.2]]
    assert np.allclose(points[:4], ends)
    assert np.allclose(points[-2:], [[140, 100, 0.2], [140, 100, 0.4]])
    assert np.allclose(path.feed[[1, 3, -1]] * 6e4, [1500, 1200, 2400])
    assert np.allclose(np.hypot(points[3:-1, 0] - 130, points[3:-1, 1] - 100), 10)
    assert "line 1: the file of a slicer" in assumed(read)
    assert read.operation().tool.number is None


@pytest.mark.parametrize("head", ["M83", "M109 S200", "G92 E0.0", "N3 M104 S200*71"])
@pytest.mark.parametrize("idle", [
    "G10", "G11", "G1 E.8 F2100", "M1002 gcode_claim_action : 2", "SET_VELOCITY_LIMIT ACCEL=5000",
    "EXCLUDE_OBJECT_DEFINE NAME=a POLYGON=[[90,90],[110,90]]", "N9 G92 E0*67",
])  # fmt: skip
def test_what_only_a_printer_does_moves_nothing(tmp_path: Path, head: str, idle: str) -> None:
    text = f"{head}\nG21\nG1 Z.2 F9000\nG1 X1 Y1\n{idle}\nG1 X20 E.6 F1200\n"
    found = program(tmp_path, text).operation().path
    assert np.allclose(1e3 * found.position, [[1, 1, 0.2], [20, 1, 0.2]])


@pytest.mark.parametrize("line", ["G1 X5 E3 F60", "M82\nG1 X5 F60\nM67 E0 Q5"])
def test_e_of_other_files_is_refused(tmp_path: Path, line: str) -> None:
    with pytest.raises(InputError, match="found the word E"):
        program(tmp_path, f"G21\nG0 X0 Y0 Z5\n{line}\n")


def test_a_macro_of_the_firmware_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 2: found 'START_PRINT BED=60'"):
        program(tmp_path, "M83\nSTART_PRINT BED=60\nG1 X1 Y1 Z1 F600\nG1 X9 E1\n")
