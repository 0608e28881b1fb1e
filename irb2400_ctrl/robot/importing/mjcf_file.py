"""MJCF in: bodies, hinges and inertials of a MuJoCo file, included files and defaults applied.

A body with several hinges becomes as many links, the first ones without mass. Of actuators the
limits are read; tendons and equalities are not: a coupling is stated at the import.
Bodies that fly freely (what an arm shall grasp) are left out.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.geometry import Geometry
from irb2400_ctrl.robot.importing.mjcf_geometry import geometry, mesh_assets
from irb2400_ctrl.robot.importing.mjcf_masses import Made, made_masses
from irb2400_ctrl.robot.importing.mjcf_orientation import orientation, turn
from irb2400_ctrl.robot.importing.mjcf_parts import (
    Defaults,
    Settings,
    defaults,
    spliced,
    stated_numbers,
    torque_limits,
)
from irb2400_ctrl.robot.importing.tree import Mass, Tree, TreeJoint, inverse, pose

NOT_READ = ("tendon", "equality")


def read_mjcf(path: Path, root: ET.Element) -> Tree:
    """The tree of an MJCF.

    Raises:
        InputError: an included file, a body without inertial, a joint that this library lacks.
    """
    spliced(path, root)
    worlds = root.findall("worldbody")
    if not worlds:
        raise InputError(f"{path}: found no <worldbody>, expected one with the arm's bodies")
    settings: Settings = {}
    for compiler in root.findall("compiler"):
        settings |= compiler.attrib
    unit = 1.0 if settings.get("angle") == "radian" else np.pi / 180
    classes = defaults(root)
    reader = _Reader(path, unit, settings.get("eulerseq", "xyz"), classes)
    reader.limits = torque_limits(root, classes)
    reader.meshes = mesh_assets(root, classes, settings)
    of_masses: list[str] = []
    reader.made = made_masses(path, root, settings, of_masses)
    for world in worlds:
        for body in world.findall("body"):
            reader.body(body, "world", "main")
        for tag in ("frame", "replicate", "attach"):
            if any(part.find(".//body") is not None or tag == "attach" for part in world.iter(tag)):
                raise InputError(
                    f"{path}: bodies inside <{tag}> are not read; save the file as MuJoCo "
                    "understands it (mj_saveLastXML) and import that"
                )
    if not reader.joints:
        raise InputError(
            f"{path}: found no body on a base"
            + "".join(f"; {name} flies freely" for name in reader.free[:1])
            + ", expected an arm"
        )
    notes = [f"<{tag}> is not read; state a coupling with --coupling" for tag in NOT_READ
             if root.find(tag) is not None]  # fmt: skip
    notes += of_masses
    notes += [f"body {name} flies freely: it is left out" for name in reader.free]
    light = [str(b.get("name")) for b in root.iter("body") if b.get("gravcomp", "0") != "0"]
    notes += [f"link {name}: its weight acts on the motors here (gravcomp)" for name in light]
    option = root.find("option")
    gravity = (0.0, 0.0, -9.81)
    if option is not None and option.get("gravity"):
        x, y, z = stated_numbers(str(path), str(option.get("gravity")), 3)
        gravity = (float(x), float(y), float(z))
    name = root.get("model") or path.stem
    return Tree(name, f"imported from {path.name} (MJCF)", reader.links, tuple(reader.joints),
                gravity, tuple(notes), reader.shapes, drawn=True)  # fmt: skip


@dataclass
class _Reader:
    """Goes through the bodies, from the world outwards."""

    path: Path
    unit: float
    """radians per unit of an angle"""
    eulers: str
    defaults: Defaults
    links: dict[str, Mass | None] = field(default_factory=lambda: {"world": None})
    joints: list[TreeJoint] = field(default_factory=list)
    limits: dict[str, float] = field(default_factory=dict)
    free: list[str] = field(default_factory=list)
    made: Made = field(default_factory=dict)
    meshes: dict[str, Geometry] = field(default_factory=dict)
    shapes: dict[str, tuple[Geometry, ...]] = field(default_factory=dict)

    def body(self, element: ET.Element, parent: str, around: str) -> None:
        """One body, its joints and what hangs on it."""
        name = element.get("name") or f"body_{len(self.links)}"
        kind = element.get("childclass", around)
        X = self._pose(element, name)
        hinges = element.findall("joint")
        if element.find("freejoint") is not None or "free" in {h.get("type") for h in hinges}:
            self.free.append(name)
            return
        here = np.eye(4)
        for k, hinge in enumerate(hinges):
            last = k == len(hinges) - 1
            child = name if last else f"{name}_{k + 1}"
            settings = self._settings(hinge, kind)
            # the child's frame stands in the point of the joint, and turns about it
            at = pose(stated_numbers(name, settings.get("pos", "0 0 0"), 3), np.eye(3))
            joint = self._joint(settings, parent, child, X @ at)
            self.joints.append(joint)
            if not last:
                self.links[child] = None
            parent = child
            # the file shows the arm with the joint at `ref`
            axis = stated_numbers(name, settings.get("axis", "0 0 1"), 3)
            ref = stated_numbers(name, settings.get("ref", "0"), 1)[0]
            X = pose(np.zeros(3), turn(axis, -self.unit * ref)) @ inverse(at)
            here = X
        if not hinges:
            self.joints.append(TreeJoint(f"{name}_mount", "fixed", parent, name, X, np.zeros(3)))
        self.links[name] = self._mass(element, name, here)
        self.shapes[name] = self._shapes(element, name, kind, here)
        self._sites(element, name, here)
        for inner in element.findall("body"):
            # the frame of the body, seen from the frame in its joint's point
            moved = f"{name}_frame"
            if moved not in self.links:
                self.links[moved] = None
                self.joints.append(TreeJoint(moved, "fixed", name, moved, here, np.zeros(3)))
            self.body(inner, moved, kind)

    def _settings(self, joint: ET.Element, kind: str) -> Settings:
        """Attributes of a joint, those of its class included.

        Raises:
            InputError: a class that is not in the file.
        """
        name = joint.get("class", kind)
        if name not in self.defaults:
            raise InputError(
                f"{self.path}: joint {joint.get('name')} is of class {name!r}, which the file does "
                "not define; import the file that includes this one"
            )
        return {**self.defaults[name].get("joint", {}), **joint.attrib}

    def _sites(self, element: ET.Element, name: str, here: Array) -> None:
        for site in element.findall("site"):
            label = site.get("name")
            if label and label not in self.links:
                self.links[label] = None
                X = here @ self._pose(site, label)
                self.joints.append(TreeJoint(f"{label}_site", "fixed", name, label, X, np.zeros(3)))

    def _joint(self, settings: Settings, parent: str, child: str, X: Array) -> TreeJoint:
        name = settings.get("name") or f"{child}_joint"
        kind = {"hinge": "revolute", "slide": "prismatic"}.get(settings.get("type", "hinge"))
        ends = settings.get("range")
        limited = settings.get("limited", "auto") != "false"
        force = settings.get("actuatorfrcrange")
        effort = self.limits.get(name)
        if force:
            effort = float(np.abs(stated_numbers(name, force, 2)).min())
        low, high = self.unit * stated_numbers(name, ends, 2) if ends and limited else (0.0, 0.0)
        return TreeJoint(
            name,
            kind or settings.get("type", ""),
            parent,
            child,
            X,
            stated_numbers(name, settings.get("axis", "0 0 1"), 3),
            range=(float(low), float(high)) if low < high else None,
            effort=effort,
            damping=_first(settings.get("damping")),
            dry=_first(settings.get("frictionloss")),
            armature=_first(settings.get("armature")),
            stiffness=_first(settings.get("stiffness")),
            rest=self.unit * (_first(settings.get("springref")) or 0.0),
        )

    def _mass(self, element: ET.Element, name: str, here: Array) -> Mass | None:
        if element in self.made:
            return self.made[element].seen_from(here)
        inertial = element.find("inertial")
        if inertial is None:
            return None
        mass = _first(inertial.get("mass")) or 0.0
        full = inertial.get("fullinertia")
        if full:
            xx, yy, zz, xy, xz, yz = stated_numbers(name, full, 6)
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            tensor = np.diag(stated_numbers(name, inertial.get("diaginertia", "0 0 0"), 3))
        return Mass(mass, np.zeros(3), tensor).seen_from(here @ self._pose(inertial, name))

    def _shapes(self, body: ET.Element, name: str, kind: str, here: Array) -> tuple[Geometry, ...]:
        """What the body collides with, or else looks like."""
        drawn = []
        for geom in body.findall("geom"):
            of_class = self.defaults.get(geom.get("class", kind), {}).get("geom", {})
            drawn.append({**of_class, **geom.attrib})
        solid = [
            keys
            for keys in drawn
            if keys.get("contype", "1") != "0" or keys.get("conaffinity", "1") != "0"
        ]
        numbers = partial(stated_numbers, f"{self.path}: geom of body {name}")
        return tuple(
            geometry(keys, here, numbers, partial(orientation, unit=self.unit,
                     eulerseq=self.eulers), self.meshes) for keys in solid or drawn
        )  # fmt: skip

    def _pose(self, element: ET.Element, name: str) -> Array:
        try:
            R = orientation(element.attrib, partial(stated_numbers, name), self.unit, self.eulers)
        except InputError as error:
            raise InputError(f"{self.path}: {name}: {error}") from error
        return pose(stated_numbers(name, element.get("pos", "0 0 0"), 3), R)


def _first(text: str | None) -> float | None:
    return None if text is None else float(stated_numbers("number", text.split()[0], 1)[0])
