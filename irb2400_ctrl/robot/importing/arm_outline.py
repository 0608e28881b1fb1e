"""The outline of an imported arm: what its file draws on the links; meshes as convex bodies around
them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.importing.few_corners import few_corners
from irb2400_ctrl.robot.importing.geometry import Geometry
from irb2400_ctrl.robot.importing.mesh_file import NOWHERE, MeshMissingError
from irb2400_ctrl.robot.outline import BASE, SPINDLE, TOOL, Outline, Part
from irb2400_ctrl.robot.shape import Hull, Solid

LARGE = 4.0
SMALL = 0.01
"""no shape of a link is larger, nor all of them smaller, measured by the distances between the
arm's axes"""
MOST = 6
"""shapes of a body that are kept as they are; more become one convex body"""


@dataclass(frozen=True)
class Drawn:
    """Shapes of one link of the file, and the body of the arm that this link is part of."""

    body: int
    """0 for the base, k for link k of the chain"""
    link: str
    X: Array
    """pose of the link's frame in that of the body, shape (4, 4)"""
    shapes: tuple[Geometry, ...]


def with_outline(
    robot: Robot, drawn: Sequence[Drawn], folders: Sequence[Path], notes: list[str]
) -> Robot:
    """The arm with its outline, where the file draws one; appends to `notes` what is not in it.

    Args:
        robot: the arm, without outline.
        drawn: what the file draws; nothing: the arm stays as it is.
        folders: where meshes are looked for.
        notes: for the user.
    """
    if not drawn:
        return robot
    names = [BASE, *(link.name for link in robot.links)]
    clash = sorted({BASE, SPINDLE, TOOL} & set(names[1:]))
    if clash:
        notes.append(f"a link is called {clash[0]}, which means something else in an outline: the "
                     "arm has none; rename the link")  # fmt: skip
        return robot
    shapes: list[list[Solid]] = [[] for _ in names]
    missing: dict[str, str] = {}
    reach = robot.reach
    for one in drawn:
        for shape in one.shapes:
            try:
                shapes[one.body].append(_on_the_arm(shape, one, folders, reach))
            except MeshMissingError as error:
                missing[one.link] = str(error.args[0])
            except InputError as error:
                notes.append(f"link {one.link}: a shape is left out of the outline, {error}")
    notes += _said_of_missing(missing)
    bare = [name for name, of_body in zip(names, shapes, strict=True) if not of_body]
    if len(bare) == len(names):
        notes.append("the file draws no shape that can be read: the arm has no outline, and what "
                     "it touches is not looked at")  # fmt: skip
        return robot
    largest = max([_size(solid) for of_body in shapes[1:] for solid in of_body], default=reach)
    if largest < SMALL * reach:
        notes.append(
            f"the shapes of the links are {1e3 * largest:.2g} mm large at most, on an arm of "
            f"{reach:.3g} m; is their scale right? The arm has no outline"
        )
        return robot
    parts = [
        Part.model_validate({"on": name, "shape": shape.model_dump()})
        for name, of_body in zip(names, shapes, strict=True)
        for shape in ([_joined(of_body)] if len(of_body) > MOST else of_body)
    ]
    source = f"{robot.source}: its shapes, meshes as convex bodies around them"
    if bare:
        notes.append(f"the outline has no shape for {', '.join(bare)}")
        source += f"; no shape for {', '.join(bare)}"
    return robot.model_copy(update={"outline": Outline(source=source, parts=tuple(parts))})


def _said_of_missing(missing: dict[str, str]) -> list[str]:
    """One note, however many links draw a mesh that is not there."""
    told = [f"mesh {name}: {NOWHERE}" for name in missing.values()]
    if len(missing) > 1:
        first = next(iter(missing.values()))
        told = [f"their meshes ({first}, …): {NOWHERE}"]
    links = ", ".join(missing)
    word = "links" if len(missing) > 1 else "link"
    return [f"{word} {links}: a shape is left out of the outline, {one}" for one in told]


def _on_the_arm(shape: Geometry, drawn: Drawn, folders: Sequence[Path], reach: float) -> Solid:
    """The shape, unless a link of an arm of this reach [m] cannot be so large.

    Args:
        shape: of the link.
        drawn: where it is.
        folders: where meshes are looked for.
        reach: distances between the arm's axes, one after another [m].
    """
    solid = shape.shape(drawn.X, folders)
    if drawn.body and _size(solid) > LARGE * reach > 0.0:
        raise InputError(
            f"{shape.file or shape.kind}: found it {_size(solid):.3g} m large on an arm of "
            f"{reach:.3g} m, expected metres; is its scale right?"
        )
    return solid


def _size(shape: Solid) -> float:
    """Longest edge of the box around it [m]."""
    return float(np.ptp(shape.corners(), axis=0).max())


def _joined(shapes: Sequence[Solid]) -> Hull:
    """One convex body around all of them."""
    corners = 1e3 * few_corners(np.concatenate([shape.corners() for shape in shapes]))
    return Hull.model_validate({"kind": "hull", "points_mm": np.round(corners, 1).tolist()})
