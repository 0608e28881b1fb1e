"""What the numbers of a `CYCLE/` mean in each way of writing them, as a table of statements."""

from __future__ import annotations

from pathlib import Path

import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.toolpath.readers.apt.cycles import hole_cycle
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, statements
from irb2400_ctrl.planners.toolpath.readers.dialect import CATIA, CREO, NX
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle


def cycle(words: str, dialect: str = CATIA) -> HoleCycle:
    statement = next(iter(statements(f"CYCLE/{words}")))
    assert isinstance(statement, Statement)
    return hole_cycle(statement, 1e-3, dialect)


# words, depth, clearance, feed [mm/min] or [mm per turn], and whether they can be read two ways
BARE = [
    ("DRILL,12.,2.,300.,MMPM", 12, 2, 300, False),
    ("DRILL,12.,300.,MMPM,2.", 12, 2, 300, True),
    ("DRILL,12.,MMPM,300.,2.", 12, 2, 300, False),
    ("DEEPHL,30.,INCR,5.,300.,MMPM,2.", 30, 2, 300, True),
    ("DEEPHL,30.,300.,MMPM,INCR,5.,2.", 30, 2, 300, False),
    ("DEEPHL,30.,INCR,5.,2.,300.,MMPM", 30, 2, 300, False),
    ("BRKCHP,30.,INCR,5.,300.,MMPM,2.,DWELL,1.", 30, 2, 300, True),
    ("CBORE,9.,300.,MMPM,2.,DWELL,0.5", 9, 2, 300, True),
    ("CSINK,5.,80.,MMPM,2.,DWELL,1.", 5, 2, 80, True),
    ("BORE,12.,0.1,MMPR,2.,ORIENT,0.0,DWELL,REV,3", 12, 2, 0.1, True),
    ("TAP,12.,1.25,MMPR,2.", 12, 2, 1.25, True),
    ("TAP,12.,2.5,MMPR,2.", 12, 2, 2.5, True),
    ("TAP,12.,MMPR,2.5,2.", 12, 2, 2.5, False),
]


@pytest.mark.parametrize(("words", "depth", "clear", "feed", "two_ways"), BARE)
def test_bare_numbers_and_words_in_any_order(
    words: str, depth: float, clear: float, feed: float, two_ways: bool
) -> None:
    found = cycle(words)
    assert 1e3 * found.depth == pytest.approx(depth)
    assert 1e3 * found.clearance == pytest.approx(clear)
    assert 1e3 * found.retract == pytest.approx(clear)
    assert found.feed is not None
    per = {"speed": 6e4, "turn": 1e3}[found.feed.kind]
    assert per * found.feed.value == pytest.approx(feed)
    assert bool(found.assumed) == two_ways


def test_what_was_told_apart_is_noted(tmp_path: Path) -> None:
    path = tmp_path / "part.apt"
    cycle = "SPINDL/100,RPM,CLW\nCYCLE/TAP,12.,2.5,MMPR,2.\n"
    path.write_text(f"RAPID\nGOTO/0,0,30\n{cycle}GOTO/9,0,0\n")
    assumed = " ".join(map(str, read_program(path).of_kind("assumed")))
    assert "CYCLE/TAP: of the bare numbers 2 is the clearance, 2.5 the feed" in assumed


def test_threads_per_inch_are_a_feed() -> None:
    found = cycle("TAP, DEPTH, 12.0, TPI, 20.0, CLEAR, 5.0", CREO)
    assert found.feed is not None
    assert (found.feed.kind, found.feed.value) == ("turn", pytest.approx(25.4e-3 / 20))


def test_orient_takes_the_way_aside_too() -> None:
    found = cycle("BORE, DEPTH, 20.0, IPR, 0.005, CLEAR, 3.0, ORIENT, 0.0, 0.02", CREO)
    assert 1e3 * found.depth == pytest.approx(20)
    assert 1e3 * found.clearance == pytest.approx(3)


@pytest.mark.parametrize(("words", "says"), [
    ("BORE,BACK,RAPTO,3.0,FEDTO,-20.0,MMPM,100.", "CYCLE/BORE,BACK is not read"),
    ("DRILL,RAPTO,30.0,FEDTO,5.0,MMPM,100.", "the bottom would be above it"),
])  # fmt: skip
def test_holes_of_nx_that_go_upwards_are_refused(words: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        cycle(words, NX)


def test_others_write_the_depth_of_fedto_with_either_sign() -> None:
    words = "DRILL,FEDTO,{},MMPM,200,RAPTO,2."
    assert cycle(words.format("12."), "APT") == cycle(words.format("-12."), "APT")
