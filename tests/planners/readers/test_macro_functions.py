"""Functions of variables in G-code that controls calculate in different ways."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90\nG0 X0 Y0 Z0\nF600\n"
TURNED = r"an angle of ATAN or ASIN below zero, -{} or {} deg \(Fanuc\)"


@pytest.mark.parametrize(
    ("blocks", "says"),
    [
        ("#1=1.2345\nG1 X[ROUND[#1]]", "ROUND of 1.2345 in a word is rounded to the smallest step"),
        ("#1=0.7\nG1 X[5+ROUND[#1*2]]", "ROUND of 1.4 in a word"),
        ("#1=ATAN[-1]/[1]\nG1 X[#1*2]", TURNED.format(45, 315)),
        ("#1=ATAN[-1]/[-1]\nG1 X#1", TURNED.format(135, 225)),
        ("#1=ATAN[-1,1]\n#2=90+#1\n#3=#2-80\n#4=ABS[#3]", TURNED.format(35, 325)),
        ("#1=ATAN[-1]/[1]\nIF [#1 LT 0] GOTO 9", TURNED.format(45, 315)),
        ("#1=ASIN[-0.5]\nG1 X[#1/3]", TURNED.format(30, 330)),
        ("#1=ATAN[-1]/[1]\nG68 X0 Y0 R#1", TURNED.format(45, 315)),
    ],
)
def test_what_controls_calculate_otherwise_is_refused(
    tmp_path: Path, blocks: str, says: str
) -> None:
    with pytest.raises(InputError, match=rf"line \d: {says}.* different ways"):
        program(tmp_path, f"{HEAD}{blocks}\nG1 X3\nM30\n")


@pytest.mark.parametrize(
    ("blocks", "place"),
    [
        ("#1=ROUND[1.6]\nG1 X#1", (2, 0)),
        ("#1=4\nG1 X[ROUND[#1]]", (4, 0)),
        ("#1=ATAN[-1]/[1]\nG1 X[10*COS[#1]] Y[10*SIN[#1-90]]", (50**0.5, -(50**0.5))),
        ("#1=ATAN[3]/[-4]\nG1 X[#1*0+SIN[-#1]]", (-0.6, 0)),
        ("#1=ASIN[0.5]\nG1 X#1", (30, 0)),
        ("G1 X[10*TAN[ASIN[-0.6]]]", (-7.5, 0)),
    ],
)
def test_what_all_calculate_alike_is_read(
    tmp_path: Path, blocks: str, place: tuple[float, float]
) -> None:
    found = program(tmp_path, f"{HEAD}{blocks}\nM30\n").operation().path.position[-1]
    assert np.allclose(1e3 * found[:2], place)


def test_an_angle_of_a_rotary_axis_is_the_same_a_turn_on(tmp_path: Path) -> None:
    found = program(tmp_path, f"{HEAD}G43.4 H1\n#1=ATAN[-1]/[1]\nG1 X9 A#1\nM30\n", "C,A")
    axis = found.operation().path.axis
    assert axis is not None
    assert np.allclose(axis[-1], [0, 0.5**0.5, 0.5**0.5])


def test_siemens_calculates_in_one_way(tmp_path: Path) -> None:
    file = tmp_path / "part.mpf"
    file.write_text("G710 G90\nG0 X0 Y0 Z0\nR1=ATAN2(-1,1)\nG1 X=R1 Y=ROUND(R1/2) Z=ASIN(-0.5)\n")
    found = read_program(file).operation().path.position[-1]
    assert np.allclose(1e3 * found, [-45, -23, -30])
