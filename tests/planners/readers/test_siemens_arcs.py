"""The plane of an arc on a control of Siemens: that of the axes its end and centre state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners import read_program

ROOT = np.sqrt(2)


def arc(tmp_path: Path, block: str, suffix: str = ".mpf") -> Array:
    """Points from the start of the arc on [mm]; G17 holds, the start is (10, 0, 0)."""
    file = tmp_path / f"part{suffix}"
    file.write_text(f"G17 G21 G90\nG0 X0 Y0 Z9\nZ0\nG1 X10 F600\n{block}\nM30\n")
    return np.asarray(1e3 * read_program(file).operation().path.position[2:])


@pytest.mark.parametrize(
    ("block", "half_way", "end"),
    [
        # lead-ins of posts that write no G18, G19; G3 turns from Z to X and from Y to Z
        ("G2 X12 Z-2 I2 K0", (12 - ROOT, 0, -ROOT), (12, 0, -2)),
        ("G3 X12 Z2 I2 K0", (12 - ROOT, 0, ROOT), (12, 0, 2)),
        ("G2 Y2 Z2 J2 K0", (10, 2 - ROOT, ROOT), (10, 2, 2)),
        ("G3 X12 Z2 I=AC(12) K=AC(0)", (12 - ROOT, 0, ROOT), (12, 0, 2)),
        # half circles: both ends fit a circle in the plane of X and Y, too
        ("G2 X14 Z0 I2 K0", (12, 0, -2), (14, 0, 0)),
        ("G3 X14 Z0 CR=2", (12, 0, 2), (14, 0, 0)),
        # one letter of the centre
        ("G2 X14 Z0 I2", (12, 0, -2), (14, 0, 0)),
    ],
)
def test_the_plane_is_that_of_the_axes(
    tmp_path: Path, block: str, half_way: tuple[float, ...], end: tuple[float, ...]
) -> None:
    found = arc(tmp_path, block)
    assert np.allclose(found[-1], end)
    assert np.linalg.norm(found - half_way, axis=1).min() < 0.3
    across = 0 if "Y" in block else 1
    assert np.allclose(found[:, across], found[0, across])


@pytest.mark.parametrize(
    "block",
    ["G3 X12 Y2 Z-1 I2 J0", "G3 X10 Z-1 I2 J0", "G3 Z-1 I2 J0", "G3 X14 Z-1 I2"],
)
def test_a_helix_stays_in_the_plane_in_force(tmp_path: Path, block: str) -> None:
    found = arc(tmp_path, block)
    assert np.allclose(np.hypot(found[:, 0] - 12, found[:, 1]), 2, atol=1e-3)
    assert np.allclose(np.diff(found[:, 2]), (found[-1, 2] - found[0, 2]) / (len(found) - 1))
    assert found[-1, 2] == pytest.approx(-1)


def test_other_controls_keep_the_plane_in_force(tmp_path: Path) -> None:
    found = arc(tmp_path, "G2 X14 Z0 I2 J0", ".nc")
    assert np.allclose(found[:, 2], 0)
    assert found[:, 1].max() == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(
    "block", ["G3 I=AC(12) J=AC(0)", "G3 I2 J=AC(0)", "G3 I=AC(12) K=AC(0)", "G2 I=AC(12)"]
)
def test_a_full_circle_needs_its_centre_alone(tmp_path: Path, block: str) -> None:
    found = arc(tmp_path, block)
    assert np.allclose(found[-1], [10, 0, 0])
    assert np.allclose(np.linalg.norm(found - [12, 0, 0], axis=1), 2)
    assert np.linalg.norm(found - [14, 0, 0], axis=1).min() < 0.5
