"""What a change of tool leaves of the place, and which tool comes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from gcode_files import program

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program
from irb2400_ctrl.planners.toolpath.readers.operation_draft import FROM_ABOVE

FIRST = "G21 G90 T1 M6\nS900 M3\nG0 X0 Y0 Z9\nG1 Z-5 F100\nX5\n"


def heidenhain(folder: Path, text: str) -> CamProgram:
    file = folder / "part.h"
    file.write_text(text)
    return read_program(file)


def test_the_next_tool_does_not_come_at_the_height_of_the_last(tmp_path: Path) -> None:
    found = program(
        tmp_path, f"{FIRST}T2 M6\nS500 M3\nG0 X20 Y0\nX30\nG43 Z4 H2\nG1 Z-2 F100\nM30\n"
    )
    assert np.allclose(1e3 * found.operations[1].path.position, [[30, 0, 4], [30, 0, -2]])
    assert any(FROM_ABOVE in str(note) for note in found.of_kind("assumed"))
    # coolant on the way stays an event before the first point
    found = program(tmp_path, f"{FIRST}T2 M6\nG0 X20 Y0\nX30 M8\nZ4\nG1 Z-2 F100\nM30\n")
    events = [(event.kind, event.point) for event in found.operations[1].events]
    assert ("coolant", -1) in events


@pytest.mark.parametrize(
    ("blocks", "places"),
    [
        # the height of the tool before is that of the first cut: there is no other
        ("G0 X20 Y0\nG1 X30\n", [[20, 0, -5], [30, 0, -5]]),
        # a cut states it, no rapid move: it is cut from there
        ("G0 X20 Y0\nG1 Z-7 F100\nX30\n", [[20, 0, -5], [20, 0, -7], [30, 0, -7]]),
        ("G0 Z9\nX20\nG1 Z-2\n", [[5, 0, 9], [20, 0, 9], [20, 0, -2]]),
        ("G0 X20 Y0 Z9\nX30\nG1 Z-2\n", [[20, 0, 9], [30, 0, 9], [30, 0, -2]]),
    ],
)
def test_what_states_its_height_is_kept(
    tmp_path: Path, blocks: str, places: list[list[float]]
) -> None:
    found = program(tmp_path, f"{FIRST}T2 M6\n{blocks}M30\n")
    assert np.allclose(1e3 * found.operations[1].path.position, places)
    assert FROM_ABOVE not in str(found.of_kind("assumed"))


def test_the_same_in_plain_language(tmp_path: Path) -> None:
    found = heidenhain(
        tmp_path,
        "0 BEGIN PGM PART MM\n1 TOOL CALL 1 Z S900\n2 L X+0 Y+0 Z+9 R0 FMAX\n3 L Z-5 F100\n"
        "4 L X+5\n5 TOOL CALL 2 Z S500\n6 L X+20 Y+0 R0 FMAX\n7 L Z+4 FMAX\n8 L Z-2 F100\n"
        "9 END PGM PART MM\n",
    )
    assert np.allclose(1e3 * found.operations[1].path.position, [[20, 0, 4], [20, 0, -2]])


def test_the_second_tool_of_a_change_is_made_ready(tmp_path: Path) -> None:
    found = program(
        tmp_path,
        "G21 G90 T1 T2 M6\nS900 M3\nG0 X0 Y0 Z9\nG1 Z0 F100\nM6\nG0 X1 Y0 Z9\nG1 Z0\nM30\n",
    )
    assert [operation.tool.number for operation in found.operations] == [1, 2]
    assert "the second made ready" in str(found.of_kind("assumed"))


def test_two_tools_without_a_change_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 2: found T1 and T2 in one block"):
        program(tmp_path, "G21 G90\nT1 T2\nM6\nG0 X0 Y0 Z9\nG1 Z0 F100\nM30\n")


def test_without_any_m6_the_word_t_changes_the_tool(tmp_path: Path) -> None:
    text = "G21 G90\nT1\nS900 M3\nG0 X0 Y0 Z9\nG1 Z0 F100\nT2\nG0 X1 Y0 Z9\nG1 Z0\n{}M30\n"
    found = program(tmp_path, text.format(""))
    assert [operation.tool.number for operation in found.operations] == [1, 2]
    assert "no M6 in the whole file" in str(found.of_kind("assumed"))
    # else it only makes it ready
    found = program(tmp_path, text.format("M6\nG0 X2 Y0 Z9\nG1 Z0\n"))
    assert [operation.tool.number for operation in found.operations] == [None, 2]
    assert "no M6" not in str(found.of_kind("assumed"))


@pytest.mark.parametrize(
    ("text", "tools"),
    [
        # the next tool is made ready while the first one cuts
        ('T="A"\nM6\nT="B"\n{cut}M6\n{cut}', [(None, "A"), (None, "B")]),
        ('T1\nM6\nT="B"\n{cut}M6\n{cut}', [(1, ""), (None, "B")]),
        ('T="A" M6\n{cut}T2\nM6\n{cut}', [(None, "A"), (2, "")]),
        # with the number of the spindle
        ('T1="A" M6\n{cut}T1=2 M6\n{cut}', [(None, "A"), (2, "")]),
        # on machines without M6 T changes the tool
        ('T="A" D1\n{cut}T="B" D1\n{cut}T="B" D1\n{cut}', [(None, "A"), (None, "B")]),
    ],
)
def test_a_tool_that_is_called_by_its_name(
    tmp_path: Path, text: str, tools: list[tuple[int | None, str]]
) -> None:
    file = tmp_path / "part.mpf"
    cut = "S900 M3\nG0 X0 Y0 Z9\nG1 Z-5 F100\nX5\n"
    file.write_text(f"G17 G90 G71 G54\n{text.format(cut=cut)}M30\n")
    found = read_program(file).operations
    assert [(one.tool.number, one.tool.name) for one in found] == tools
    told = [event.text for one in found for event in one.events if event.kind == "tool"]
    assert told == [f"{'' if number is None else number}{name}" for number, name in tools]
