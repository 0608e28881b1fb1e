"""MJCF in: bodies, hinges and inertials of a MuJoCo file, defaults applied; no other elements.

A body with several hinges becomes as many links, the first ones without mass. Geometry, tendons,
equalities and actuators other than `motor` limits are not read: a coupling is stated at the import.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.mjcf_orientation import orientation
from irb2400_ctrl.robot.importing.tree import Mass, Tree, TreeJoint, inverse, pose

Settings = dict[str, str]

NOT_READ = ("tendon", "equality")


def read_mjcf(path: Path, root: ET.Element) -> Tree:
    """The tree of an MJCF.

    Raises:
        InputError: an included file, a body without inertial, a joint that this library lacks.
    """
    if root.find(".//include") is not None:
        raise InputError(
            f"{path} includes other files; save it as one (mujoco: mj_saveLastXML) and import that"
        )
    world = root.find("worldbody")
    if world is None:
        raise InputError(f"{path}: found no <worldbody>, expected one with the arm's bodies")
    compiler = root.find("compiler")
    radians = compiler is not None and compiler.get("angle") == "radian"
    eulers = "xyz" if compiler is None else compiler.get("eulerseq", "xyz")
    reader = _Reader(path, 1.0 if radians else np.pi / 180, eulers, _defaults(root))
    reader.motors(root)
    for body in world.findall("body"):
        reader.body(body, "world", "main")
    notes = [f"<{tag}> is not read; state a coupling with --coupling" for tag in NOT_READ
             if root.find(tag) is not None]  # fmt: skip
    option = root.find("option")
    gravity = (0.0, 0.0, -9.81)
    if option is not None and option.get("gravity"):
        x, y, z = _numbers(str(path), str(option.get("gravity")), 3)
        gravity = (float(x), float(y), float(z))
    name = root.get("model") or path.stem
    return Tree(name, f"imported from {path.name} (MJCF)", reader.links, tuple(reader.joints),
                gravity, tuple(notes))  # fmt: skip


def _defaults(root: ET.Element) -> dict[str, Settings]:
    """Attributes of <joint> of every default class, those of the classes around it included."""
    found: dict[str, Settings] = {"main": {}}

    def walk(element: ET.Element, name: str, inherited: Settings) -> None:
        joint = element.find("joint")
        settings = {**inherited, **({} if joint is None else joint.attrib)}
        found[name] = settings
        for inner in element.findall("default"):
            walk(inner, inner.get("class", ""), settings)

    for top in root.findall("default"):
        walk(top, top.get("class", "main"), found["main"])
    return found


@dataclass
class _Reader:
    """Goes through the bodies, from the world outwards."""

    path: Path
    unit: float
    """radians per unit of an angle"""
    eulers: str
    defaults: dict[str, Settings]
    links: dict[str, Mass | None] = field(default_factory=lambda: {"world": None})
    joints: list[TreeJoint] = field(default_factory=list)
    limits: dict[str, float] = field(default_factory=dict)

    def motors(self, root: ET.Element) -> None:
        """Torque limits of motors on joints."""
        for motor in root.findall("actuator/motor"):
            ends = motor.get("forcerange") or motor.get("ctrlrange")
            joint = motor.get("joint")
            if joint and ends:
                gear = float((motor.get("gear") or "1").split()[0])
                self.limits[joint] = float(np.abs(_numbers(joint, ends, 2)).min()) * abs(gear)

    def body(self, element: ET.Element, parent: str, around: str) -> None:
        """One body, its joints and what hangs on it."""
        name = element.get("name") or f"body_{len(self.links)}"
        kind = element.get("childclass", around)
        X = self._pose(element, name)
        hinges = element.findall("joint")
        if element.find("freejoint") is not None:
            raise InputError(f"{self.path}: body {name} flies freely; expected an arm on a base")
        here = np.eye(4)
        for k, hinge in enumerate(hinges):
            last = k == len(hinges) - 1
            child = name if last else f"{name}_{k + 1}"
            settings = {**self.defaults.get(hinge.get("class", kind), {}), **hinge.attrib}
            # the child's frame stands in the point of the joint, and turns about it
            at = pose(_numbers(name, settings.get("pos", "0 0 0"), 3), np.eye(3))
            joint = self._joint(settings, parent, child, X @ at)
            self.joints.append(joint)
            if not last:
                self.links[child] = None
            parent = child
            X = inverse(at)
            here = X
        if not hinges:
            self.joints.append(TreeJoint(f"{name}_mount", "fixed", parent, name, X, np.zeros(3)))
        self.links[name] = self._mass(element, name, here)
        self._sites(element, name, here)
        for inner in element.findall("body"):
            # the frame of the body, seen from the frame in its joint's point
            moved = f"{name}_frame"
            if moved not in self.links:
                self.links[moved] = None
                self.joints.append(TreeJoint(moved, "fixed", name, moved, here, np.zeros(3)))
            self.body(inner, moved, kind)

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
            effort = float(np.abs(_numbers(name, force, 2)).min())
        low, high = self.unit * _numbers(name, ends, 2) if ends and limited else (0.0, 0.0)
        return TreeJoint(
            name,
            kind or settings.get("type", ""),
            parent,
            child,
            X,
            _numbers(name, settings.get("axis", "0 0 1"), 3),
            range=(float(low), float(high)) if low < high else None,
            effort=effort,
            damping=_first(settings.get("damping")),
            dry=_first(settings.get("frictionloss")),
            armature=_first(settings.get("armature")),
        )

    def _mass(self, element: ET.Element, name: str, here: Array) -> Mass | None:
        inertial = element.find("inertial")
        if inertial is None:
            if element.find("geom") is not None:
                raise InputError(
                    f"{self.path}: body {name} has geometry but no <inertial>; mass data from "
                    "shapes are not read, write them out (mujoco: mj_saveLastXML)"
                )
            return None
        mass = _first(inertial.get("mass")) or 0.0
        full = inertial.get("fullinertia")
        if full:
            xx, yy, zz, xy, xz, yz = _numbers(name, full, 6)
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            tensor = np.diag(_numbers(name, inertial.get("diaginertia", "0 0 0"), 3))
        return Mass(mass, np.zeros(3), tensor).seen_from(here @ self._pose(inertial, name))

    def _pose(self, element: ET.Element, name: str) -> Array:
        try:
            R = orientation(element.attrib, partial(_numbers, name), self.unit, self.eulers)
        except InputError as error:
            raise InputError(f"{self.path}: {name}: {error}") from error
        return pose(_numbers(name, element.get("pos", "0 0 0"), 3), R)


def _first(text: str | None) -> float | None:
    return None if text is None else float(_numbers("number", text.split()[0], 1)[0])


def _numbers(where: str, text: str, count: int) -> Array:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise InputError(f"{where}: found {text!r}, expected {count} finite numbers")
    return values
