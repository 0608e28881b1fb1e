"""An arm of the collection with shapes on its links, own text and meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
from robots.public_arms import arms, urdf

Array = npt.NDArray[np.float64]
SHAPES = {
    "base_link": '<box size="0.3 0.24 0.2"/>@0 0 0.1@0 0 0.2',
    "link_1": '<cylinder radius="0.09" length="0.26"/>@0 0 -0.03@0 0 0',
    "link_2": '<mesh filename="package://drawn_arm/meshes/upper.stl" scale="0.001 0.001 0.001"/>'
    "@0 0 0@0 0 0",
    "link_3": '<box size="0.2 0.12 0.14"/>@0.02 0 0.03@0 0.1 0',
    "link_4": '<cylinder radius="0.06" length="0.3"/>@0.27 0 0@0 1.5707963267948966 0',
    "link_5": '<sphere radius="0.05"/>@0 0 0@0 0 0',
    "link_6": '<mesh filename="meshes/flange.stl"/>@0.01 0 0@0 1.5707963267948966 0.3',
}


def upper() -> Array:
    """Corners of the upper arm [mm]: wide at the foot, bent to one side, shape (k, 3)."""
    corners = [
        (x * w, y * 70 + 20 * (z > 200), z)
        for z, w in ((-80.0, 80.0), (200.0, 60.0), (500.0, 75.0))
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    return np.array(corners)


def flange() -> Array:
    """Corners of a flange with a bracket [m], shape (k, 3)."""
    turn = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    rim = np.stack([0.04 * np.cos(turn), 0.04 * np.sin(turn)], axis=1)
    disc = [np.column_stack([rim, np.full(20, z)]) for z in (-0.01, 0.02)]
    return np.concatenate([*disc, [[0.1, 0.0, 0.05], [0.1, 0.02, 0.05]]])


def drawn_urdf(folder: Path, name: str = "irb1200", shapes: dict[str, str] | None = None) -> Path:
    """A URDF with shapes, in a package of its own with meshes.

    Args:
        folder: where the package is made.
        name: of the arm.
        shapes: by link, `shape@xyz@rpy`; default those above.
    """
    import trimesh

    package = folder / "drawn_arm"
    (package / "meshes").mkdir(parents=True, exist_ok=True)
    (package / "urdf").mkdir(exist_ok=True)
    for file, points in (("upper", upper()), ("flange", flange())):
        solid = trimesh.Trimesh(points).convex_hull
        solid.export(package / "meshes" / f"{file}.stl")
        solid.export(package / "meshes" / f"{file}.obj")
    text = urdf(arms()[name]).replace('<link name="base_link"/>', '<link name="base_link"></link>')
    for link, stated in (SHAPES if shapes is None else shapes).items():
        shape, xyz, rpy = stated.split("@")
        collision = (
            f'<collision><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{shape}</geometry></collision>'
        )
        text = text.replace(f'<link name="{link}">', f'<link name="{link}">{collision}')
    path = package / "urdf" / "arm.urdf"
    path.write_text(text)
    return path
