"""MJCF in: bodies, hinges and inertials of a MuJoCo file, included files and defaults applied.

A body with several hinges becomes as many links, the first ones without mass. Of actuators the
limits are read; tendons and equalities are not: a coupling is stated at the import.
Bodies that fly freely (what an arm shall grasp) are left out; one that carries the arm is held.
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
from irb2400_ctrl.robot.importing.mjcf_frames import Frames
from irb2400_ctrl.robot.importing.mjcf_geometry import geometry, mesh_assets
from irb2400_ctrl.robot.importing.mjcf_masses import Made, made_masses
from irb2400_ctrl.robot.importing.mjcf_orientation import orientation, over, turn
from irb2400_ctrl.robot.importing.mjcf_parts import (
    Defaults,
    Drive,
    Settings,
    defaults,
    drives,
    first_number,
    flies,
    held,
    least_of,
    spliced,
    stated_numbers,
)
from irb2400_ctrl.robot.importing.tree import Mass, Tree, TreeJoint, inverse, pose, right_angled

NOT_READ = ("tendon", "equality")
SWITCHED = {
    "gravity": "the weight of every link",
    "damper": "damping",
    "spring": "stiffness",
    "frictionloss": "frictionloss",
}
"""flags of a simulation, and what they switch off"""


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
    reader.drives = drives(root, classes)
    reader.meshes = mesh_assets(root, classes, settings)
    of_masses: list[str] = []
    frames = Frames(path, classes, partial(orientation, unit=unit, eulerseq=reader.eulers))
    for world in worlds:
        frames.dissolve(world)
    reader.notes += held(root)
    reader.made, reader.shaped = made_masses(path, root, settings, of_masses)
    reader.bodies = {str(body.get("name")) for body in root.iter("body")}
    reader.hinges = {str(joint.get("name")) for joint in root.iter("joint")}
    for world in worlds:
        for body in world.findall("body"):
            reader.body(body, "world", "main")
    if not reader.joints:
        raise InputError(
            f"{path}: found no body on a base"
            + "".join(f"; {name} flies freely" for name in reader.free[:1])
            + ", expected an arm"
        )
    notes = [f"<{tag}> is not read; state a coupling with --coupling" for tag in NOT_READ
             if root.find(tag) is not None]  # fmt: skip
    notes += [*of_masses, *reader.notes]
    notes += [f"body {name} flies freely: it is left out" for name in reader.free]
    light = [
        str(body.get("name"))
        for body in root.iter("body")
        if first_number(f"{path}: gravcomp", body.get("gravcomp", "0"))
    ]
    notes += [f"link {name}: its weight acts on the motors here (gravcomp)" for name in light]
    gravity, of_options = _options(path, root)
    notes += of_options
    name = root.get("model") or path.stem
    return Tree(name, f"imported from {path.name} (MJCF)", reader.links, tuple(reader.joints),
                gravity, True, tuple(notes), reader.shapes, guessed=reader.guessed,
                drawn=True)  # fmt: skip


def _options(path: Path, root: ET.Element) -> tuple[tuple[float, float, float], list[str]]:
    """Gravity [m/s2], and what the file has its simulation leave out."""
    stated: Settings = {}
    for option in root.findall("option"):
        stated |= option.attrib
    x, y, z = stated_numbers(str(path), stated.get("gravity", "0 0 -9.81"), 3)
    flags: Settings = {}
    for flag in root.findall("option/flag"):
        flags |= flag.attrib
    notes = [
        f"<flag {key}={flags[key]!r}/> is a setting of the simulation: {what} acts here"
        for key, what in SWITCHED.items()
        if flags.get(key) == "disable"
    ]
    if not (x or y or z):
        notes.append(
            "gravity is 0 0 0 in the file: no link has weight here; the robot file's gravity_m_s2 "
            "says what it is where the arm stands"
        )
    return (float(x), float(y), float(z)), notes


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
    drives: dict[str, Drive] = field(default_factory=dict)
    bodies: set[str] = field(default_factory=set)
    """names that bodies have, those that were not reached yet included"""
    hinges: set[str] = field(default_factory=set)
    """the same of joints, and those that were made up"""
    notes: list[str] = field(default_factory=list)
    free: list[str] = field(default_factory=list)
    made: Made = field(default_factory=dict)
    shaped: dict[ET.Element, InputError | None] = field(default_factory=dict)
    guessed: dict[str, InputError | None] = field(default_factory=dict)
    """links whose mass data are those of their shapes, or why there are none"""
    meshes: dict[str, Geometry] = field(default_factory=dict)
    shapes: dict[str, tuple[Geometry, ...]] = field(default_factory=dict)

    def body(self, element: ET.Element, parent: str, around: str) -> None:
        """One body, its joints and what hangs on it."""
        name = element.get("name") or self._link(f"body_{len(self.links)}")
        kind = element.get("childclass", around)
        X = self._frame(element.attrib, name)
        hinges = element.findall("joint")
        if flies(element):
            self.free.append(name)
            return
        here = np.eye(4)
        for k, hinge in enumerate(hinges):
            last = k == len(hinges) - 1
            child = name if last else self._link(f"{name}_{k + 1}")
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
            self._fix(f"{name}_mount", parent, name, X)
        self.links[name] = self._mass(element, name, here)
        self.shapes[name] = self._shapes(element, name, kind, here)
        self._sites(element, name, kind, here)
        inside = element.findall("body")
        moved = name
        if inside and not np.array_equal(here, np.eye(4)):
            # the frame of the body, seen from the frame in its joint's point
            moved = self._link(f"{name}_frame")
            self.links[moved] = None
            self._fix(moved, name, moved, here)
        for inner in inside:
            self.body(inner, moved, kind)

    def _link(self, name: str) -> str:
        """A name like this that no body and no link has."""
        return _new(name, self.bodies | set(self.links))

    def _fix(self, name: str, parent: str, child: str, X: Array) -> None:
        """A fixed joint of a name that no joint has."""
        name = _new(name, self.hinges)
        self.hinges.add(name)
        self.joints.append(TreeJoint(name, "fixed", parent, child, X, np.zeros(3)))

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

    def _sites(self, element: ET.Element, name: str, kind: str, here: Array) -> None:
        for site in element.findall("site"):
            label = site.get("name")
            if label and label not in self.links and label not in self.bodies:
                self.links[label] = None
                of_class = self.defaults.get(site.get("class", kind), {}).get("site", {})
                X = here @ self._frame(over(of_class, site.attrib), label)
                self._fix(f"{label}_site", name, label, X)

    def _joint(self, settings: Settings, parent: str, child: str, X: Array) -> TreeJoint:
        name = settings.get("name") or _new(f"{child}_joint", self.hinges)
        self.hinges.add(name)
        self.notes += _left_out(name, settings)
        drive = self.drives.get(name, Drive())
        kind = {"hinge": "revolute", "slide": "prismatic"}.get(settings.get("type", "hinge"))
        ends = settings.get("range")
        limited = settings.get("limited", "auto") != "false"
        effort = least_of(name, settings, "actuatorfrc")
        if drive.limit is not None:
            effort = min(effort, drive.limit)
        low, high = self.unit * stated_numbers(name, ends, 2) if ends and limited else (0.0, 0.0)
        number = {
            key: first_number(name, settings.get(key))
            for key in ("damping", "frictionloss", "armature", "stiffness", "springref")
        }
        return TreeJoint(
            name,
            kind or settings.get("type", ""),
            parent,
            child,
            X,
            stated_numbers(name, settings.get("axis", "0 0 1"), 3),
            range=(float(low), float(high)) if low < high else None,
            effort=effort if effort < np.inf else None,
            damping=(number["damping"] or 0.0) + drive.damping or None,
            dry=number["frictionloss"],
            armature=(number["armature"] or 0.0) + drive.armature or None,
            stiffness=number["stiffness"],
            rest=self.unit * (number["springref"] or 0.0),
        )

    def _mass(self, element: ET.Element, name: str, here: Array) -> Mass | None:
        if element in self.shaped:
            self.guessed[name] = self.shaped[element]
        if element in self.made:
            return self.made[element].seen_from(here)
        inertial = element.find("inertial")
        if inertial is None:
            return None
        mass = first_number(name, inertial.get("mass")) or 0.0
        full = inertial.get("fullinertia")
        if full:
            xx, yy, zz, xy, xz, yz = stated_numbers(name, full, 6)
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            tensor = np.diag(stated_numbers(name, inertial.get("diaginertia", "0 0 0"), 3))
        return Mass(mass, np.zeros(3), tensor).seen_from(here @ self._pose(inertial.attrib, name))

    def _shapes(self, body: ET.Element, name: str, kind: str, here: Array) -> tuple[Geometry, ...]:
        """What the body collides with, or else looks like."""
        drawn = []
        for geom in body.findall("geom"):
            of_class = self.defaults.get(geom.get("class", kind), {}).get("geom", {})
            drawn.append(over(of_class, geom.attrib))
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

    def _frame(self, keys: Settings, name: str) -> Array:
        """Pose of a link, its right angles exact."""
        X = self._pose(keys, name)
        X[:3, :3], notes = right_angled(X[:3, :3], name)
        self.notes += notes
        return X

    def _pose(self, keys: Settings, name: str) -> Array:
        try:
            R = orientation(keys, partial(stated_numbers, name), self.unit, self.eulers)
        except InputError as error:
            raise InputError(f"{self.path}: {name}: {error}") from error
        return pose(stated_numbers(name, keys.get("pos", "0 0 0"), 3), R)


def _left_out(name: str, settings: Settings) -> list[str]:
    """What a joint states and this library has no place for."""
    notes = []
    for key in ("damping", "stiffness"):
        words = settings.get(key, "").split()
        if len(words) > 1 and any(stated_numbers(name, " ".join(words), len(words))[1:]):
            notes.append(
                f"joint {name}: of {key} the first number is read, the one of the linear term"
            )
    springdamper = settings.get("springdamper", "0 0")
    if all(stated_numbers(name, springdamper, 2) > 0):
        notes.append(
            f"joint {name}: springdamper is not read: neither its stiffness nor its damping acts "
            "here; save the file as MuJoCo understands it (mj_saveLastXML) and import that"
        )
    return notes


def _new(name: str, taken: set[str]) -> str:
    """The name, lengthened until nothing has it."""
    while name in taken:
        name += "_"
    return name
