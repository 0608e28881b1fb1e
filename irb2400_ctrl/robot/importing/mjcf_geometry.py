"""Shapes of MJCF: geoms with what their classes say, and the meshes that they name."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.robot.importing.geometry import Geometry
from irb2400_ctrl.robot.importing.mjcf_orientation import Numbers
from irb2400_ctrl.robot.importing.mjcf_parts import Defaults, Settings
from irb2400_ctrl.robot.importing.tree import pose
from irb2400_ctrl.robot.shape import frame_along

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}


def mesh_assets(root: ET.Element, classes: Defaults, settings: Settings) -> dict[str, Geometry]:
    """The meshes of `<asset>` by name, each in its own frame."""
    folder = settings.get("meshdir") or settings.get("assetdir") or ""
    found = {}
    for mesh in root.findall("asset/mesh"):
        keys = {**classes.get(mesh.get("class", "main"), {}).get("mesh", {}), **mesh.attrib}
        file = keys.get("file", "")
        name = keys.get("name") or file.rsplit("/", 1)[-1].rsplit(".", 1)[0]
        scale = tuple(_floats(keys.get("scale", "1 1 1")))
        path = f"{folder.rstrip('/')}/{file}" if folder and file else file
        corners = _floats(keys.get("vertex", ""))
        if "refpos" in keys or "refquat" in keys or len(scale) != 3 or len(corners) % 3:
            found[name] = Geometry("mesh with refpos or refquat", np.eye(4))
        elif corners:
            points = np.array(corners).reshape(-1, 3)
            found[name] = Geometry("points", np.eye(4), points=points, scale=scale)
        else:
            found[name] = Geometry("mesh", np.eye(4), file=path, scale=scale)
    return found


def geometry(
    keys: Mapping[str, str],
    here: Array,
    numbers: Numbers,
    turned: Callable[[Mapping[str, str], Numbers], Array],
    meshes: Mapping[str, Geometry],
) -> Geometry:
    """One geom.

    Args:
        keys: its attributes, those of its class included.
        here: pose of the body's frame in that of the link, shape (4, 4).
        numbers: reads them.
        turned: reads its orientation.
        meshes: of the file.

    Raises:
        InputError: numbers that are none.
    """
    kind = keys.get("type", "sphere")
    X = here @ pose(numbers(keys.get("pos", "0 0 0"), 3), turned(keys, numbers))
    if kind == "mesh":
        mesh = meshes.get(keys.get("mesh", ""))
        if mesh is None:
            return Geometry(f"mesh {keys.get('mesh')!r} that the file does not define", X)
        return Geometry(mesh.kind, X, points=mesh.points, file=mesh.file, scale=mesh.scale)
    if kind not in _SIZES or "mesh" in keys:
        return Geometry(f"{kind} around a mesh" if "mesh" in keys else kind, X)
    size = _floats(keys.get("size", ""))
    length = 0.0
    if "fromto" in keys:
        ends = numbers(keys["fromto"], 6).reshape(2, 3)
        way = ends[1] - ends[0]
        length = float(np.linalg.norm(way))
        R = frame_along(way) if length > 0 else np.eye(3)
        X = here @ pose(ends.mean(axis=0), R)
        # one number says how thick it is across
        size = [size[0], size[0], length / 2] if kind in {"box", "ellipsoid"} and size else size
        size = [size[0], length / 2] if kind in {"capsule", "cylinder"} and size else size
    size = size[: _SIZES[kind]]
    if len(size) < _SIZES[kind]:
        return Geometry(kind, X, tuple(size))
    if kind in {"capsule", "cylinder"}:
        return Geometry(kind, X, (size[0], 2 * size[1]))
    return Geometry(kind, X, tuple(2 * s for s in size) if kind == "box" else tuple(size))


def _floats(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        return []
