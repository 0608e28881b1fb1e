"""Parts of an MJCF that stand elsewhere: included files, default classes, limits of actuators."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import xml_root

Settings = dict[str, str]
Defaults = dict[str, dict[str, Settings]]
"""class -> tag -> attributes"""

ACTUATORS = ("motor", "position", "velocity", "intvelocity", "general", "pid", "dcmotor")
TAGS = ("joint", "geom", "site", "mesh", *ACTUATORS)
_OF_ALL = {"forcerange", "gear", "armature", "damping"}
"""attributes that the shortcuts for an actuator have in common"""
_DEEPEST = 10


def spliced(path: Path, root: ET.Element, folders: tuple[Path, ...] = ()) -> None:
    """Put the contents of included files where they are included.

    Args:
        path: of the file.
        root: its elements.
        folders: of the files that include it; the included one may be stated from the first, too.

    Raises:
        InputError: a file that is not there or no MJCF, or files that include each other.
    """
    if len(folders) > _DEEPEST:
        raise InputError(f"{path}: files include each other without an end")
    folders = (*folders, path.parent)
    for parent in list(root.iter()):
        for include in parent.findall("include"):
            name = include.get("file", "").replace("\\", "/")
            inner_path = next(
                (at / name for at in (folders[-1], folders[0]) if (at / name).is_file()), None
            )
            if inner_path is None:
                raise InputError(f"{path} includes {name!r}, which is not beside it: put it there")
            inner = xml_root(inner_path, "a part of an MJCF")
            spliced(inner_path, inner, folders)
            place = list(parent).index(include)
            parent.remove(include)
            for k, element in enumerate(inner):
                parent.insert(place + k, element)


def flies(body: ET.Element) -> bool:
    """Whether a body flies freely, or is moved by hand."""
    kinds = {joint.get("type") for joint in body.findall("joint")}
    free = body.find("freejoint") is not None or "free" in kinds
    return free or body.get("mocap") == "true"


def held(root: ET.Element) -> list[str]:
    """Take the freedom of what flies and carries joints, where no joint stands on a base: an arm on
    a vehicle or a trunk. Notes on what is held."""
    bodies = root.findall("worldbody/body")
    if any(body.find(".//joint") is not None for body in bodies if not flies(body)):
        return []
    notes = []
    for body in filter(flies, bodies):
        if body.find("body//joint") is None:
            continue
        for free in [*body.findall("freejoint"), *body.findall("joint")]:
            body.remove(free)
        body.attrib.pop("mocap", None)
        notes.append(
            f"body {body.get('name')} flies freely and carries the arm: it is held where the file "
            "shows it"
        )
    return notes


def defaults(root: ET.Element) -> Defaults:
    """What every default class says of joints and actuators, the classes around it included."""
    found: Defaults = {"main": {}}

    def walk(element: ET.Element, name: str, inherited: dict[str, Settings]) -> None:
        settings = {tag: dict(values) for tag, values in inherited.items()}
        for tag in TAGS:
            for own in element.findall(tag):
                settings.setdefault(tag, {}).update(own.attrib)
        # MuJoCo keeps one set for all actuators: what one shortcut says holds for the others
        for own in element:
            if own.tag in ACTUATORS:
                for tag in ACTUATORS:
                    settings.setdefault(tag, {}).update(
                        {k: v for k, v in own.attrib.items() if k in _OF_ALL}
                    )
        found[name] = settings
        for inner in element.findall("default"):
            walk(inner, inner.get("class", ""), settings)

    for top in root.findall("default"):
        walk(top, "main", found["main"])
        # under another name it is the one of all elements without a class, too
        found[top.get("class", "main")] = found["main"]
    return found


@dataclass(frozen=True)
class Drive:
    """What the actuators of a joint do to it beside moving it."""

    limit: float | None = None
    """largest torque, the range of a motor or `forcerange` times the gear, of all together [Nm]"""
    armature: float = 0.0
    """of the rotors, times the gear squared [kg m2]"""
    damping: float = 0.0
    """the same [Nm s/rad]"""


def drives(root: ET.Element, classes: Defaults) -> dict[str, Drive]:
    """What actuators do to joints, by the name of the joint.

    Raises:
        InputError: a range that is not two finite numbers, or a gear that is none.
    """
    found: dict[str, Drive] = {}
    for actuator in root.findall("actuator/*"):
        tag = str(actuator.tag)
        joint = actuator.get("joint", actuator.get("jointinparent"))
        if tag not in ACTUATORS or joint is None:
            continue
        settings = {
            **classes.get(actuator.get("class", "main"), {}).get(tag, {}),
            **actuator.attrib,
        }
        where = f"actuator of {joint}"
        gear = abs(first_number(where, settings.get("gear", "1")) or 0.0)
        before = found.get(joint, Drive())
        limit = gear * least_of(where, settings, "force", *["ctrl"] * (tag == "motor"))
        # several turn it together
        together = (before.limit or 0.0) + (limit if limit < np.inf else 0.0)
        found[joint] = Drive(
            together or None,
            before.armature + gear**2 * (first_number(where, settings.get("armature")) or 0.0),
            before.damping + gear**2 * (first_number(where, settings.get("damping")) or 0.0),
        )
    return found


def least_of(where: str, settings: Settings, *what: str) -> float:
    """The smallest end of ranges that are in force; endless where none is.

    Args:
        where: they stand, for the message.
        settings: of the element: `forcerange` and `forcelimited` of `force`, as for others.
        what: they limit.

    Raises:
        InputError: a range that is not two numbers.
    """
    ends = [np.inf]
    for name in what:
        text = settings.get(f"{name}range")
        # an infinite range is none
        if text and "inf" not in text and settings.get(f"{name}limited") != "false":
            ends += np.abs(stated_numbers(where, text, 2)).tolist()
    return min(ends)


def first_number(where: str, text: str | None) -> float | None:
    """The first number of an attribute, None where it is not stated.

    Args:
        where: it stands, for the message.
    """
    return None if text is None else float(stated_numbers(where, [*text.split(), ""][0], 1)[0])


def stated_numbers(where: str, text: str, count: int) -> Array:
    """The finite numbers of an attribute, shape (count,).

    Args:
        where: they stand, for the message.
        text: of the attribute.
        count: that there must be.

    Raises:
        InputError: another number of them, or words.
    """
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise InputError(f"{where}: found {text!r}, expected {count} finite numbers")
    return values
