"""Thirteen files of the field, as they were found: what was counted in them by hand.

They lie beside the project (`../shared/cam`, or `$IRB2400_SHARED/cam`); without them the tests are
skipped.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl.planners import Operation, read_path, read_program

Array = npt.NDArray[np.float64]
SHARED = Path(os.environ.get("IRB2400_SHARED", Path(__file__).parents[3] / "../shared"))
FOLDER = SHARED / "cam"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="no real CAM files beside the project")

# file: language, name of its operation, tool, diameter mm, feeds mm/s, extent mm (low, high)
FACTS = {
    "TORETC_250_BOK.cls": ("NX CLSF", "2_TORETC_250_BOK", "FACE_MILL_2", 250, (10, 10),
                           (-300, 0, -355.22), (149.94, 125, 0.22)),
    "_10_KONTUR_125_N2_162.cls": ("NX CLSF", "6_KONTUR_VNUT_125_N2_VAR", "FACE_MILL", 125,
                                  (53 / 6, 53 / 6), (650, -397.5, 413), (1392, -188.5, 964)),
    "_1_KONTUR_NAR_40_N2.cls": ("NX CLSF", "8_KONTUR_NAR_40_N2", "FACE_MILL_1", 40,
                                (10.35, 10.35), (-13, -871, 466), (2133, 39.94, 478)),
    "_4_SVERL_63_N2.cls": ("NX CLSF", "10_SVERL_63_N2", "DRILLING_TOOL", 63, (2, 2),
                           (1484.9948, -837.0281, 228), (2151.5, -28.7978, 471)),
    "cutcom.clsf": ("NX CLSF", "BOK_7", "R390-25A25L-17L", 25, (50 / 3, 50 / 3),
                    (-14.3119, -232.3289, 0), (268.9468, 25.462, 82)),
    "deep_drill.clsf": ("NX CLSF", "DRILLING", "COUNTERSINKING_TOOL", 30, (25 / 6, 25 / 6),
                        (-255, 0, 240), (66, 0, 243)),
    "nurbs.clsf": ("NX CLSF", "FIXED_CONTOUR", "BALL_MILL", 30, (25 / 6, 25 / 6),
                   (-254.9933, -30.2415, 206.8429), (65.9935, 468.3788, 272.7606)),
    "ust_a.cls": ("NX CLSF", "VARIABLE_CONTOUR", "BPR-SNR-323S32", 32, (25 / 6, 25 / 6),
                  (0, -69.5108, -177.5), (803.2154, 251.125, 8.5927)),
    "bohren_1.ncl.8": ("Creo NCL", "feature 32", "", 3, (5 / 6, 5 / 6),
                       (-16.7803891, -23, -3), (-7.2290791, -23, 2)),
    "PrepaFlans_Pointage.aptsource": ("CATIA aptsource", "Pointage.1", "T1 PointeurD10", 10,
                                      (5, 50 / 3), (98, 48, 17), (342, 292, 120)),
    "platteyz-pass-1-profile.nc": ("G-code", "Profile", "3mm_endmill", 3, (0.5, 5),
                                   (-1.5, -1.5, -3), (181.5, 101.5, 6)),
    "platteyz-pass-2-drill.nc": ("G-code", "Drilling", "3mm_endmill", None, (0.5, 0.5),
                                 (15, 4, -3), (125, 96, 6)),
    "platteyz-pass-3-helix.nc": ("G-code", "Helix", "3mm_endmill", None, (0.5, 5),
                                 (61, 18.9, -3), (163.2, 81.1, 6)),
}  # fmt: skip


def only(name: str) -> Operation:
    return read_program(FOLDER / name).operation()


def places(name: str) -> Array:
    """[mm]"""
    return np.asarray(1e3 * only(name).path.position)


@pytest.mark.parametrize("name", FACTS)
def test_facts(name: str) -> None:
    language, title, tool, diameter, feeds, low, high = FACTS[name]
    program = read_program(FOLDER / name)
    operation = program.operation()
    assert program.dialect == language
    assert program.units == "mm"
    assert program.of_kind("unknown") == []
    assert operation.name == title
    assert operation.tool.name == tool
    found = operation.tool.diameter
    assert (None if found is None else 1e3 * found) == pytest.approx(diameter)
    assert np.allclose(1e3 * np.array(operation.feed_range()), feeds)
    p = 1e3 * operation.path.position
    # arcs reach beyond their ends by up to the chord tolerance less
    assert np.allclose(p.min(axis=0), low, atol=0.06)
    assert np.allclose(p.max(axis=0), high, atol=0.06)
    assert np.array_equal(read_path(FOLDER / name).position, operation.path.position)


@pytest.mark.parametrize("name", [name for name in FACTS if name.endswith((".cls", ".clsf"))])
def test_every_stated_point_is_a_way_point(name: str) -> None:
    if name == "deep_drill.clsf":
        return
    text = (FOLDER / name).read_text().split("\n")
    p = places(name)
    for line in text:
        word, _, values = line.partition("/")
        if word in {"GOTO", "FROM", "GOHOME"}:
            stated = np.array([float(v) for v in values.split(",")[:3]])
            assert np.linalg.norm(p - stated, axis=1).min() < 1e-6, line


def test_contour_in_arcs() -> None:
    operation = only("_10_KONTUR_125_N2_162.cls")
    p = 1e3 * operation.path.position
    # a helix in its second turn, a full circle in four arcs, a quarter, a line
    helix = np.hypot(56.25 * np.radians(360 + 77.72), 3)
    expected = helix + 2 * np.pi * 104.5 + np.pi / 2 * 75 + np.hypot(35.9148, 14.1265)
    assert 1e3 * operation.lengths()[0] == pytest.approx(expected, rel=2e-3)
    circle = np.abs(np.linalg.norm(p - [1287.5, -293, 413], axis=1) - 104.5) < 1e-3
    angle = np.degrees(np.unwrap(np.arctan2(*(p[circle][:, :2] - [1287.5, -293]).T[::-1])))
    assert angle[-1] - angle[0] == pytest.approx(360, abs=0.1)
    assert (np.diff(angle) > 0).all()


def test_drilled_holes() -> None:
    p = places("_4_SVERL_63_N2.cls")
    assert (np.abs(p[:, 2] - 228) < 1e-6).sum() == 29
    assert only("_4_SVERL_63_N2.cls").rapid[1:].sum() == 61
    catia = places("PrepaFlans_Pointage.aptsource")
    assert (np.abs(catia[:, 2] - 17) < 1e-6).sum() == 12
    creo = only("bohren_1.ncl.8")
    z = 1e3 * creo.path.position[:, 2]
    # 3.5 deep from z = 0.5 in steps of 1 from the clearance at 1.5
    holes = [1.5, 0.5, 1.5, 0.754, -0.5, 1.5, -0.246, -1.5, 1.5, -1.246, -2.5, 1.5, -2.246, -3, 1.5]
    assert np.allclose(z[:16], [2.0, *holes])
    assert creo.spindle.rpm == pytest.approx(9000)
    free = only("platteyz-pass-2-drill.nc")
    bottoms = np.abs(1e3 * free.path.position[:, 2] + 3) < 1e-6
    assert bottoms.sum() == 10


def test_five_axis_path_keeps_its_axes() -> None:
    axis = only("ust_a.cls").path.axis
    assert axis is not None
    assert np.allclose(axis[0], [0, 0, -1])
    tilt = np.degrees(np.arccos(np.clip(-axis[:, 2], -1, 1)))
    assert tilt.max() > 1.0


def test_helices_of_freecad() -> None:
    operation = only("platteyz-pass-3-helix.nc")
    # 16 holes: ten half turns of radius 1.1, eight of them 0.5 deep, and a plunge of 3; chords
    # 0.05 mm beside so small a circle are 1 % shorter
    half = np.hypot(np.pi * 1.1, 0.5)
    expected = 16 * (8 * half + 2 * np.pi * 1.1 + 3)
    assert 1e3 * operation.lengths()[0] == pytest.approx(expected, rel=1.5e-2)


def test_splines_go_on_without_a_corner() -> None:
    p = places("nurbs.clsf")
    way = np.diff(p, axis=0)
    long = np.linalg.norm(way, axis=1) > 1e-6
    unit = way[long] / np.linalg.norm(way[long], axis=1)[:, None]
    turn = np.degrees(np.arccos(np.clip((unit[1:] * unit[:-1]).sum(axis=1), -1, 1)))
    # 22 passes there and back, two corners each; 70 splines join smoothly
    assert (turn > 60).sum() == 44
    assert (turn > 100).sum() == 0
