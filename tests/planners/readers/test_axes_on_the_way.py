"""Under tool centre control the rotary axes turn evenly, and the tool's axis goes their way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import read_program
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import Rotary

CONE = (
    "G21 G90\nG43.4 H1\nG0 X0. Y0. Z50. A30. C0.\nG1 Z0. F600.\nG1 X50. C180. F600.\n"
    "G1 X60. C300.\nM30\n"
)
HEIDENHAIN = (
    "BEGIN PGM A MM\nM128\nL X0 Y0 Z50 A30 C0 R0 FMAX\nL Z0 F600\nL X50 C180\nL X60 C300\n"
    "END PGM A MM\n"
)


def path(folder: Path, text: str, name: str = "a.nc") -> tuple[Array, Array, Array]:
    """Places [mm], axes and feeds of the first operation."""
    (folder / name).write_text(text)
    operation = read_program(folder / name, rotary="C,A").operations[0].path
    return 1e3 * operation.position, operation.axis, operation.feed


@pytest.mark.parametrize(("text", "name"), [(CONE, "a.nc"), (HEIDENHAIN, "a.h")])
def test_a_tilted_head_that_turns_leads_its_axis_along_a_cone(
    text: str, name: str, tmp_path: Path
) -> None:
    """It went through upright, 30 degrees off."""
    place, axis, feed = path(tmp_path, text, name)
    np.testing.assert_allclose(axis[:, 2], np.cos(np.radians(30.0)), atol=1e-3)
    half = int(np.argmin(np.abs(place[:, 0] - 25.0)))
    np.testing.assert_allclose(axis[half], [0.5, 0.0, 0.866], atol=0.02)
    turn = np.unwrap(np.arctan2(axis[1:, 1], axis[1:, 0]))
    assert np.degrees(abs(turn[-1] - turn[0])) == pytest.approx(300.0, abs=1e-6)
    np.testing.assert_allclose(place[-1], [60.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(feed[np.isfinite(feed)], 0.01)


@pytest.mark.parametrize(
    ("word", "upright"),
    [("", True), ("ORIWKS\n", True), ("ORIMKS\n", False), ("ORIAXES\nORIVECT\n", True)],
)
def test_on_a_control_of_siemens_the_axis_goes_the_shortest_way(
    word: str, upright: bool, tmp_path: Path
) -> None:
    """ORIWKS, in the plane of both axes, is its basic setting; ORIMKS turns the machine's axes."""
    text = f"G710 G90\nTRAORI\n{word}G0 X0 Y0 Z5 A=30 C=0\nG1 X50 C=170 F600\nX60\nM30\n"
    _, axis, _ = path(tmp_path, text, "a.mpf")
    # two axes alone are joined the shortest way
    assert (len(axis) < 5) == upright


def test_words_that_say_which_way_to_turn_are_no_even_turn(tmp_path: Path) -> None:
    """From C350 DC=10 goes on by 20 degrees, ACN=10 back by 340: the shortest way is taken."""
    text = "G710 G90\nTRAORI\nORIMKS\nG0 X0 Y0 Z5 A=30 C=0\nG1 X50 C=ACN(170) F600\nM30\n"
    _, axis, _ = path(tmp_path, text, "a.mpf")
    assert len(axis) == 2


def test_inverse_time_is_of_the_whole_block(tmp_path: Path) -> None:
    """30 mm in half a minute."""
    text = "G21 G90\nG43.4 H1\nG0 X0. Y0. Z0. A30. C0.\nG93 G1 X30. C90. F2.\nM30\n"
    _, axis, feed = path(tmp_path, text)
    assert len(axis) > 40
    np.testing.assert_allclose(feed[np.isfinite(feed)], 0.001)


@pytest.mark.parametrize("way", [0.0, 1e-9])
def test_a_head_that_turns_on_the_spot_has_no_time_to_hold(way: float, tmp_path: Path) -> None:
    text = (
        f"G21 G90\nG43.4 H1\nG0 X0. Y0. Z0. A30. C0.\nG1 Z-1. F600.\nG93 G1 X{way:.9f} C90. F2.\n"
    )
    with pytest.raises(InputError, match="line 5: found a cut in inverse time"):
        path(tmp_path, text)
    _, axis, _ = path(tmp_path, text.replace("G93 ", ""))
    np.testing.assert_allclose(axis[:, 2], np.cos(np.radians(30.0)), atol=1e-9)


def test_from_where_a_vector_led_the_tool_it_goes_the_shortest_way(tmp_path: Path) -> None:
    """The rotary axes stand otherwise than the file stated them last."""
    text = "BEGIN PGM A MM\nM128\nL X0 Y0 Z5 A30 C0 R0 FMAX\nLN X5 TX0 TY0 TZ1 F60\nL X9 A30 C90\n"
    _, axis, _ = path(tmp_path, f"{text}END PGM A MM\n", "a.h")
    np.testing.assert_allclose(axis[:, 2], [np.cos(np.radians(30.0)), 1.0, axis[-1, 2]])


VECTORS = {
    "TRAORI": ("TRAORI\nG0 X0. Y0. Z9. A3=0 B3=0.6 C3=0.8\n", "TRAFOOF\n", "a.mpf"),
    "G43.5": ("G43.5 H1\nG0 X0. Y0. Z9. I0. J0.6 K0.8\n", "G49\nG49\n", "a.nc"),
}
AFTER = "G0 X0. Y0. Z9.\nG1 Z0.\nX9.\n"


def last_axis(folder: Path, control: str, text: str) -> Array:
    """Of a program that goes on after a cut with vectors."""
    begin, end, name = VECTORS[control]
    file = folder / name
    file.write_text(f"G21 G90\nG0 X0. Y0. Z9.\n{begin}G1 Z0. F600.\nX5.\n{end}G0 Z99.\n{text}")
    return np.asarray(read_program(file, rotary="C,A").operations[-1].path.axis)[-1]


@pytest.mark.parametrize("control", VECTORS)
@pytest.mark.parametrize("turned", ["G0 A0 C0", "G53 A0 C0", "G91 G28 A0 C0\nG90"])
def test_a_tool_that_a_vector_turned_is_turned_back(
    control: str, turned: str, tmp_path: Path
) -> None:
    """It stood as it was for all that came, and nothing was said."""
    found = last_axis(tmp_path, control, f"{turned}\n{AFTER}")
    np.testing.assert_allclose(found, [0.0, 0.0, 1.0])
    with pytest.raises(InputError, match=r"line \d+: a cut behind the end of tool centre control"):
        last_axis(tmp_path, control, AFTER)
    # out of the part it goes as it stands, and so it does when tool centre control is on again
    for text in ("", f"G43.4\n{AFTER}"):
        np.testing.assert_allclose(last_axis(tmp_path, control, text), [0.0, 0.6, 0.8])


@pytest.mark.parametrize("control", VECTORS)
def test_a_vector_alone_turns_the_tool_on_the_spot(control: str, tmp_path: Path) -> None:
    """Of G43.5 it was left out without a word: the tool stood as before for all that came."""
    upright = {"TRAORI": "G1 A3=0 B3=0 C3=1\n", "G43.5": "G1 I0. J0. K1.\n"}[control]
    begin, end, name = VECTORS[control]
    cut = f"G21 G90\nG0 X0. Y0. Z9.\n{begin}G1 Z0. F600.\n{upright}X5.\n"
    place, axis, _ = path(tmp_path, cut, name)
    np.testing.assert_allclose(axis[-3:], [[0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(place[-3:, 0], [0.0, 0.0, 5.0], atol=1e-9)
    # upright it is turned no more once tool centre control has ended
    _, axis, _ = path(tmp_path, f"{cut}{end}{AFTER}", name)
    np.testing.assert_allclose(axis[-1], [0.0, 0.0, 1.0])


def test_where_a_tool_is_that_was_turned_back_is_not_known(tmp_path: Path) -> None:
    """The file stated no other angles of the axes before."""
    begin, end, name = VECTORS["G43.5"]
    file = tmp_path / name
    file.write_text(
        f"G21 G90\nG0 X0. Y0. Z9.\n{begin}G1 Z0. F600.\nX5.\n{end}G0 Z99.\nG0 A0 C0\n{AFTER}"
    )
    notes = [note.text for note in read_program(file, rotary="C,A").notes]
    assert any("G0 with A, B or C alone turns table or head" in text for text in notes)


@pytest.mark.parametrize(
    ("begin", "ended"), [("G43.4 H1", True), ("G234 H1", True), ("M128", False)]
)
def test_a_length_alone_ends_the_control_of_its_kind(
    begin: str, ended: bool, tmp_path: Path
) -> None:
    """G43 is of one group with G43.4; M128 goes on beside it."""
    text = f"G21 G90\n{begin}\nG0 X0. Y0. Z9. A30. C0.\nG1 Z0. F600.\nG0 Z9.\nG43 H2\nG1 Z0.\n"
    if not ended:
        _, axis, _ = path(tmp_path, text)
        np.testing.assert_allclose(axis[-1], [0.0, -0.5, np.sqrt(0.75)], atol=1e-9)
        return
    with pytest.raises(InputError, match="without tool centre control"):
        path(tmp_path, text)


@pytest.mark.parametrize(
    ("plane", "tilt"),
    [
        ('CYCLE800(0,"",0,57,0,0,0,0,30,0,0,0,0,-1)', 30.0),
        ("CYCLE800()", 0.0),
        ("G68.2 X0. Y0. Z0. I90. J30. K-90.\nG53.1", 30.0),
    ],
)
def test_a_plane_turns_a_tool_that_a_vector_turned(plane: str, tilt: float, tmp_path: Path) -> None:
    control = "G43.5" if "G68.2" in plane else "TRAORI"
    found = last_axis(tmp_path, control, f"{plane}\n{AFTER}")
    stands = np.radians(tilt)
    np.testing.assert_allclose(found, [np.sin(stands), 0.0, np.cos(stands)], atol=1e-9)


@pytest.mark.parametrize(
    ("orders", "steps"),
    [
        ("FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR\n", 1),
        ("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n", 45),
        ("FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR\nFUNCTION RESET TCPM\nM128\n", 45),
    ],
)
def test_whether_heidenhain_turns_evenly_is_stated(orders: str, steps: int, tmp_path: Path) -> None:
    moves = "L X0 Y0 Z5 A30 C0 R0 FMAX\nL X9 A30 C90 F60\nEND PGM A MM\n"
    _, axis, _ = path(tmp_path, f"BEGIN PGM A MM\n{orders}{moves}", "a.h")
    assert len(axis) == 1 + steps
    np.testing.assert_allclose(axis[-1], [0.5, 0.0, np.sqrt(0.75)], atol=1e-9)


@pytest.mark.parametrize(
    ("before", "after", "count"),
    [
        ({"A": 0.0, "C": 0.0}, {"A": 40.0, "C": 0.0}, 1),
        ({"A": 30.0, "C": 0.0}, {"A": 30.0, "C": 0.8}, 1),
        ({"A": 0.0, "C": 0.0}, {"A": 0.0, "C": 300.0}, 1),
        ({"A": 30.0, "C": 0.0}, {"A": 30.0, "C": 10.0}, 5),
        ({"A": -80.0, "C": 0.0}, {"A": 90.0, "C": 0.0}, 1),
        ({"A": 30.0, "C": 350.0}, {"A": 30.0, "C": 10.0}, 10),
        ({"A": 30.0, "C": 0.0}, {"A": 30.0, "C": 360.0}, 1),
    ],
)
def test_axes_are_stated_where_the_way_is_not_the_shortest(
    before: dict[str, float], after: dict[str, float], count: int
) -> None:
    axes = Rotary.of("C,A").way(before, after)
    assert len(axes) == count
    np.testing.assert_allclose(axes[-1], Rotary.of("C,A").axis(after), atol=1e-12)
