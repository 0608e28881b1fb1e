"""G-code: loops and conditions on variables that the file sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

HEAD = "G21 G90\n#1=0 #2=3\nG0 X0 Y0 Z9\nG1 Z0 F60\n"


def reached(tmp_path: Path, body: str) -> list[float]:
    """X of the cuts behind the head [mm]."""
    places = program(tmp_path, f"{HEAD}{body}\nM30\n").operation().path.position
    return [round(1e3 * float(x), 6) for x in places[2:, 0]]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("WHILE [#1 LT #2] DO1\n#1=#1+1\nG1 X#1\nEND1\nX9", [1, 2, 3, 9]),
        ("WHILE [#1 GT #2] DO1\nG1 X8\nEND1\nX9", [9]),
        (
            "WHILE [#1 LT 2] DO1\n#3=0\nWHILE [#3 NE 2] DO2\nG1 X[#1*10+#3]\n#3=#3+1\nEND2\n"
            "#1=#1+1\nEND1",
            [0, 1, 10, 11],
        ),
        ("N5 #1=#1+1\nG1 X#1\nIF [#1 LE 2] GOTO 5\nX9", [1, 2, 3, 9]),
        ("N5 #1=#1+1\nX#1\nIF [#1 EQ 1] GOTO 5\nGOTO 6\nX8\nN06 X9\nN6 X7", [1, 2, 9, 7]),
        ("IF [#1 EQ 0 XOR #2 EQ 3] GOTO 9\nX5\nN9 X6", [5, 6]),
        ("GOTO 20\nG1 X8\nN0020 X9", [9]),
        ("IF [#2 EQ 3] THEN #1=7\nIF [#2 NE 3] THEN #1=8\nX#1", [7]),
        ("IF [[#1 EQ 0] AND [#2 GE 4]] GOTO 9\nX5\nN9 X6", [5, 6]),
        ("IF [#1 EQ 1 OR #2 EQ 3] GOTO 9\nX5\nN9 X6", [6]),
        ("o10 while [#1 lt 3]\n#1=[#1+1]\nX#1\no10 endwhile", [1, 2, 3]),
        ("o10 do\n#1=[#1+1]\nX#1\no10 while [#1 lt 2]\nX9", [1, 2, 9]),
        (
            "o10 do\n#1=[#1+1]\nX#1\no10 while [#1 lt 2]\no10 while [#1 lt 4]\n#1=[#1+1]\n"
            "X#1\no10 endwhile\nX9",
            [1, 2, 3, 4, 9],
        ),
        ("o10 repeat [#2]\nG91 X1\no10 endrepeat\nG90 X9", [1, 2, 3, 9]),
        ("o10 repeat [0]\nX8\no10 endrepeat\nX9", [9]),
        ("o10 if [#1 gt 0]\nX1\no10 elseif [#2 eq 3]\nX2\no10 else\nX3\no10 endif\nX9", [2, 9]),
        ("o10 if [#1 eq 0]\nX1\no10 elseif [#2 eq 3]\nX2\no10 else\nX3\no10 endif\nX9", [1, 9]),
        ("o10 if [#1 gt 0]\nX1\no10 else\nX3\no10 endif\nX9", [3, 9]),
        (
            "o10 while [1]\n#1=[#1+1]\no11 if [#1 eq 2]\no10 continue\no11 endif\n"
            "o12 if [#1 gt 3]\no10 break\no12 endif\nX#1\no10 endwhile\nX9",
            [1, 3, 9],
        ),
    ],
)
def test_lines_in_the_order_of_the_control(
    tmp_path: Path, body: str, expected: list[float]
) -> None:
    assert reached(tmp_path, body) == expected


def test_a_loop_in_a_sub_program_with_arguments(tmp_path: Path) -> None:
    text = (
        "o50 sub\no51 repeat [#2]\nG91 G1 X#1 F60\no51 endrepeat\nG90\no50 endsub\n"
        "G21 G90\nG0 X0 Y0 Z9\no50 call [2] [2]\no50 call [5] [1]\nM2\n"
    )
    x = 1e3 * program(tmp_path, text).operation().path.position[:, 0]
    assert np.allclose(x, [0, 2, 4, 9])


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("IF [#500 EQ 0] GOTO 9\nN9 X5", "line 5: found #500, which the file does not set"),
        ("GOTO 77", "GOTO 77, and no block N77 is in the program"),
        ("WHILE [#1 GT 9] DO1\nX5", "the loop 1 has no other end"),
        ("o10 endwhile", "o10 ENDWHILE without WHILE"),
        ("o10 repeat [1.5]\no10 endrepeat", "repeat .1.5., expected a whole number"),
        ("IF [#1 EQ 0] WOBBLE", "of jumps and loops IF"),
    ],
)
def test_what_cannot_be_steered_is_refused_with_its_line(
    tmp_path: Path, body: str, says: str
) -> None:
    with pytest.raises(InputError, match=says):
        reached(tmp_path, body)
    # who only looks at the file sees the rest
    (tmp_path / "part.nc").write_text(f"{HEAD}{body}\nG1 X3\nM30\n")
    assert read_program(tmp_path / "part.nc", strict=False).operations


def test_a_loop_without_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irb2400_ctrl.planners.toolpath.readers.gcode.flow.MOST_LINES", 50)
    # lines of a long file are none that are carried out again
    assert len(reached(tmp_path, "X1\n" * 60)) == 60
    with pytest.raises(InputError, match="expected loops and jumps that end"):
        reached(tmp_path, "N5 X1\nGOTO 5")


def test_a_jump_stays_in_its_program(tmp_path: Path) -> None:
    body = "N5 #1=#1+1\nX#1\nIF [#1 LT 3] GOTO 5\nM30\nO2\nN5 X99\nN6 X98"
    assert reached(tmp_path, body) == [1, 2, 3]
    with pytest.raises(InputError, match="GOTO 6, and no block N6 is in the program"):
        reached(tmp_path, body.replace("GOTO 5", "GOTO 6"))


def test_loops_behind_the_end_are_not_carried_out(tmp_path: Path) -> None:
    text = f"{HEAD}X5\nM30\nN5 X1\nGOTO 5\n"
    assert np.allclose(1e3 * program(tmp_path, text).operation().path.position[-1], [5, 0, 0])


@pytest.mark.parametrize(
    "loop",
    [
        "o1 while [#1 LT 5]\n#1=[#1+#500]\nG1 X[#1] F100\no1 endwhile\n",
        "WHILE [#1 LT 5] DO1\n#1=#1+#500\nG1 X#1 F100\nEND1\n",
        "N10\n#1=#1+#500\nG1 X#1 F100\nIF [#1 LT 5] GOTO 10\n",
    ],
)
def test_a_loop_whose_count_is_not_known_names_what_is_missing(tmp_path: Path, loop: str) -> None:
    """And not that it has no end, after as many lines as are carried out at most."""
    with pytest.raises(InputError, match="found #500, which the file does not set"):
        program(tmp_path, f"G21 G90\nG0 X0. Y0. Z5.\n#1=0\n{loop}M30\n")


@pytest.mark.parametrize(
    ("order", "says"),
    [
        ("#3000=1(TOOL TOO LONG)", "#3000= stops the program with an alarm"),
        ("IF [#1 EQ 0] THEN #3000=1", "#3000= stops the program with an alarm"),
        ("#3006=1(TURN THE PART)", "#3006= waits for the operator .*; write M0"),
        ("#3007=1", "#3007= mirrors"),
        ("#5221=#5221+100.", "#5221"),
        ("#5221=100.", "#5221= moves a zero of the control"),
        ("#7001=100.", "#7001= moves a zero of the control"),
    ],
)
def test_variables_by_which_the_control_acts(tmp_path: Path, order: str, says: str) -> None:
    head = "G21 G90\nG0 X0. Y0. Z5.\n#1=0\n"
    with pytest.raises(InputError, match=f"line 4: .*{says}"):
        program(tmp_path, f"{head}{order}\nG1 X5. F100\nM30\n")


def test_such_variables_that_are_not_reached_or_are_free(tmp_path: Path) -> None:
    head = "G21 G90\nG0 X0. Y0. Z5.\n#1=0\n"
    for order in ("IF [#1 EQ 1] THEN #3000=1", "#3003=1", "#500=1", "#13001=5."):
        assert len(program(tmp_path, f"{head}{order}\nG1 X5. F100\nM30\n").operations) == 1
    linuxcnc = f"{head}o1 if [#1 EQ 0]\n#3000=4\no1 endif\nG1 X#3000 F100\nM2\n"
    assert np.isclose(program(tmp_path, linuxcnc).operation().path.position[-1, 0], 0.004)
