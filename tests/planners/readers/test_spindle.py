"""When the spindle runs, and how fast: M3 and M4 hold, S behind them counts, a change of tool ends
it."""

from __future__ import annotations

from pathlib import Path

import pytest
from gcode_files import program

from irb2400_ctrl.planners import CamProgram, read_program
from irb2400_ctrl.planners.linking.program_events import at_rest


def speeds(found: CamProgram) -> list[float]:
    """Of the operations [1/min], those of a spindle counter-clockwise below zero."""
    turning = [operation.spindle for operation in found.operations]
    return [round(s.rpm, 6) * (1 if s.clockwise else -1) for s in turning]


def between(found: CamProgram) -> list[str]:
    """What happens while the arm stands between the two operations."""
    first, second = found.operations
    return [f"{event.kind} {event.text}" for event in at_rest(first, second, 1.0)]


def written(folder: Path, name: str, text: str) -> CamProgram:
    """As read from a file of this name and text."""
    file = folder / name
    file.write_text(text)
    return read_program(file)


@pytest.mark.parametrize(
    ("head", "expected"),
    [
        ("M3\nS1000\n", [1000]),
        ("M4\nS1000\n", [-1000]),
        ("S0 M3\nS2000\n", [2000]),
        ("S500 M3\nM5\nS900\n", [0]),
        ("S500 M3\nM5\nS900 M4\n", [-900]),
        ("M13\nS700\n", [700]),
    ],
)
def test_a_speed_behind_m3_or_m4_counts(tmp_path: Path, head: str, expected: list[float]) -> None:
    found = program(tmp_path, f"G21 G90 T1 M6\n{head}G0 X0 Y0 Z9\nG1 Z0 F100\nX40\nM5\nM30\n")
    assert speeds(found) == expected


def test_a_beam_is_on_where_its_power_is_stated(tmp_path: Path) -> None:
    text = "G21 G90\nM4 S0\nG0 X0 Y0\nG1 X10 F600 S500\nX20\nG1 X30 S0\nX40 S300\nM5\nM2\n"
    found = program(tmp_path, text)
    # on from 0 to 20 and from 30 to 40, by a stop at each beginning
    assert speeds(found)[-2:] == [-500, -300]
    first, second = found.operations[-2:]
    assert first.path.position[0, 0] == pytest.approx(0.0)
    assert second.path.position[0, 0] == pytest.approx(30e-3)
    assert [(e.kind, e.text, e.point) for e in first.events] == [("spindle", "off", 2)]


def test_a_feed_per_turn_has_the_speed_behind_m3(tmp_path: Path) -> None:
    found = program(tmp_path, "G21 G90\nM3\nS1200\nG0 X0 Y0 Z0\nG95 G1 X10 F0.5\nM30\n")
    assert found.operation().path.feed[-1] == pytest.approx(10e-3)


def test_a_tool_call_states_the_speed_behind_m3(tmp_path: Path) -> None:
    text = (
        "0 BEGIN PGM PART MM\n1 TOOL CALL 1 Z\n2 L X+0 Y+0 Z+9 R0 FMAX M3\n3 TOOL CALL Z S2000\n"
        "4 L Z+0 F100\n5 L X+5 M5\n6 TOOL CALL S900\n7 L X+0\n8 END PGM PART MM\n"
    )
    found = written(tmp_path, "part.h", text)
    assert speeds(found) == [2000]
    assert [event.text for event in found.operations[0].events if event.kind == "spindle"] == [
        "off"
    ]


def test_spindl_on_turns_again_as_before(tmp_path: Path) -> None:
    text = (
        "UNITS/MM\nSPINDL/900,RPM,CCLW\nFEDRAT/100,MMPM\nGOTO/0,0,0\nGOTO/9,0,0\nSPINDL/OFF\n"
        "GOTO/9,9,0\nSPINDL/ON\nGOTO/0,9,0\n"
    )
    assert speeds(written(tmp_path, "part.apt", text)) == [-900, -900]


CUT = "G21 G90 T1 M6\nS1000 M3\nM8\nG0 X0 Y0 Z9\nG1 Z0 F100\nX5\nG0 Z9\n"
ON_AGAIN = ["spindle 1000 1/min clockwise", "coolant flood"]
STOPPED = ["spindle off", "coolant off", "tool 2"]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ("T2 M6\nS1000 M3\nM8\n", [*STOPPED, *ON_AGAIN]),
        ("T2 M6\nS1000 M3\n", [*STOPPED, ON_AGAIN[0]]),
        ("T2 M6\nS1000\n", STOPPED),
        # where the tool has left the part for a place of the machine
        ("G28 Z9\nM5\nM9\nT2 M6\nS1000 M3\nM8\n", [*STOPPED, *ON_AGAIN]),
        # at the last place of the operation: nothing is left to stop
        ("M5\nM9\nT2 M6\nS1000 M3\nM8\n", ["tool 2", *ON_AGAIN]),
        # a tool made ready is none changed to
        ("T2\nM0\n", ["stop M0"]),
        ("M5\nM0\nS1000 M3\n", ["stop M0", ON_AGAIN[0]]),
    ],
)
def test_a_change_of_tool_stops_spindle_and_coolant(
    tmp_path: Path, change: str, expected: list[str]
) -> None:
    found = program(tmp_path, f"{CUT}{change}G0 X20 Y0 Z9\nG1 Z0 F100\nX30\nM30\n")
    assert between(found) == expected
    by_change = "a change of tool stops" in str(found.of_kind("assumed"))
    assert by_change == change.startswith("T2 M6")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ("TOOL CALL 2 Z S1000\n6 M3\n", ["spindle off", "tool 2", ON_AGAIN[0]]),
        ("TOOL CALL 2 Z S1000\n", ["spindle off", "tool 2"]),
        ("TOOL CALL Z S1500\n", ["spindle 1500 1/min clockwise"]),
        ("TOOL CALL 1 Z S1500\n", ["spindle 1500 1/min clockwise"]),
    ],
)
def test_a_tool_call_with_another_tool_stops_the_spindle(
    tmp_path: Path, change: str, expected: list[str]
) -> None:
    text = (
        "0 BEGIN PGM PART MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 Z+9 R0 FMAX M3\n3 L Z+0 F100\n"
        f"4 L Z+9 FMAX\n5 {change}7 L X+9 Y+0 Z+8 FMAX\n8 L Z+0 F100\n9 END PGM PART MM\n"
    )
    assert between(written(tmp_path, "part.h", text)) == expected


def test_loadtl_stops_the_spindle(tmp_path: Path) -> None:
    text = (
        "UNITS/MM\nLOADTL/1\nSPINDL/900,RPM,CLW\nCOOLNT/ON\nFEDRAT/100,MMPM\nGOTO/0,0,9\n"
        "GOTO/0,0,0\nLOADTL/2\nSPINDL/900,RPM,CLW\nGOTO/9,0,9\nGOTO/9,0,0\n"
    )
    expected = ["spindle off", "coolant off", "tool 2", "spindle 900 1/min clockwise"]
    assert between(written(tmp_path, "part.apt", text)) == expected


def test_coolant_on_the_way_that_is_left_out_is_on(tmp_path: Path) -> None:
    way = "T2 M6\nS900 M3\nG0 X20 Y0\nX30 M8\nZ4\nG1 Z-2 F100\nM30\n"
    found = program(tmp_path, f"{CUT}{way}")
    assert found.operations[1].coolant == "flood"
    assert between(found)[-2:] == ["coolant flood", "spindle 900 1/min clockwise"]
