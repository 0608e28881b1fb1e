"""G-code of Siemens' controls: words of other posts, tilted planes, what turns back to zero."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program

HEAD = "G710 G90 G54\nG0 X0 Y0 Z9\n"
CUT = "G1 Z1 F100\nX5\nM30\n"


def read(tmp_path: Path, text: str, rotary: str | None = None) -> CamProgram:
    file = tmp_path / "part.mpf"
    file.write_text(text)
    return read_program(file, rotary=rotary)


@pytest.mark.parametrize(
    "block",
    [
        "DYNFINISH",
        "G641 ADIS=0.5 ADISPOS=1",
        "CTOL=0.01 OTOL=0.5",
        "ORIMKS COMPSURF UPATH FIFOCTRL",
        "G17 KONT NORM CUT2D CDOF",
        "JERKLIM[X]=90 FGREF[C]=10",
        "G290",
        'GROUP_BEGIN(0,"ROUGH, 1",0,0)',
        "GROUP_END(0,0)",
        "STAT='B10' TU=1",
        "OVR=100 OVRRAP=50",
    ],
)
def test_words_for_the_control_alone_move_nothing(tmp_path: Path, block: str) -> None:
    found = read(tmp_path, f"{HEAD}{block}\n{CUT}").operation()
    assert np.allclose(1e3 * found.path.position, [[0, 0, 9], [0, 0, 1], [5, 0, 1]])


@pytest.mark.parametrize("block", ["G153 G0 Z500 D0", "G75 Z1=0", "G75 FP=1 Z1=0", "G0 G53 Z0"])
def test_places_of_the_machine_are_not_gone_to(tmp_path: Path, block: str) -> None:
    found = read(tmp_path, f"{HEAD}{CUT[:-4]}{block}\nG0 X7 Y0\nZ9\n{CUT}")
    assert [len(operation.path) for operation in found.operations] == [3, 3]
    assert "places of the machine tool" in str(found.of_kind("assumed")[0])


def test_a_cycle_of_other_controls_is_no_fixed_point(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown code G75"):
        read(tmp_path, f"{HEAD}G75 X4. Z-5. P1000 Q2000 F0.1\n{CUT}")


def test_an_override_of_feeds_is_refused(tmp_path: Path) -> None:
    for block in ("OVR=50", "OVR=1000"):
        with pytest.raises(InputError, match=rf"line 3: found '{block}'"):
            read(tmp_path, f"{HEAD}{block}\n{CUT}")


def test_a_spindle_by_its_number(tmp_path: Path) -> None:
    found = read(tmp_path, f"G710 G90\nS1=5000 M1=3\nG0 X0 Y0 Z9\n{CUT}").operation()
    assert found.spindle.rpm == pytest.approx(5000)


PLANE = 'CYCLE800(0,"",220000,39,0,0,0,-30,50,0,0,0,0,0,0)\nG0 X0 Y0 Z9\nG1 Z0 F100\nM30\n'
# C and A that lead to it: about z by -30, then about x by 50
TURNED = "G0 A50 C=DC(330)\n"


def test_a_plane_that_the_file_has_turned_the_tool_to(tmp_path: Path) -> None:
    found = read(tmp_path, f"G710 G90\n{TURNED}{PLANE}", "C,A")
    normal = [-0.38302222, -0.66341395, 0.64278761]
    axis = found.operation().path.axis
    assert axis is not None
    assert np.allclose(axis, normal)
    assert np.allclose(1e3 * found.operation().path.position[0], 9 * np.array(normal))
    assert "_DIR 0: the file has turned the tool" in str(found.of_kind("assumed"))
    with pytest.raises(InputError, match="nor does the file by A, B, C before it"):
        read(tmp_path, f"G710 G90\n{PLANE}")


def test_angles_that_do_not_lead_to_the_plane_are_refused(tmp_path: Path) -> None:
    says = r"angles B50 C330 differ by 65\.6 deg with the stated rotary axes"
    with pytest.raises(InputError, match=says):
        read(tmp_path, f"G710 G90\n{TURNED.replace('A', 'B')}{PLANE}", "C,B")
    file = tmp_path / "part.nc"
    file.write_text("G21 G90\nG0 A30. C0.\nG68.2 X0 Y0 Z0 I0 J-30. K0\nG53.1\nG0 X0 Y0 Z9\nG1 Z0\n")
    with pytest.raises(InputError, match=r"A30 differ by 60\.0 deg"):
        read_program(file, rotary="C,A")
    # without stated axes only the plane counts
    assert len(read_program(file).operations) == 1


def test_angles_under_tool_centre_control_are_no_way_to_the_next_plane(tmp_path: Path) -> None:
    text = (
        "G710 G90\nTRAORI\nG0 X0 Y0 Z9 A30 C0\nG1 Z1 F100\nTRAFOOF\n"
        'CYCLE800(1,"R",0,57,0,0,0,0,-15,0,0,0,0,-1,0)\nG0 X0 Y0 Z9\nG1 Z1\nM30\n'
    )
    found = read(tmp_path, text, "C,A").operations[-1].path.axis
    assert found is not None
    assert np.allclose(found, [np.sin(np.radians(-15)), 0, np.cos(np.radians(15))])


@pytest.mark.parametrize("back", ["SUPA A0 C0", "G28 A0 C0", "G53 G0 A0 C0"])
def test_axes_that_went_home_stand_at_zero(tmp_path: Path, back: str) -> None:
    text = (
        "G710 G90\nTRAORI\nG0 X0 Y0 Z9 A30 C0\nG1 Z1 F100\n"
        f"TRAFOOF\n{back}\nG0 X0 Y0 Z9\nG1 Z1\nM30\n"
    )
    found = read(tmp_path, text, "C,A").operations[-1].path.axis
    assert found is not None
    assert np.allclose(found, [0, 0, 1])


@pytest.mark.parametrize("block", ["SPOS=90", "SPOS[1]=-0.5", "SPOSA=DC(90)", "SPOS[2] = IC(12.5)"])
def test_the_spindle_turned_to_an_angle_is_not_carried_out(tmp_path: Path, block: str) -> None:
    found = read(tmp_path, f"{HEAD}{block}\n{CUT}")
    assert np.allclose(1e3 * found.operation().path.position, [[0, 0, 9], [0, 0, 1], [5, 0, 1]])
    assert "M19: a function of the machine" in str(found.of_kind("assumed"))


def test_a_dwell_in_turns_of_the_spindle(tmp_path: Path) -> None:
    found = read(tmp_path, f"{HEAD}S120 M3\nG1 Z3 F100\nG4 S30\nX1\n{CUT}").operation()
    (dwell,) = found.events
    assert (dwell.kind, dwell.seconds) == ("dwell", pytest.approx(15.0))
    assert found.spindle.rpm == pytest.approx(120)
    with pytest.raises(InputError, match=r"G4 S30 waits for turns .* expected .* a spindle that"):
        read(tmp_path, f"{HEAD}G4 S30\n{CUT}")
    with pytest.raises(InputError, match=r"G4 S-3 waits for turns .* a positive number"):
        read(tmp_path, f"{HEAD}S120 M3\nG4 S-3\n{CUT}")


@pytest.mark.parametrize(
    ("block", "found"), [("BSPLINE", "BSPLINE"), ("PO[X]=(10,1,2) PL=1", "PO"), ("N5 POLY", "POLY")]
)
def test_splines_are_refused_by_their_name(tmp_path: Path, block: str, found: str) -> None:
    with pytest.raises(InputError, match=f"line 3: found {found}: splines and polynomials"):
        read(tmp_path, f"{HEAD}{block}\n{CUT}")


@pytest.mark.parametrize(
    ("words", "end"),
    [
        ("X=IC(R1)", [6, 2, 0]),
        ("X=IC((R1+1)*(2)) Y=AC(10*SIN(30))", [13, 5, 0]),
        ("X=AC( -R1 ) Y=IC(3)", [-5, 5, 0]),
        ("Z=IC(_UP-0.5) Y=IC(-1)", [1, 1, 2]),
    ],
)
def test_places_and_ways_by_expressions(tmp_path: Path, words: str, end: list[float]) -> None:
    head = "DEF REAL _UP=2.5\nR1=5\nG710 G90 G54\nG0 X1 Y2 Z0\n"
    found = read(tmp_path, f"{head}G1 {words} F100\nM30\n").operation()
    assert np.allclose(1e3 * found.path.position[-1], end)


def test_centres_and_angles_by_expressions(tmp_path: Path) -> None:
    text = "R1=5\nG710 G90 G54\nG0 X0 Y0 Z0\nG3 X=R1*2 Y0 I=AC(R1) J=AC(2*R1-10) F100\nM30\n"
    path = 1e3 * read(tmp_path, text).operation().path.position
    assert np.allclose(np.linalg.norm(path - [5, 0, 0], axis=1), 5)
    turned = "R1=30\nG710 G90 G54\nTRAORI\nG0 X0 Y0 Z0 A0 C0\nG1 X5 A=DC(R1+10) C=IC(R1) F100\n"
    found = read(tmp_path, f"{turned}M30\n", rotary="C,A").operation()
    s = np.sin(np.radians(40))
    assert found.path.axis is not None
    assert np.allclose(found.path.axis[-1], [s / 2, -s * np.sqrt(3) / 2, np.cos(np.radians(40))])


@pytest.mark.parametrize(
    ("head", "call"),
    [
        ("PROC SUB1", "SUB1"),
        ("N1 PROC SUB1 DISPLOF ACTBLOCNO ; A HEAD", "SUB1"),
        ("PROC SUB1()", "SUB1()"),
    ],
)
def test_heads_of_sub_programs_without_arguments(tmp_path: Path, head: str, call: str) -> None:
    main = f"%_N_MAIN_MPF\nEXTERN SUB1\nG710 G90 G54\nG0 X0 Y0 Z0\n{call}\nM30\n"
    found = read(tmp_path, f"{main}%_N_SUB1_SPF\n{head}\nG1 X5 F60\nRET\n").operation()
    assert np.allclose(1e3 * found.path.position, [[0, 0, 0], [5, 0, 0]])
    for line in ("PROC SUB1(REAL A1)", "EXTERN SUB1(REAL)"):
        with pytest.raises(InputError, match=r"found '(PROC|EXTERN) SUB1"):
            read(tmp_path, f"{main}%_N_SUB1_SPF\n{line}\nG1 X5 F60\nRET\n")
    # the control is at G90 again behind it
    with pytest.raises(InputError, match=r"found 'PROC SUB1 SAVE'.* with SAVE the caller has"):
        read(tmp_path, f"{main}%_N_SUB1_SPF\nPROC SUB1 SAVE\nG91 G1 X5 F60\nRET\n")


@pytest.mark.parametrize(
    "block", ["$P_PFRAME=CTRANS(X,100)", "$P_PFRAME=CTRANS (X,100)", "$P_PFRAME=CROT(Z,30)"]
)
def test_a_frame_that_is_set_is_no_order_to_grbl(tmp_path: Path, block: str) -> None:
    with pytest.raises(InputError, match=r"line 3: found '\$P_PFRAME"):
        read(tmp_path, f"G54 G710\nG0 X0 Y0 Z9\n{block}\nG1 X5 F100\nM30\n")


@pytest.mark.parametrize("end", ["RET", "N90 RET ; back", "M17"])
def test_a_sub_program_that_none_calls_is_the_program(tmp_path: Path, end: str) -> None:
    """Posts write operations so, for a main program on the control."""
    file = tmp_path / "part.spf"
    file.write_text(f"PROC PART\nG17 G90 G71 G54\nG0 X0 Y0 Z9\nG1 Z-1 F60\n{end}\nG1 X7\nM30\n")
    found = read_program(file)
    assert np.allclose(1e3 * found.operation().path.position, [[0, 0, 9], [0, 0, -1]])
    assert "behind it are left out" in str(found.of_kind("assumed"))
    assert "function of the machine" not in str(found.of_kind("assumed"))
