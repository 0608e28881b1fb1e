"""Plain APT: several commands in a statement, cycles taken up again, words of more CAM systems."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, Operation, read_program

HEAD = "UNITS/MM\nFEDRAT/300,MMPM\nGOTO/0,0,30\n"


def program(tmp_path: Path, text: str, name: str = "part.apt") -> CamProgram:
    file = tmp_path / name
    file.write_text(text)
    return read_program(file)


def operation(tmp_path: Path, text: str, name: str = "part.apt") -> Operation:
    return program(tmp_path, text, name).operation()


def test_rapid_and_a_motion_in_one_statement(tmp_path: Path) -> None:
    found = operation(tmp_path, HEAD + "RAPID,GOTO/10,0,30\nGOTO/10,0,0\nRAPID , GODLTA/0,0,30\n")
    expected = [[0, 0, 30], [10, 0, 30], [10, 0, 0], [10, 0, 30]]
    assert np.allclose(1e3 * found.path.position, expected)
    assert list(found.rapid[1:]) == [True, False, True]


@pytest.mark.parametrize(
    ("behind", "said"), [("PARTNO B\nGOTO/20,0,0\nFINI\n", True), ("$$ done\n", False)]
)
def test_places_behind_the_end_are_said(tmp_path: Path, behind: str, said: bool) -> None:
    found = program(tmp_path, f"{HEAD}GOTO/10,0,0\nFINI\n{behind}")
    notes = {note.line for note in found.of_kind("assumed") if note.text.startswith("FINI/ ends")}
    assert notes == ({5} if said else set())


def test_rotary_axes_that_are_none_are_said_of_every_language(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text(f"{HEAD}GOTO/10,0,0\n")
    assert read_program(file, rotary="C,A").operations
    with pytest.raises(InputError, match="rotary: found 'Q', expected the rotary axes"):
        read_program(file, rotary="Q")


@pytest.mark.parametrize(
    "statement", ["TLLFT,GORGT/L1,PAST,L2", "TLRGT,GOFWD/C1", "TLON,GOFWD/C1", "TLON,GORGT/L1"]
)
def test_a_motion_behind_the_side_of_the_tool_is_not_lost(tmp_path: Path, statement: str) -> None:
    with pytest.raises(InputError, match=r"line 4: .*expected"):
        program(tmp_path, f"{HEAD}{statement}\nGOTO/10,50,0\n")


def test_a_feed_ends_the_rapid_before_it(tmp_path: Path) -> None:
    found = operation(tmp_path, HEAD + "RAPID\nFEDRAT/60,MMPM\nGOTO/0,0,0\n")
    assert list(found.rapid[1:]) == [False]
    assert found.path.feed[1] == pytest.approx(1e-3)


NX_HOLES = (
    "TOOL PATH/HOLES,TOOL,DRILL\nRAPID\nGOTO/0,0,50,0,0,1\n"
    "CYCLE/DRILL,CLEAR,3.0,FEDTO,-15.0,RTRCTO,AUTO,MMPM,250.0\nGOTO/0,0,10\nCYCLE/OFF\n"
)


@pytest.mark.parametrize(
    ("again", "bottom", "feed"),
    [
        ("CYCLE/ON", -5, 250),
        ("CYCLE/ON,FEDTO,-20.0,RTRCTO,AUTO", -10, 250),
        ("CYCLE/ON,FEDTO,-20.0,MMPM,100.0", -10, 100),
    ],
)
def test_a_cycle_taken_up_again_has_what_is_stated_anew(
    tmp_path: Path, again: str, bottom: float, feed: float
) -> None:
    found = operation(tmp_path, f"{NX_HOLES}{again}\nGOTO/90,0,10\nEND-OF-PATH\n", "part.cls")
    second = found.path.position[:, 0] > 0.05
    assert 1e3 * found.path.position[second, 2].min() == pytest.approx(bottom)
    cut = found.path.feed[second & ~found.rapid]
    assert 60e3 * cut == pytest.approx(np.full(len(cut), feed))
    # back to where the tool came from
    assert 1e3 * found.path.position[-1, 2] == pytest.approx(50)


def test_a_cycle_taken_up_without_one_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="CYCLE/ON without a CYCLE/ before it"):
        program(tmp_path, HEAD + "CYCLE/ON,FEDTO,-20\nGOTO/1,2,3\n")


CSI = (
    "PARTNO/1\nUNIT/MM\nCUTTER/20.,0,10.,0,0,0,100.\nLOAD/TOOL,5\nCSI_SET_FLUTE_LENGTH/38.\n"
    "CSI_SET_EXTENSION_LENGTH/60.\nSPINDL/3322,RPM,CLW\nTRNTYP/WORLD,0,0,0\n"
    "CSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nRAPID/\nGOTO/0,0,25.\n"
)


def test_holes_with_a_first_and_further_pecks(tmp_path: Path) -> None:
    found = operation(
        tmp_path,
        CSI
        + "CYCLE/INIT\nCYCLE/DEEP2,FEDTO,9.,1STPECK,5.,SUBPECK,2.,MMPM,800,RAPTO,3.,RTRCTO,25.\n"
        "GOTO/20.,0,0\nCYCLE/OFF\nFINI\n",
    )
    z = 1e3 * found.path.position[:, 2]
    assert z[~found.rapid] == pytest.approx([-2, -4, -6, -8, -9])
    assert z[-1] == pytest.approx(25)
    assert found.tool.number == 5


@pytest.mark.parametrize(("k", "length"), [(1, np.pi / 2), (-1, 3 * np.pi / 2)])
def test_an_arc_without_its_radius(tmp_path: Path, k: int, length: float) -> None:
    text = f"{CSI}FEDRAT/60,MMPM\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,{k}.\nGOTO/0,10,0\nFINI\n"
    found = operation(tmp_path, text)
    arc = found.path.position[1:]
    assert np.linalg.norm(np.diff(arc, axis=0), axis=1).sum() == pytest.approx(0.01 * length, 1e-2)


@pytest.mark.parametrize(
    ("statement", "says"),
    [
        ("CSYS/0,1,0,0,-1,0,0,0,0,0,1,0", "whether from or to the part is not known"),
        ("TRNTYP/LOCAL,0,0,90", "expected TRNTYP/WORLD,0,0,0"),
        ("UNIT/PARSEC", "UNIT/PARSEC, expected MM"),
        ("CIRCLE/0,0,0,0,0", "expected x,y,z,i,j,k"),
    ],
)
def test_frames_and_units_that_are_not_known(tmp_path: Path, statement: str, says: str) -> None:
    text = CSI.replace("UNIT/MM\n", "") if statement.startswith("UNIT") else CSI
    with pytest.raises(InputError, match=says):
        program(tmp_path, f"{text}{statement}\nGOTO/1,2,3\n")


def test_one_frame_of_all_operations_moves_no_point(tmp_path: Path) -> None:
    away = CSI.replace("CSYS/1.,0,0,0,0,1.,0,0", "CSYS/1.,0,0,-57.,0,1.,0,-57.")
    text = f"{away}FEDRAT/60,MMPM\nGOTO/9,0,0\n{{}}\nRAPID/\nGOTO/0,9,25.\nGOTO/0,9,0\nFINI\n"
    again = away[away.index("TRNTYP") : away.index("RAPID")] + "SPINDL/99,RPM,CLW"
    read = program(tmp_path, text.format(again))
    assert np.allclose(1e3 * read.operations[-1].path.position[-1], [0, 9, 0])
    assert "the points are those of this frame" in str(read.of_kind("assumed"))
    with pytest.raises(InputError, match="expected the same CSYS/ in the whole file"):
        program(tmp_path, text.format(again.replace("-57.", "-58.")))
    late = "PARTNO/1\nGOTO/1,2,3\nCSYS/1.,0,0,5.,0,1.,0,0,0,0,1.,0\nGOTO/9,0,0\nFINI\n"
    with pytest.raises(InputError, match="line 3: CSYS/ moves or turns the points"):
        program(tmp_path, late)


TILTED = (
    "TRNTYP/WORLD,0,0,0\nCSYS/0,.8,.6,0,-1.,0,0,0,0,-0.6,.8,0\nRAPID/\nGOTO/12,5,16,.6,0,.8\n"
    "FEDRAT/60,MMPM\nGOTO/6,5,8,.6,0,.8\nGOTO/-2,5,14,.6,0,.8\n"
)


def test_points_that_state_the_axis_of_their_csys_are_in_one_frame(tmp_path: Path) -> None:
    read = program(tmp_path, f"{TILTED}{CSI}GOTO/0,0,5.\nFINI\n")
    tilted, upright = (operation.path for operation in read.operations)
    assert np.allclose(1e3 * tilted.position, [[12, 5, 16], [6, 5, 8], [-2, 5, 14]])
    assert np.allclose(tilted.axis, [0.6, 0, 0.8])
    assert np.allclose(1e3 * upright.position, [[0, 0, 25], [0, 0, 5]])
    # without i,j,k the tool is that of the part as it stands, not the one before
    assert np.allclose(upright.axis, [0, 0, 1])
    assert "all are in one frame" in str(read.of_kind("assumed"))


@pytest.mark.parametrize(
    "text",
    [
        TILTED.replace(",.6,0,.8\nGOTO/-2", "\nGOTO/-2"),
        TILTED.replace("-2,5,14,.6,0,.8", "-2,5,14,0,0,1"),
        TILTED.replace(".6,0,-1.", ".6,4,-1."),
        # turned about z: in either frame the tool stands along 0,0,1
        "TRNTYP/WORLD,0,0,0\nCSYS/0,-1.,0,0,1.,0,0,0,0,0,1.,0\nFEDRAT/60,MMPM\n"
        "GOTO/12,5,16,0,0,1\nGOTO/6,5,8,0,0,1\n",
    ],
)
def test_other_points_behind_several_csys_are_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match="expected the same CSYS/ in the whole file"):
        program(tmp_path, f"{text}{CSI}GOTO/0,0,5.\nFINI\n")


def test_rapto_beside_fedto_counts_from_the_point(tmp_path: Path) -> None:
    cycle = "CYCLE/DRILL,FEDTO,8.,MMPM,200,CLEAR,15.,RTRCTO,15.,RAPTO,2.\n"
    found = operation(tmp_path, f"{HEAD}{cycle}GOTO/20,0,0\nCYCLE/OFF\nFINI\n")
    z = 1e3 * found.path.position[:, 2]
    bottom = int(np.argmin(z))
    assert z[bottom - 1 : bottom + 2] == pytest.approx([2, -8, 15])


def test_a_dwell_is_a_delay(tmp_path: Path) -> None:
    text = f"{HEAD}SPINDL/120,RPM,CLW\nGOTO/9,0,0\n{{}}\nGOTO/0,0,0\n"
    for words, seconds in (("DELAY/2", 2.0), ("DWELL/2", 2.0), ("DWELL/REV,4", 2.0)):
        events = program(tmp_path, text.format(words)).operations[-1].events
        assert [e.seconds for e in events if e.kind == "dwell"] == pytest.approx([seconds])
    with pytest.raises(InputError, match=r"line 6: DWELL/3,4, expected one time"):
        program(tmp_path, text.format("DWELL/3,4"))


def test_a_call_of_a_program_in_the_control_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 4: CALSUB/START calls .* delete the line if it"):
        program(tmp_path, f"{HEAD}CALSUB/START\nGOTO/9,0,0\n")


def test_a_dollar_at_the_end_of_a_text_swallows_no_motion(tmp_path: Path) -> None:
    text = (
        f"{HEAD}GOTO/9,0,0\nPPRINT IT COSTS 5 $\nGOTO/9,9,0\nPPRINT GOES ON $\nAND ON\nGOTO/0,9,0\n"
    )
    read = program(tmp_path, text)
    found = read.operation()
    expected = [[0, 0, 30], [9, 0, 0], [9, 9, 0], [0, 9, 0]]
    assert np.allclose(1e3 * found.path.position, expected)
    assert [e.text for e in found.events] == ["IT COSTS 5$", "GOES ON AND ON"]


@pytest.mark.parametrize(
    ("words", "rapid"),
    [(["RAPID/ON", "", "RAPID/OFF", ""], [True, True, False, False]),
     (["RAPID/ON", "RAPID", "", "RAPID/OFF"], [True, True, True, False]),
     (["RAPID/OFF", "RAPID", "", ""], [False, True, False, False]),
     (["RAPID/IPM,400", "", "RAPID", ""], [True, False, True, False])],
)  # fmt: skip
def test_rapid_may_hold_until_it_is_switched_off(
    tmp_path: Path, words: list[str], rapid: list[bool]
) -> None:
    moves = "".join(f"{word}\nGOTO/{at},0,0\n" for at, word in enumerate(words, 1))
    assert list(operation(tmp_path, HEAD + moves).rapid[1:]) == rapid
