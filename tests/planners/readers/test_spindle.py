"""When the spindle runs, and how fast: M3 and M4 hold, and S behind them counts."""

from __future__ import annotations

from pathlib import Path

import pytest
from gcode_files import program

from irb2400_ctrl.planners import CamProgram, read_program


def speeds(found: CamProgram) -> list[float]:
    """Of the operations [1/min], those of a spindle counter-clockwise below zero."""
    turning = [operation.spindle for operation in found.operations]
    return [round(s.rpm, 6) * (1 if s.clockwise else -1) for s in turning]


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
