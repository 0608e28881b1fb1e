"""Heidenhain's plain language: holes, labels, repeats, jumps and Q parameters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import Operation, read_program

Array = npt.NDArray[np.float64]
HEAD = "0 BEGIN PGM PART MM\n1 TOOL CALL 3 Z S600\n2 L X+0 Y+0 R0 FMAX M3\n3 L Z+30 R0 FMAX\n"


def operation(tmp_path: Path, body: str) -> Operation:
    file = tmp_path / "part.h"
    file.write_text(f"{HEAD}{body}99 END PGM PART MM\n")
    return read_program(file).operation()


def defined(number: int, **values: float) -> str:
    lines = [f"Q{key[1:]}={value:+g} ;WHAT ~" for key, value in values.items()]
    return f"4 CYCL DEF {number} HOLE ~\n   " + "\n   ".join(lines).removesuffix(" ~") + "\n"


def cuts(found: Operation) -> list[float]:
    """Heights of the points that are reached at a feed [mm]."""
    return [round(float(z), 6) for z in 1e3 * found.path.position[~found.rapid, 2]]


COMMON = {"q200": 2.0, "q201": -10.0, "q206": 120.0, "q203": 5.0, "q204": 20.0}


@pytest.mark.parametrize(
    ("number", "more", "heights"),
    [
        (200, {"q202": 10.0, "q211": 0.5}, [-5]),
        (200, {"q202": 4.0}, [1, -3, -5]),
        (203, {"q202": 5.0, "q212": 2.0, "q205": 1.0, "q213": 3.0}, [0, -3, -4, -5]),
        (205, {"q202": 6.0}, [-1, -5]),
        (201, {}, [-5, 7]),
        (240, {}, [-5]),
        (207, {"q239": 1.5}, [-5, 7]),
    ],
)
def test_holes(tmp_path: Path, number: int, more: dict[str, float], heights: list[float]) -> None:
    found = operation(tmp_path, defined(number, **COMMON, **more) + "5 L X+8 Y+9 R0 FMAX M99\n")
    assert cuts(found) == heights
    assert np.allclose(1e3 * found.path.position[-1], [8, 9, 25])
    feed = 1.5 * 600 / 60 if number == 207 else 2.0
    assert np.allclose(1e3 * found.path.feed[~found.rapid], feed)
    assert [e.seconds for e in found.events if e.kind == "dwell"] == [0.5] * ("q211" in more)


@pytest.mark.parametrize("blank", ["", " "])
def test_blanks_within_the_number_of_a_cycle(tmp_path: Path, blank: str) -> None:
    """As posts write them, in whatever language."""
    body = f"4 CYCL DEF9{blank}.0 VERWEILZEIT\n5 CYCL DEF9{blank}.1 V.ZEIT5\n6 L X+5 F100\n"
    assert [e.seconds for e in operation(tmp_path, body).events if e.kind == "dwell"] == [5.0]


def test_values_below_the_definition_without_a_tilde(tmp_path: Path) -> None:
    below = ["Q200=2 ;SET-UP CLEARANCE", "  Q201=-10", " Q206=120;FEED", "Q203 = +5", "Q204=Q7"]
    calls = "5 L X+8 Y+9 R0 FMAX M99\n"
    begin = "4 Q7 = 20\nCYCL DEF 200 DRILLING\n"
    found = operation(tmp_path, begin + "\n".join(below) + "\n" + calls)
    assert cuts(found) == [-5]
    assert 1e3 * found.path.position[-1, 2] == pytest.approx(25)
    # what the definition states, what has a number of its own and others are not the cycle's
    assert cuts(operation(tmp_path, f"{defined(200, **COMMON)}Q1=+9\n{calls}")) == [-5]
    with pytest.raises(InputError, match="Q203 of the cycle before it is set anew"):
        operation(tmp_path, f"{defined(200, **COMMON)}Q203=+9\n{calls}")
    numbered = "".join(f"4{k} {line}\n" for k, line in enumerate(below))
    with pytest.raises(InputError, match=r"DRILLING with Q201=0 .* expected a negative depth"):
        operation(tmp_path, begin + numbered + calls)


@pytest.mark.parametrize("breaks", [0.0, 3.0])
def test_chip_breaking_of_the_control_is_said_to_differ(tmp_path: Path, breaks: float) -> None:
    more = {"q202": 5.0, "q213": breaks, "q256": 0.4}
    body = defined(203, **COMMON, **more) + "5 L X+8 Y+9 R0 FMAX M99\n"
    operation(tmp_path, body)
    notes = str(read_program(tmp_path / "part.h").of_kind("assumed"))
    assert ("Q213 and Q256" in notes) is bool(breaks)


@pytest.mark.parametrize(
    "calls",
    [
        "L X+1 Y+1 FMAX M99\nL X+5 FMAX M99\n",
        "L X+1 Y+1 FMAX\nCYCL CALL\nL X+5 FMAX\nCYCL CALL M8\n",
        "CYCL CALL POS X+1 Y+1 Z+0 FMAX\nCYCL CALL POS X+5 Y+1 Z+0 F900 M8\n",
        "L X+1 Y+1 FMAX M89\nL X+5 FMAX M99\nL Z+30 FMAX\n",
        "LBL 1\nL IX+1 Y+1 FMAX M99\nLBL 0\nL X+4 FMAX\nCALL LBL 1\n",
    ],
)
def test_calls_of_a_cycle(tmp_path: Path, calls: str) -> None:
    found = operation(tmp_path, defined(200, **COMMON, q202=10.0) + calls)
    bottoms = 1e3 * found.path.position[np.isclose(found.path.position[:, 2], -5e-3)]
    assert np.allclose(bottoms[:, :2], [[1, 1], [5, 1]])


def test_z_of_a_call_moves_the_surface(tmp_path: Path) -> None:
    body = defined(200, **COMMON, q202=10.0) + "CYCL CALL POS X+1 Y+2 Z-3 FMAX\n"
    found = operation(tmp_path, body)
    expected = [[0, 0, 30], [1, 2, 30], [1, 2, 4], [1, 2, -8], [1, 2, 22]]
    assert np.allclose(1e3 * found.path.position, expected)
    with pytest.raises(InputError, match=r"CYCL CALL POS X\+1 Y\+2, expected X, Y and Z"):
        operation(tmp_path, defined(200, **COMMON, q202=10.0) + "CYCL CALL POS X+1 Y+2\n")


def test_values_of_a_cycle_in_words(tmp_path: Path) -> None:
    text = defined(200, **COMMON, q202=10.0) + "L X+1 FMAX M99\n"
    tool = "TOOL CALL 3 Z S600 F180\nL X+0 Y+0 Z+30 FMAX\n"
    found = operation(tmp_path, tool + text.replace("Q206=+120", "Q206= FAUTO"))
    assert np.allclose(1e3 * found.path.feed[~found.rapid], 3)
    for old, new in (("Q206=+120", "Q206=FU0.1"), ("Q200=+2", "Q200= PREDEF")):
        with pytest.raises(InputError, match=f"found {new.replace('= ', '=')}, expected a number"):
            operation(tmp_path, text.replace(old, new))


def test_the_way_out_is_to_the_clearance_at_least(tmp_path: Path) -> None:
    low = {**COMMON, "q204": 0.0}
    found = operation(tmp_path, defined(200, **low, q202=10.0) + "L X+8 FMAX M99\n")
    assert np.allclose(1e3 * found.path.position[-1], [8, 0, 7])


def test_parameters_of_a_cycle_are_not_set_behind_it(tmp_path: Path) -> None:
    text = "FN 0: Q203 = +1\n" + defined(200, **COMMON) + "FN 0: Q203 = -5\nL X+1 FMAX M99\n"
    with pytest.raises(InputError, match="Q203 of the cycle before it is set anew"):
        operation(tmp_path, text)


@pytest.mark.parametrize(
    "call",
    [
        "L X+0 Y+0 Z+30 FMAX M99\n",
        "L X+0 Y+0 Z+30 FMAX\nCYCL CALL\n",
        "CYCL CALL POS X+0 Y+0 Z+0\n",
    ],
)
def test_no_hole_in_a_plane_that_the_tool_is_not_turned_to(tmp_path: Path, call: str) -> None:
    plane = "PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY\n"
    with pytest.raises(InputError, match=r"a tilted plane \(STAY\) that the tool is not turned to"):
        operation(tmp_path, defined(200, **COMMON) + plane + call)


def test_a_cycle_of_another_kind_is_not_drilled(tmp_path: Path) -> None:
    body = defined(200, **COMMON) + "CYCL DEF 1271 POCKET ~\nQ650=+1\nL X+1 FMAX M99\n"
    with pytest.raises(InputError, match="CYCL DEF 1271 POCKET is not read"):
        operation(tmp_path, body)


def test_what_no_hole_is_made_of(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a cycle is called, and none is defined"):
        operation(tmp_path, "L X+1 FMAX M99\n")
    with pytest.raises(InputError, match="CYCL DEF 252 HOLE is not read; expected one of"):
        operation(tmp_path, defined(252, q200=2.0, q201=-5.0) + "L X+1 FMAX M99\n")
    with pytest.raises(InputError, match="expected a negative depth"):
        operation(tmp_path, defined(200, q200=2.0, q201=5.0) + "L X+1 FMAX M99\n")
    with pytest.raises(InputError, match="without a speed of the spindle or a pitch"):
        operation(tmp_path, defined(207, **COMMON) + "L X+1 FMAX M99\n")
    with pytest.raises(InputError, match="CYCL CALL PAT takes its places from a table"):
        operation(tmp_path, defined(200, **COMMON) + "CYCL CALL PAT FMAX\n")


def test_a_part_of_the_program_is_repeated(tmp_path: Path) -> None:
    part = "LBL 2\nL Z+Q1\nL X+9\nL X+0\nQ1 = Q1 - 2 * SIN 30\nCALL LBL 2 REP 2/2\n"
    body = f"Q1 = -1\nL Z+0 F60\n{part}"
    z = 1e3 * operation(tmp_path, body).path.position[2:, 2]
    assert np.allclose(z, np.repeat([-1, -2, -3], 3))


def test_a_loop_on_a_condition(tmp_path: Path) -> None:
    body = (
        'FN 0: Q1 = +0\nFN 0: Q2 = +4\nL Z+0 F60\nLBL "MORE"\nFN 1: Q1 = +Q1 + +1\n'
        'L X+Q1 Y-Q1\nFN 12: IF +Q1 LT +Q2 GOTO LBL "MORE"\nFN 4: Q3 = +Q2 DIV +8\n'
        "FN 9: IF +Q3 EQU +0.5 GOTO LBL 9\nL X+99\nLBL 9\nL Y+(Q1)\n"
    ).replace("+(Q1)", "+Q1")
    found = 1e3 * operation(tmp_path, body).path.position
    assert np.allclose(found[2:, :2], [[1, -1], [2, -2], [3, -3], [4, -4], [4, 4]])


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("2 ^ 3 - 1", 7.0),
        ("- ( 3 - 5 ) * 2", 4.0),
        ("SQRT 16 + ABS - 2", 6.0),
        ("INT 2.7 + FRAC 2.5", 2.5),
        ("INT -2.7 + 10", 8.0),
        ("FRAC -2.25 + 1", 0.75),
        ("10 / 4 + COS 60", 3.0),
        ("ATAN 1 / 45 + SGN - 3", 0.0),
        ("PI * 0 + SQ 3", 9.0),
    ],
)
def test_formulas(tmp_path: Path, formula: str, value: float) -> None:
    found = operation(tmp_path, f"Q5 = {formula}\nL Z+0 F60\nL X+Q5 Y-Q5\n").path.position[-1]
    assert np.allclose(1e3 * found, [value, -value, 0])


@pytest.mark.parametrize("formula", ["SQRT - 1", "1 / 0", "2 ^ 9999", "(" * 60 + "1"])
def test_formulas_without_a_value(tmp_path: Path, formula: str) -> None:
    with pytest.raises(InputError):
        operation(tmp_path, f"Q5 = {formula}\nL X+Q5 F60\n")


@pytest.mark.parametrize("body", ["LBL 1\nCALL LBL 1\n", "LBL 1\nFN 9: IF 1 EQU 1 GOTO LBL 1\n"])
def test_programs_without_an_end(
    tmp_path: Path, body: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irb2400_ctrl.planners.toolpath.readers.heidenhain.flow.MOST_BLOCKS", 50)
    # blocks of a long file are none that are carried out again
    assert len(operation(tmp_path, "L X+1 F60\n" * 60).path) > 60
    with pytest.raises(InputError, match="expected calls and jumps that end"):
        operation(tmp_path, f"L X+1 F60\n{body}")


def test_a_depth_of_the_full_diameter_needs_the_table_of_tools(tmp_path: Path) -> None:
    call = "5 L X+8 Y+9 R0 FMAX M99\n"
    assert cuts(operation(tmp_path, defined(200, **COMMON, q395=0.0) + call)) == [-5]
    with pytest.raises(InputError, match=r"Q395=1.* table of tools; expected .*Q395=0"):
        operation(tmp_path, defined(200, **COMMON, q395=1.0) + call)
