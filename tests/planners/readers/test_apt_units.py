"""Units of length and feed in APT-like files: every combination, anywhere in the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_path, read_program

LENGTH = {"MM": 1e-3, "CM": 1e-2, "M": 1.0, "INCHES": 25.4e-3, "FEET": 0.3048}
PER_MINUTE = {"MMPM": 1e-3, "MPM": 1.0, "IPM": 25.4e-3, "FPM": 0.3048}
PER_TURN = {"MMPR": 1e-3, "IPR": 25.4e-3}


def feed(tmp_path: Path, *statements: str) -> float:
    """Speed of the last move of a file [m/s]."""
    file = tmp_path / "part.apt"
    file.write_text("\n".join(["GOTO/100,0,0", *statements, "GOTO/100,20,0", "FINI"]))
    return float(read_path(file).feed[-1])


def test_metres_per_minute(tmp_path: Path) -> None:
    assert np.isclose(feed(tmp_path, "FEDRAT/1.2,MPM"), 20e-3)


@pytest.mark.parametrize("word", PER_MINUTE)
@pytest.mark.parametrize("unit", LENGTH)
def test_a_feed_with_its_unit_does_not_depend_on_the_unit_of_length(
    tmp_path: Path, word: str, unit: str
) -> None:
    expected = 30 * PER_MINUTE[word] / 60
    for statement in (f"FEDRAT/30.0,{word}", f"FEDRAT/{word},30.0"):
        file = tmp_path / "part.apt"
        text = f"UNITS/{unit}\nGOTO/1,0,0\n{statement}\nGOTO/1,2,0\n"
        file.write_text(text)
        path = read_path(file, units=None)
        assert np.isclose(path.feed[-1], expected)
        assert np.allclose(path.position, LENGTH[unit] * np.array([[1, 0, 0], [1, 2, 0]]))


@pytest.mark.parametrize("word", PER_TURN)
def test_a_feed_per_revolution_needs_the_spindle(tmp_path: Path, word: str) -> None:
    expected = 0.2 * PER_TURN[word] * 3000 / 60
    assert np.isclose(feed(tmp_path, "SPINDL/3000,RPM,CLW", f"FEDRAT/0.2,{word}"), expected)
    # the speed may come after the feed
    assert np.isclose(feed(tmp_path, f"FEDRAT/{word},0.2", "SPINDL/RPM,3000,CLW"), expected)
    with pytest.raises(InputError, match=r"line 3.*per revolution, but no spindle speed"):
        feed(tmp_path, f"FEDRAT/0.2,{word}")


def test_the_user_may_state_the_spindle_speed(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text("UNITS/MM\nFEDRAT/0.2,MMPR\nGOTO/100,0,0\nGOTO/100,20,0\n")
    assert read_path(file, spindle_rpm=1500).feed[-1] == pytest.approx(5e-3)
    with pytest.raises(InputError, match="spindle_rpm: found -5"):
        read_path(file, spindle_rpm=-5)
    # a look at the file shows its points and what is missing
    shown = read_program(file, strict=False)
    assert len(shown.operation().path) == 2
    assert "per revolution" in str(shown.of_kind("unknown")[0])


@pytest.mark.parametrize("unit", LENGTH)
def test_a_feed_without_unit_is_per_minute_in_the_unit_of_length(tmp_path: Path, unit: str) -> None:
    for words in ("FEDRAT/30", "FEDRAT/30,PERMIN"):
        assert np.isclose(feed(tmp_path, f"UNITS/{unit}", words), 30 * LENGTH[unit] / 60)
    words = "SPINDL/120,RPM", "FEDRAT/0.5,PERREV"
    assert np.isclose(feed(tmp_path, f"UNITS/{unit}", *words), LENGTH[unit])


def test_a_surface_speed_makes_the_spindle_speed(tmp_path: Path) -> None:
    words = ("UNITS/MM", "CUTTER/20", "SPINDL/62.8318530718,SMM,CLW", "FEDRAT/0.1,MMPR")
    # 62.83 m/min over a circumference of 62.83 mm: 1000 revolutions per minute
    assert np.isclose(feed(tmp_path, *words), 1000 * 0.1e-3 / 60)


@pytest.mark.parametrize(("most", "rpm"), [("600", 600), ("3000", 1000), ("0", 1000)])
def test_a_surface_speed_ends_at_the_largest_of_the_spindle(
    tmp_path: Path, most: str, rpm: float
) -> None:
    spindle = f"SPINDL/62.8318530718,SMM,CLW,MAXRPM,{most}"
    words = ("UNITS/MM", "CUTTER/20", spindle, "FEDRAT/0.1,MMPR")
    assert np.isclose(feed(tmp_path, *words), rpm * 0.1e-3 / 60)


@pytest.mark.parametrize("place", ["start", "middle", "end"])
def test_units_stated_once_hold_for_the_whole_file(tmp_path: Path, place: str) -> None:
    lines = {"start": 0, "middle": 1, "end": 2}
    text = ["GOTO/10,0,0", "GOTO/10,5,0"]
    text.insert(lines[place], "UNITS/CM")
    (tmp_path / "part.apt").write_text("\n".join(text))
    assert np.allclose(read_path(tmp_path / "part.apt").position, [[0.1, 0, 0], [0.1, 0.05, 0]])


def test_units_that_change_hold_from_their_line(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text("UNITS/MM\nGOTO/100,0,0\nUNITS/INCHES\nGOTO/10,0,0\n")
    assert np.allclose(read_path(file).position[:, 0], [0.1, 0.254])


def test_the_user_may_state_the_unit(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text("UNITS/MM\nGOTO/1,0,0\nFEDRAT/60,MMPM\nGOTO/1,2,0\n")
    path = read_path(file, units="m")
    assert np.allclose(path.position, [[1, 0, 0], [1, 2, 0]])
    assert np.isclose(path.feed[-1], 1e-3)
    with pytest.raises(InputError, match="units: found 'yard', expected one of mm, cm, m, inch"):
        read_path(file, units="yard")


def test_feeds_tell_the_unit_where_nothing_else_does(tmp_path: Path) -> None:
    file = tmp_path / "part.cls"
    file.write_text("FEDRAT/IPM,6.0\nGOTO/10,0,0\nGOTO/11,0,0\n")
    program = read_program(file)
    assert program.units == "inch"
    assert np.isclose(program.operations[0].path.position[0, 0], 0.254)
    assert "no UNITS/" in str(program.of_kind("assumed")[0])


@pytest.mark.parametrize("word", ["MPS", "CMPS"])
def test_feeds_per_second_tell_metric_lengths_and_an_unknown_unit_names_them(
    tmp_path: Path, word: str
) -> None:
    file = tmp_path / "part.apt"
    file.write_text(f"FEDRAT/0.1,{word}\nGOTO/100,0,0\nGOTO/100,20,0\n")
    assert "lengths in mm, as its feeds" in " ".join(map(str, read_program(file).notes))
    with pytest.raises(InputError, match=rf"the word KMH, .*per second .*\b{word}\b"):
        feed(tmp_path, "FEDRAT/0.1,KMH")


@pytest.mark.parametrize("statement", ["UNITS/PARSEC", "FEDRAT/5,MMPX", "FEDRAT/1,2", "FEDRAT/0"])
def test_unknown_units_are_refused(tmp_path: Path, statement: str) -> None:
    with pytest.raises(InputError, match="line 2"):
        feed(tmp_path, statement)


@pytest.mark.parametrize("order", ["AUTO", "OFF", "ON"])
def test_inverse_feeds_for_the_machine_leave_the_feed_as_it_is(tmp_path: Path, order: str) -> None:
    """Creo writes FEDRAT / INVERS, AUTO before a sequence with rotary axes, and OFF behind it."""
    file = tmp_path / "part.ncl"
    file.write_text(
        f"UNITS / MM\nGOTO / 0, 0, 0\nFEDRAT / 600, MMPM\nFEDRAT / INVERS, {order}\nRAPID\n"
        f"FEDRAT / INVERS, {order}\nGOTO / 5, 0, 0\nGOTO / 9, 0, 0\n"
    )
    operation = read_program(file).operation()
    assert np.isclose(operation.path.feed[-1], 0.01)
    assert operation.rapid.tolist()[1:] == [True, False]


def test_points_are_absolute_where_the_machine_code_is_to_be_incremental(tmp_path: Path) -> None:
    """Creo writes MODE/INCR around the sequences of a subroutine; their points stay absolute."""
    file = tmp_path / "part.apt"
    file.write_text(
        "UNITS/MM\nGOTO/100,10,0\nMODE/INCR\nGOTO/5,0,0\nGODLTA/1,2,3\nMODE/ABSOL\nGOTO/7,8,9\n"
    )
    program = read_program(file)
    expected = [[100, 10, 0], [5, 0, 0], [6, 2, 3], [7, 8, 9]]
    assert np.allclose(1e3 * program.operations[0].path.position, expected)
    assert any("MODE/INCR" in note.text for note in program.of_kind("assumed"))


METRES = r"metres or inches instead of millimetres\? State the unit: units='m' \(--units m; 2000 mm"
INCHES = r"inches or metres instead .* units='inch' \(--units inch; 50.8 mm large\)"


@pytest.mark.parametrize(("name", "text", "says"), [
    ("a.csv", "x_mm,y_mm,z_mm,i,j,k\n1,0,0,0,0,1\n1,2,0,0,0,1\n", METRES),
    ("a.apt", "GOTO/1,0,0\nGOTO/1,2,0\n", METRES),
    ("a.nc", "G0 X1 Y0 Z0\nG1 Y2 F100\n", INCHES),
])  # fmt: skip
def test_a_part_of_two_millimetres_is_asked_about(
    tmp_path: Path, name: str, text: str, says: str
) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(InputError, match=says):
        read_path(file)
    assert np.allclose(read_path(file, units="mm").position[1], [1e-3, 2e-3, 0])
    assert np.allclose(read_path(file, units="m").position[1], [1, 2, 0])


def test_a_small_part_with_a_stated_unit_is_not_asked_about(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text("G21\nG0 X1 Y0 Z0\nG1 Y2 F100\n")
    assert len(read_path(file)) == 2


@pytest.mark.parametrize("column", ["feed", "f", "speed_mm_s", "feed_mm_min", "rx", "a"])
def test_a_column_that_sounds_like_motion_is_refused(tmp_path: Path, column: str) -> None:
    file = tmp_path / "path.csv"
    file.write_text(f"x_mm,y_mm,z_mm,i,j,k,{column}\n900,0,500,0,0,1,5\n950,0,500,0,0,1,5\n")
    with pytest.raises(InputError, match=rf"line 1: the column '{column}' is not read.*feed_mm_s"):
        read_path(file)


def test_other_columns_are_named(tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text("x_mm,y_mm,z_mm,i,j,k,remark\n900,0,500,0,0,1,p\n950,0,500,0,0,1,q\n")
    program = read_program(file)
    assert [str(note) for note in program.of_kind("ignored")] == ["line 1: column remark"]
