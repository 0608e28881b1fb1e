"""G-code with sub-programs, variables, swivelled planes, and lengths without a point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program

Array = npt.NDArray[np.float64]
HEAD = "G21 G90 G54 G0 X0. Y0. Z30.\nG1 Z1. F60.\n"


def places(tmp_path: Path, text: str) -> Array:
    """[mm]"""
    return np.asarray(1e3 * program(tmp_path, text).operation().path.position)


STEPS = "G91 X10.\nY5.\nG90\n"


@pytest.mark.parametrize(
    "text",
    [
        f"%\nO0001\n{HEAD}M98 P1000 L2\nM30\nO1000 (steps)\n{STEPS}M99\n%\n",
        f"%\nO1\n{HEAD}N7 M98 P21000\nM30\nO1000\n{STEPS}M99\n",
        f"%\nO1\n{HEAD}M98 P1000\nM98 P2000\nM30\nO2000\nM98 P1000\nM99\nO1000\n{STEPS}M99\n",
        f"o100 sub\n{STEPS}o100 endsub\n{HEAD}o100 call\no100 call\nM2\n",
        f"%_N_PART_MPF\n{HEAD}STEPS P2\nM30\n%_N_STEPS_SPF\n{STEPS}M17\n",
        f'{HEAD}CALL "STEPS"\nN9 STEPS\nM30\n%_N_STEPS_SPF\n{STEPS}RET\n',
        f"{HEAD}L100 P2\nM30\n%_N_L100_SPF\n{STEPS}RET\n",
    ],
)
def test_sub_programs_are_carried_out_where_they_are_called(tmp_path: Path, text: str) -> None:
    expected = [[0, 0, 30], [0, 0, 1], [10, 0, 1], [10, 5, 1], [20, 5, 1], [20, 10, 1]]
    assert np.allclose(places(tmp_path, text), expected)


def test_a_program_of_linuxcnc_has_variables_of_its_own(tmp_path: Path) -> None:
    """As its interpreter: the arguments are worked out before the call, #1 to #30 and #<names>
    come back after it, #31 and above and #<_names> are shared."""
    inner = "o100 sub\n#1=[#1+1]\n#<_all>=[#<_all>+1]\nX#1 Y#2\no100 endsub\n"
    outer = "o200 sub\n#<deep>=7\no100 call [#2] [#1+[2*[3]]]\nX#1 Y#2 Z-#<deep>\no200 endsub\n"
    call = "#1=50\n#<deep>=3\n#<_all>=20\no200 call [5] [SQRT[16]]\nX#1 Y#<deep> Z-#<_all>\n"
    ends = [[5, 11, 1], [5, 4, -7], [50, 3, -21]]
    found = places(tmp_path, f"{inner}{outer}{HEAD}{call}M2\n")
    assert np.allclose(found[2:], ends)
    # what no argument states is zero, not the caller's
    found = places(tmp_path, f"{inner}{HEAD}#2=8\n#<_all>=1\no100 call [4]\nM2\n")
    assert np.allclose(found[-1], [5, 0, 1])
    # Fanuc's M98 shares all of them
    shared = f"%\nO1\n{HEAD}#1=5\nM98 P10\nX#1\nM30\nO10\n#1=6\nM99\n"
    assert np.allclose(places(tmp_path, shared)[-1], [6, 0, 1])


def test_arguments_of_a_call_are_expressions(tmp_path: Path) -> None:
    sub = "o100 sub\nX#1\no100 endsub\n"
    with pytest.raises(InputError, match=r"line 6: found '5' in an expression"):
        program(tmp_path, f"{sub}{HEAD}o100 call 5\nM2\n")
    with pytest.raises(InputError, match=r"line 6: found #77, which the file does not set"):
        program(tmp_path, f"{sub}{HEAD}o100 call [#77]\nM2\n")


def test_programs_of_which_none_begins_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="each of its programs is called by one of them"):
        program(tmp_path, f"o100 sub\n{HEAD}o100 call\no100 endsub\n")


def test_what_a_sub_program_lacks_is_refused_with_its_line(tmp_path: Path) -> None:
    sub = f"%\nO1\n{HEAD}M98 P1000\nM30\nO1000\nX9.\n"
    with pytest.raises(InputError, match=r"line 9: found 'GOTO P30'.*of jumps and loops IF"):
        program(tmp_path, f"{sub}M99 P30\n")
    with pytest.raises(InputError, match=r"line 8: found #500"):
        program(tmp_path, sub.replace("X9.", "X#500"))
    with pytest.raises(InputError, match=r"more than 10 deep"):
        program(tmp_path, f"{sub}M98 P1000\nM99\n")
    with pytest.raises(InputError, match=r"line 5: M98 calls a sub-program that is not in"):
        program(tmp_path, sub.replace("P1000", "P1001"))
    read = program(tmp_path, f"{sub}M99\nO3000\nX77.\nM99\n")
    assert "program 3000 is called by no other" in " ".join(map(str, read.of_kind("assumed")))


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("#100=10.\nG1 X#100 Y-#100", (10, -10, 1)),
        ("#1=3. \n#2=[#1+2.]*2\n#1=[#2-1.]\nG1 X[#1] Y-[#2/4.]", (9, -2.5, 1)),
        ("#3=2\n#4=#3\n#2=7.\nG1 X#[#3]", (7, 0, 1)),
        ("G1 X[10*SIN[30]+2**3] Y[ATAN[1]/[1]] Z[-SQRT[16.]]", (13, 45, -4)),
        ("#<len>=4.5\n#1=ROUND[#<len>]\nG1 X[ROUND[#1]] Y[-FIX[4.7]] Z[FUP[1.2]]", (5, -4, 2)),
        ("R1=5 R2=R1*(2+1)\nG1 X=R1+R2 Y=-R2/2 Z=(R1-1)*2", (20, -7.5, 8)),
        ("R10=90\nG1 X=10*COS(R10/2)*SIN(45) Y=SQRT(POT(3)+16)", (5, 5, 1)),
        ("R3=7\nG1 X=R3", (7, 0, 1)),
        ("r3=30\ng1 x=sin(r3)*2", (1, 0, 1)),
        ("#5=17\nG1 X[#5 MOD 5]", (2, 0, 1)),
        # an R word of an arc is none of a variable
        ("#1=10.\nG2 X#1 Y0 R5.", (10, 0, 1)),
    ],
)
def test_variables_that_the_file_sets_are_numbers(
    tmp_path: Path, text: str, place: tuple[float, float, float]
) -> None:
    assert np.allclose(places(tmp_path, f"{HEAD}{text}\nM30\n")[-1], place, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("WHILE [#1 LT 5] DO1", "the loop 1 has no other end"),
        ("IF [#1 EQ 5] GOTO 20", "found #1, which the file does not set"),
        ("IF [#1 EQ 5] THEN #2=3", "found #1, which the file does not set"),
        ("N5 IF R1>5 GOTOF ENDE", "jumps and loops"),
        ("#1=[5/0]", "a division by zero"),
        ("#1=SQRT[-1]", "SQRT of -1"),
        ("#1=[2", "in an expression"),
        ("#1=BIN[3]", "the function BIN, which is not read"),
        ("#1=[0-8]**0.5", "no finite value"),
        ("#1=0**[0-1]", "no finite value"),
        ("#1=[0-7] MOD 4", "MOD of a negative number, which controls calculate"),
        ("#1=FIX[-2.5]", "FIX of a negative number, which controls calculate"),
        ("#1=FUP[-2.5]", "FUP of a negative number"),
        ("#1=[6 AND 3]", "AND of numbers"),
        ("IF [1 EQ 1 OR 1 EQ 2 AND 1 EQ 2] GOTO 5", "AND of numbers, or beside OR"),
        ("#1=5 #2=#1", "#1 is set and used in one block"),
        ("#1=5 X#1", "#1 is set and used in one block"),
        ("#<len>=5 X#<len>", "#<LEN> is set and used in one block"),
        ("#1=#0", "found #0, which the file does not set"),
        ("#1=" + "[" * 60 + "1" + "]" * 60, "brackets more than 50 deep"),
    ],
)
def test_what_is_no_number_is_refused(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(InputError, match=r"part\.nc, line 3: ") as caught:
        program(tmp_path, f"{HEAD}{text}\nG1 X5.\nM30\n")
    assert says in str(caught.value)


def test_a_swivelled_plane_turns_its_axes_one_after_another(tmp_path: Path) -> None:
    text = (
        "G710 G90 G54\nG0 X0 Y0 Z50\n"
        'CYCLE800(1,"TABLE",200000,57,10,0,0,90,0,90,0,0,5,-1,100,1)\n'
        "G0 X0 Y0 Z20\nG1 Z1 F=600\nCYCLE800()\nG0 X0 Y0 Z60\nG1 Z50\nM30\n"
    )
    found = program(tmp_path, text).operations[0]
    # z of the plane is -y of the part; 5 along it from X0, then 20
    plane = found.path.position[np.isclose(found.path.position[:, 0], 0.01)]
    assert np.allclose(1e3 * plane, [[10, -25, 0], [10, -6, 0]])
    assert np.allclose(1e3 * found.path.position[-1], [0, 0, 50])
    order = text.replace(",57,10,0,0,90,0,90,", ",27,10,0,0,90,90,0,")
    # about z first, then about the y that this has turned to -x: z of the plane is along y
    turned = program(tmp_path, order).operations[0].path.position
    assert np.allclose(1e3 * turned[np.isclose(turned[:, 0], 0.01)], [[10, 25, 0], [10, 6, 0]])
    assert "CYCLE800 turns table or head" in " ".join(map(str, program(tmp_path, text).notes))


def test_cycles_say_what_is_not_carried_out(tmp_path: Path) -> None:
    head = "G710 G90 G54\nS900 M3\nG0 X0 Y0 Z9\n"
    read = program(tmp_path, f"{head}CYCLE86(5,0,2,-9,,0,3,1,0,1,0)\nM30\n")
    assert "the spindle is not stopped" in " ".join(map(str, read.of_kind("assumed")))


AT = "G21 G90\nG0 X0. Y0. Z9.\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("G21 G90 G0 X0 Y0 Z9\nG1 X100 F60\nM30\n", "lengths have no decimal point"),
        ("G21 G90 G0 X0. Y0. Z9.\nG1 X100 F60\nM30\n", "1 of 4 lengths have no decimal point"),
        (f"{AT}G81 X1. Y1. Z-5. R2. F60 K1\nX2. K2\nG80\nM30\n", None),
        (f"{AT}G84 X1. Y1. Z-5. R2. F60 J2\nG80\nM30\n", None),
        (f"{AT}G81 X1. Y1. Z-5. R2 F60 K1\nG80\nM30\n", "1 of 7 lengths have no"),
        (f"{AT}G81 X1. Y1. Z-5. R2. F60\nG2 X1. Y5. I0 J2\nM30\n", "1 of 10 lengths have"),
        (f"O1\n{AT}M98 P2 K2\nM30\nO2\nG91 G1 X5. F60\nG90\nM99\n", None),
        ("G21 G90 G0 X0 Y0 Z9.\nG1 X100. F60 (X5 X6)\nM30\n", None),
        ("G21 G90 G0 X0 Y0 Z9\nG1 X100 F=60\nM30\n", None),
    ],
)
def test_lengths_without_a_point_are_noted(tmp_path: Path, text: str, says: str | None) -> None:
    notes = " ".join(map(str, program(tmp_path, text).of_kind("assumed")))
    assert ("decimal point" in notes) == (says is not None)
    assert says is None or says in notes


def test_names_that_a_siemens_program_defines(tmp_path: Path) -> None:
    head = "DEF REAL _X_HOME, _Y_HOME, _FAST=1200\nDEF STRING[32] _TEXT\nG710 G90\n"
    text = (
        f"{head}N5 _X_HOME=5 _Y_HOME=-10\nG0 X0 Y0 Z30\nG1 Z1 F=_FAST/20\n"
        "X=50-_Y_HOME Y2\nX=_X_HOME*(2+1) Y=-_Y_HOME\nSUPA G0 Z=_FAST D0\nM30\n"
    )
    operation = program(tmp_path, text).operation()
    ends = [[0, 0, 30], [0, 0, 1], [60, 2, 1], [15, 10, 1]]
    assert np.allclose(1e3 * operation.path.position, ends)
    assert np.allclose(1e3 * operation.path.feed[1:], 1)
    with pytest.raises(InputError, match=r"line 5: found _X_HOME, which the file does not set"):
        program(tmp_path, f"{head}G0 X0 Y0 Z30\nG1 X=_X_HOME F60\n")
    with pytest.raises(InputError, match="line 5: found 'X=_OTHER"):
        program(tmp_path, f"{head}G0 X0 Y0 Z30\nG1 X=_OTHER F60\n")


@pytest.mark.parametrize("block", [":30 T1 M6", ":0030 T1 M6", " :30T1M6", "/:30 T1 M6"])
def test_a_main_block_is_a_line_like_others(tmp_path: Path, block: str) -> None:
    """Posts of NX write it at each change of tool."""
    text = f"%\n:1001\nN10 G21 G90\n{block}\nN40 G0 X0 Y0 Z5\n:50 G1 Z-1 F100\nM2\n"
    operation = program(tmp_path, text).operation()
    assert operation.tool.number == 1
    assert np.allclose(1e3 * operation.path.position, [[0, 0, 5], [0, 0, -1]])


def test_a_second_program_behind_the_end_is_said(tmp_path: Path) -> None:
    first = f"%\nO1\n{HEAD}X9.\nM30\n"
    read = program(tmp_path, f"{first}O2\nT2 M6\nG0 X5.\nG1 Y7.\nM30\n%\n")
    assert np.allclose(1e3 * read.operation().path.position[-1], [9, 0, 1])
    said = " ".join(map(str, read.of_kind("assumed")))
    assert "line 8: the program has ended: 2 blocks with places behind it" in said
    silent = program(tmp_path, f"{first}%\n(made by a CAM system)\n").of_kind("assumed")
    assert "has ended" not in " ".join(map(str, silent))


def test_what_stands_behind_the_closing_mark_is_left_out_and_said(tmp_path: Path) -> None:
    """A control reads no further than the second %; it was carried out without a word."""
    body = f"%\nO1\n%\n{HEAD}X9.\n"
    read = program(tmp_path, f"{body}%\nG1 X99. F100.\nO3 (old)\nG1 Y7.\nQUATSCH\n%\n")
    assert np.allclose(1e3 * read.operation().path.position[-1], [9, 0, 1])
    said = " ".join(map(str, read.of_kind("assumed")))
    assert "the program has ended: 2 blocks with places behind it" in said
    silent = program(tmp_path, f"{body}% (end)\n(made by a CAM system)\n").of_kind("assumed")
    assert "has ended" not in " ".join(map(str, silent))


@pytest.mark.parametrize("back", ["M99\n%\n", "%\n"])
def test_a_sub_program_behind_the_closing_mark_is_found(tmp_path: Path, back: str) -> None:
    main = f"%\nO1\n{HEAD}M98 P2\nX9.\n%\n"
    read = program(tmp_path, f"{main}O2\nG1 X5. Y7. F100.\n{back}")
    assert np.allclose(1e3 * read.operation().path.position[-2:], [[5, 7, 1], [9, 7, 1]])
    assert "has ended" not in " ".join(map(str, read.of_kind("assumed")))


def test_a_place_stated_again_between_stop_and_spindle_is_no_operation(tmp_path: Path) -> None:
    cut = "G1 Z5. F600\nX{}.\nG0 Z20.\nM5\nM1\n"
    again = "G0 X10. Y0.\nG4 P2.\nS1200 M3\n"
    text = f"G21 G90\nT1 M6\nS1000 M3\nG0 X0. Y0. Z20.\n{cut.format(10)}{again}{cut.format(0)}M30\n"
    first, second = program(tmp_path, text).operations
    assert [len(first.path), len(second.path)] == [4, 4]
    assert second.spindle.rpm == pytest.approx(1200)
    assert ("dwell", -1) in [(e.kind, e.point) for e in second.events]


def test_a_length_of_the_tool_from_the_table_of_the_control(tmp_path: Path) -> None:
    # the change of tool that FreeCAD writes for Fanuc
    text = (
        "G17 G21 G90\nM05\nG28 G91 Z0\nM6 T1\nG91 G0 G43 G54 Z-[#[2000+#4120]] H#4120\nG90\n"
        "M3 S1000\nG0 Z15.0\nG0 X1.0 Y2.0\nG1 X1.0 Y2.0 Z-1.0 F100.0\nG1 X30.0\nM30\n"
    )
    file = tmp_path / "part.nc"
    file.write_text(text)
    found = read_program(file)
    points = 1e3 * found.operation().path.position
    assert np.allclose(points, [(1, 2, 15), (1, 2, -1), (30, 2, -1)])
    assert found.operation().tool.number == 1
    assert "G53: places of the machine tool" in str(found.of_kind("assumed")[0])


def test_the_unit_of_lengths_from_a_comment(tmp_path: Path) -> None:
    # a control without G20 and G21, as FreeCAD writes for UC-CNC
    text = "%prog1\n(Units: 'in' and 'in/min')\nG17 (XY)\nG0 X0. Y0. Z2.\nG1 Z1. F6.\nM30 (end)\n"
    assert np.allclose(places(tmp_path, text)[:, 2], [50.8, 25.4])
    assert np.allclose(places(tmp_path, text.replace("G17", "G21"))[:, 2], [2, 1])


def test_the_steps_of_a_deep_hole_are_no_block_of_the_sub_program(tmp_path: Path) -> None:
    text = (
        "O1\nG21 G90\nG0 X0. Y0. Z9.\nG83 G99 Z-4. R1. Q3. F60 {}M98 P2\nG80\nM30\n"
        "O2\nX5.\nX9.\nM99\n"
    )
    places = program(tmp_path, text.format("")).operation().path.position
    bottoms = places[np.isclose(places[:, 2], -4e-3)]
    assert np.allclose(1e3 * bottoms[:, 0], [0, 5, 9])
    # whose is L2: the hole's or the call's?
    with pytest.raises(InputError, match="M98 calls a sub-program"):
        program(tmp_path, text.format("L2 "))
