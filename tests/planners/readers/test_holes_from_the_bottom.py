"""Holes of Autodesk's APT (Fusion, HSMWorks): the points are bottoms, heights count from zero."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program

HEAD = "UNITS/MM\nLOADTL/3, 0, 40, 3\nRAPID\nGOTO/10, 10, 15\n"


def read(folder: Path, body: str) -> CamProgram:
    file = folder / "part.apt"
    file.write_text(f"{HEAD}{body}CYCLE/OFF\nRAPID\nGOTO/30, 10, 15\nFINI\n")
    return read_program(file)


def points(program: CamProgram) -> Array:
    return np.asarray(1e3 * program.operation().path.position)


@pytest.mark.parametrize(
    ("words", "begins"),
    [("DRILL, 12, MMPM, 200, 15", 15), ("DRILL, 12, MMPM, 200, 15, RAPTO, 10", 5),
     ("DRILL, 12., MMPM, 200.0000, 15., RAPTO, 10.", 5),
     ("BORE, 12, MMPM, 200, 15, 0.2, RAPTO, 10, ORIANT, 0", 5)],
)  # fmt: skip
def test_the_tool_goes_to_the_point_and_no_deeper(
    tmp_path: Path, words: str, begins: float
) -> None:
    program = read(tmp_path, f"CYCLE/{words}\nFEDRAT/200, MMPM\nGOTO/10, 10, -12\n")
    found = points(program)
    assert found[:, 2].min() == pytest.approx(-12)
    cut = np.flatnonzero(np.isfinite(program.operation().path.feed))
    assert found[cut[0] - 1, 2] == pytest.approx(begins)
    assert "they are the bottoms of the holes" in " ".join(map(str, program.of_kind("assumed")))


def test_steps_count_from_where_the_feed_begins(tmp_path: Path) -> None:
    words = "DEEP, 12, INCR, 6, MMPM, 200, 15, RAPTO, 13"
    found = points(read(tmp_path, f"CYCLE/{words}\nFEDRAT/200, MMPM\nGOTO/10, 10, -12\n"))
    # 2 is where the feed begins: 15 less 13
    feeds = found[:, 2][np.isclose(found[:, 2] % 1, 0) & (found[:, 2] < 0)]
    assert sorted(set(feeds.round(6)), reverse=True) == [-4, -10, -12]


def test_without_a_feed_between_the_point_is_on_the_surface(tmp_path: Path) -> None:
    found = points(read(tmp_path, "CYCLE/DRILL, 12, MMPM, 200, 3\nGOTO/10, 10, 0\n"))
    assert found[:, 2].min() == pytest.approx(-12)


def test_another_feed_between_says_nothing(tmp_path: Path) -> None:
    body = "CYCLE/DRILL, 12, MMPM, 200, 3\nFEDRAT/500, MMPM\nGOTO/10, 10, 0\n"
    assert points(read(tmp_path, body))[:, 2].min() == pytest.approx(-12)


@pytest.mark.parametrize(
    ("body", "says"),
    [("CYCLE/DRILL, 12, MMPM, 200, 3\nFEDRAT/200, MMPM\nGOTO/10, 10, 0\n", "less than the depth"),
     ("CYCLE/DRILL, 12, MMPM, 200, 15\nFEDRAT/200, MMPM\nGOTO/10,10,-12,0.6,0,0.8\n", "inclined"),
     ("CYCLE/DRILL,5,-10,MMPM,200\nGOTO/10,10,0\n", "the clearance -10, below the point")],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(tmp_path: Path, body: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        read(tmp_path, body)
