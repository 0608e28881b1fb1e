"""An arm in its cell as MuJoCo sees it, read from the two files without the library."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]
SLAB = 20.0
"""half the size of the floor [m]"""


@dataclass(frozen=True)
class MujocoCell:
    """Contacts of an arm with itself and with its cell; neighbours and what the file keeps apart
    are left out."""

    model: Any
    A: Array
    offset: Array
    cutting: tuple[frozenset[str], frozenset[str]]
    """names of the geoms that cut, and of those that may be cut"""

    def deepest(self, q: Array, at_feed: bool = False) -> tuple[float, tuple[str, str]]:
        """Most negative contact distance at q (n,) [m], and between which geoms; inf without any.
        At feed, what cuts may touch what may be cut."""
        data = mujoco.MjData(self.model)
        data.qpos[:] = self.A @ q + self.offset
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_collision(self.model, data)
        worst: tuple[float, tuple[str, str]] = (np.inf, ("", ""))
        for distance, pair in zip(data.contact.dist, data.contact.geom, strict=True):
            first, other = (self.model.geom(k).name for k in pair)
            cuts = {first, other} & self.cutting[0] and {first, other} & self.cutting[1]
            if not (at_feed and cuts):
                worst = min(worst, (float(distance), (first, other)))
        return worst


def mujoco_cell(robot_file: Path, cell: dict[str, Any] | None = None) -> MujocoCell:
    """The arm of a robot file with modified DH frames, in a cell of primitives.

    Args:
        robot_file: TOML.
        cell: the tables of a cell file; meshes must have been replaced by convex primitives.
    """
    robot = tomllib.loads(robot_file.read_text())
    root = Element("mujoco")
    SubElement(root, "compiler", angle="radian")
    SubElement(root, "option", gravity="0 0 0")
    world = SubElement(root, "worldbody")
    base = SubElement(world, "body", name="base")
    bodies = {"base": base}
    above = base
    for number, link in enumerate(robot["links"]):
        above = SubElement(above, "body", name=link["name"], **_place(_frame(link["frame"])))
        SubElement(above, "joint", name=f"joint_{number}", type="hinge", axis="0 0 1")
        SubElement(above, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
        bodies[link["name"]] = above
    X = _frame(robot["flange"]) @ np.array(robot["tool"]["tcp"]["transform"])
    for name in ("spindle", "tool"):
        bodies[name] = SubElement(above, "body", name=name, **_place(X))
    for number, part in enumerate(robot["outline"]["parts"]):
        _geom(bodies[part["on"]], f"{part['on']} {number}", part["shape"], np.eye(4))
    if cell is not None:
        _surroundings(world, cell)
    _excluded(root, robot)
    model = mujoco.MjModel.from_xml_string(tostring(root, encoding="unicode"))
    A = np.array(robot["coupling"]["matrix"], dtype=float)
    parts = enumerate(robot["outline"]["parts"])
    cuts = frozenset(f"{p['on']} {k}" for k, p in parts if p["shape"].get("cuts"))
    things = [] if cell is None else cell.get("things", [])
    cut = frozenset(
        f"{thing['name']} {k}"
        for thing in things
        if thing["role"] in {"part", "stock"}
        for k in range(len(thing["shapes"]))
    )
    return MujocoCell(model, A, np.array(robot["coupling"]["offset_rad"]), (cuts, cut))


def _surroundings(world: Element, cell: dict[str, Any]) -> None:
    body = SubElement(world, "body", name="cell")
    X_BW = np.eye(4)
    if "work_object" in cell:
        X_BW = _pose(cell["work_object"]["place_mm"], cell["work_object"].get("turn_deg"))
    for thing in cell.get("things", []):
        X = X_BW if thing.get("frame") == "work_object" else np.eye(4)
        for number, shape in enumerate(thing["shapes"]):
            _geom(body, f"{thing['name']} {number}", shape, X)
    if "floor_mm" in cell:
        z = cell["floor_mm"] / 1e3
        size = f"{SLAB} {SLAB} 0.5"
        SubElement(body, "geom", name="floor", type="box", size=size, pos=f"0 0 {z - 0.5}")


def _excluded(root: Element, robot: dict[str, Any]) -> None:
    """What is not compared: neighbours in the chain, pairs that are kept apart, the standing."""
    contact = SubElement(root, "contact")
    chain = ["base", *(link["name"] for link in robot["links"])]
    links = {name: i for i, name in enumerate(chain)}
    links |= {"spindle": len(chain) - 1, "tool": len(chain) - 1}
    apart = {frozenset(pair["bodies"]) for pair in robot["outline"].get("kept_apart", [])}
    names = list(links)
    for i, first in enumerate(names):
        for other in names[i + 1 :]:
            near = abs(links[first] - links[other]) <= 1
            if near or frozenset((first, other)) in apart:
                SubElement(contact, "exclude", body1=first, body2=other)


def _geom(body: Element, name: str, shape: dict[str, Any], X: Array) -> None:
    kind = shape["kind"]
    if kind in {"capsule", "cylinder"}:
        ends = np.array([shape["from_mm"], shape["to_mm"]]) / 1e3
        ends = ends @ X[:3, :3].T + X[:3, 3]
        SubElement(
            body, "geom", name=name, type=kind, size=_text([shape["radius_mm"] / 1e3]),
            fromto=_text(ends.ravel()),
        )  # fmt: skip
        return
    place = X @ _pose(shape.get("centre_mm", [0, 0, 0]), shape.get("turn_deg"))
    size = [shape["radius_mm"] / 1e3] if kind == "sphere" else np.array(shape["size_mm"]) / 2e3
    SubElement(body, "geom", name=name, type=kind, size=_text(size), **_place(place))


def _frame(table: dict[str, float]) -> Array:
    """Modified Denavit-Hartenberg without the joint's turn."""
    X = np.eye(4)
    X[:3, :3] = Rotation.from_euler("x", table["alpha_rad"]).as_matrix()
    X[:3, 3] = [table["a_m"], 0, 0] + X[:3, :3] @ [0, 0, table["d_m"]]
    return X


def _pose(place_mm: list[float], turn_deg: list[float] | None) -> Array:
    X = np.eye(4)
    X[:3, :3] = Rotation.from_euler("xyz", turn_deg or [0, 0, 0], degrees=True).as_matrix()
    X[:3, 3] = np.array(place_mm) / 1e3
    return X


def _place(X: Array) -> dict[str, str]:
    x, y, z, w = Rotation.from_matrix(X[:3, :3]).as_quat()
    return {"pos": _text(X[:3, 3]), "quat": _text([w, x, y, z])}


def _text(values: Any) -> str:
    return " ".join(f"{value:.15g}" for value in values)
