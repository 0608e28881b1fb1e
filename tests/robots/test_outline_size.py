"""Shapes of links that are much larger, or all much smaller, than their arm."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf

from irb2400_ctrl.robot.importing import Imported, import_robot

BOX = '<collision><geometry><box size="{0} 0.1 0.1"/></geometry></collision></link>'


def drawn(folder: Path, sizes: list[float]) -> Imported:
    """An arm that reaches 1.2 m whose links 1, 2, … are boxes of these lengths."""
    text = urdf(arms()["irb1200"])
    for k, size in enumerate(sizes, 1):
        text = re.sub(rf'(<link name="link_{k}">.*?)</link>', rf"\1{BOX.format(size)}", text)
    path = folder / "arm.urdf"
    path.write_text(text)
    return import_robot(path)


def test_a_link_larger_than_the_arm_is_left_out(tmp_path: Path) -> None:
    """Half a metre read as inches, or 12 mm as metres: everything overlapped by construction."""
    found = drawn(tmp_path, [0.3, 12.0, 0.2])
    assert found.robot.outline is not None
    assert {part.on for part in found.robot.outline.parts} == {"link_1", "link_3"}
    (said,) = [note for note in found.notes if "is its scale right" in note]
    assert said.startswith("link link_2: a shape is left out of the outline, box: found it 12 m")
    long = drawn(tmp_path, [0.3, 2.0])
    assert not any("scale" in note for note in long.notes)


def test_an_outline_of_specks_is_none(tmp_path: Path) -> None:
    """Metres scaled as millimetres: nothing would ever be touched."""
    pytest.importorskip("trimesh")
    mesh = '<collision><geometry><mesh filename="a.obj" scale="{0} {0} {0}"/></geometry>'
    corners = np.array(np.meshgrid(*[[0, 0.2]] * 3)).reshape(3, -1).T
    faces = (
        "1 2 3",
        "2 4 3",
        "5 7 6",
        "6 7 8",
        "1 5 2",
        "2 5 6",
        "3 4 7",
        "4 8 7",
        "1 3 5",
        "3 7 5",
    )
    (tmp_path / "a.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {f}\n" for f in faces)
    )
    text = urdf(arms()["irb1200"])
    for scale, large in ((1.0, True), (1e-3, False)):
        path = tmp_path / "arm.urdf"
        path.write_text(text.replace("</link>", f"{mesh.format(scale)}</collision></link>"))
        found = import_robot(path)
        assert (found.robot.outline is not None) == large
        assert any("mm large at most, on an arm of" in note for note in found.notes) != large
