"""URDF in: the links, joints and shapes of a file, read with the parser of the standard library."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.geometry import Geometry
from irb2400_ctrl.robot.importing.mjcf_orientation import from_quaternion
from irb2400_ctrl.robot.importing.tree import COARSE, ROUNDED, Mass, Tree, TreeJoint, pose
from irb2400_ctrl.robot.importing.urdf_transmissions import Driven, gears, springs

KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
SOFT = ("soft_lower_limit", "soft_upper_limit")
INNER = ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic")
UNUSED = ("calibration", "safety_controller")
"""elements of a joint: those that are read once, and those that say nothing of its motion"""
NUMBERS = ("damping", "friction", "armature")
"""of `<dynamics>`; the last one is MuJoCo's and Genesis', not URDF's own"""
MOST_TURN = 7.0
"""angle of a frame above which it cannot be meant in radians"""


def read_urdf(path: Path, root: ET.Element) -> Tree:
    """The tree of a URDF.

    Raises:
        InputError: xacro that is not expanded, a missing attribute, a number that is none, an
            unknown type of joint, a link with two parents, angles in degrees.
    """
    if _is_xacro(root):
        raise InputError(
            f"{path} is xacro, not URDF: macros are not expanded yet; run "
            f"`xacro {path.name} > arm.urdf` and import that (without ROS: pip install xacrodoc, "
            f"then `xacrodoc {path.name} -d FOLDER_OF_PACKAGES -o arm.urdf`)"
        )
    for tag in ("link", "joint"):
        names = [_name(path, element, tag) for element in root.findall(tag)]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise InputError(f"{path}: {tag} {doubled[0]} is there {names.count(doubled[0])} times")
    links = {_name(path, link, "link"): _mass(path, link) for link in root.findall("link")}
    driven = Driven(gears(root), springs(root))
    joints = tuple(_joint(path, joint, driven) for joint in root.findall("joint"))
    for joint in joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                raise InputError(
                    f"{path}: joint {joint.name} names the link {link}, which is not in the file"
                )
        if joint.kind not in KINDS:
            raise InputError(
                f"{path}: joint {joint.name} is of type {joint.kind!r}, expected one of "
                f"{', '.join(KINDS)}"
            )
    _one_parent(path, joints)
    name = root.get("name") or path.stem
    rounded = _rounded_angles(root)
    notes = [f"quarter turns of few digits (1.5708) are read as exact ones: {rounded} rpy"]
    notes = [*notes[: min(rounded, 1)], *_coarse_angles(root), *_two_bodies(root)]
    source = f"imported from {path.name} (URDF)"
    shapes = {_name(path, link, "link"): _shapes(path, link) for link in root.findall("link")}
    return Tree(name, source, links, joints, notes=tuple(notes), shapes=shapes, drawn=True)


def _one_parent(path: Path, joints: tuple[TreeJoint, ...]) -> None:
    """Refuse a link that hangs on two joints: which of them carries it is not said."""
    carried: dict[str, str] = {}
    for joint in joints:
        other = carried.setdefault(joint.child, joint.name)
        if other != joint.name:
            raise InputError(
                f"{path}: link {joint.child} hangs on two joints, {other} and {joint.name}; "
                "expected a tree: take the joint out that only closes a loop"
            )


def _is_xacro(root: ET.Element) -> bool:
    """Whether something has to be expanded; a property that nothing asks for has not."""
    return any(
        ("xacro" in str(element.tag) and not str(element.tag).endswith("property"))
        or any("${" in v for v in element.attrib.values())
        for element in root.iter()
    )


def _joint(path: Path, element: ET.Element, driven: Driven) -> TreeJoint:
    """One joint.

    Args:
        path: of the file, for messages.
        element: its own.
        driven: what the rest of the file says of motors and springs.
    """
    name = _name(path, element, "joint")
    limit = element.find("limit")
    dynamics = element.find("dynamics")
    mimic = element.find("mimic")
    kind = element.get("type", "")
    axis = element.find("axis")
    where = f"{path}: joint {name}"
    gear = driven.gear(name)
    spring = driven.springs.get(name, (None, None))
    stiffness, rest = (None if text is None else _number(where, text) for text in spring)
    rotor = None if gear.rotor is None else gear.rotor * gear.ratio**2
    armature = _optional(where, dynamics, "armature")
    own = limit is not None and "acceleration" in limit.attrib
    faster = "acceleration" if own else "drake:acceleration"
    return TreeJoint(
        name=name,
        kind=kind,
        parent=_inner(where, element, "parent", "link"),
        child=_inner(where, element, "child", "link"),
        X=_origin(where, element.find("origin")),
        axis=np.array([1.0, 0.0, 0.0]) if axis is None else _vector(where, axis.get("xyz", ""), 3),
        range=None if kind == "continuous" else _range(where, limit),
        soft=_range(where, element.find("safety_controller"), *SOFT),
        speed=_limit(where, limit, "velocity"),
        effort=_limit(where, limit, "effort"),
        damping=_optional(where, dynamics, "damping"),
        dry=_optional(where, dynamics, "friction"),
        armature=rotor if armature is None else armature,
        gear=None if gear.ratio == 1.0 else gear.ratio,
        acceleration=_limit(where, limit, faster),
        stiffness=stiffness,
        rest=rest or 0.0,
        unread=_unread(element),
        mimics=None if mimic is None else mimic.get("joint"),
        multiplier=1.0 if (ratio := _optional(where, mimic, "multiplier")) is None else ratio,
        offset=_optional(where, mimic, "offset") or 0.0,
    )


def _unread(joint: ET.Element) -> tuple[str, ...]:
    """What stands in a joint where URDF knows nothing or one of its kind; a zero says nothing."""
    tags = [str(inner.tag) for inner in joint]
    strange = [f"<{tag}>" for tag in tags if tag not in INNER + UNUSED]
    second = [f"a second <{tag}>" for tag in INNER if tags.count(tag) > 1]
    dynamics = joint.find("dynamics")
    stated = {} if dynamics is None else dynamics.attrib
    odd = [key for key, text in stated.items() if key not in NUMBERS and text.strip("0. ")]
    found = [*strange, *second, *([f"{', '.join(odd)} of <dynamics>"] if odd else [])]
    return tuple(dict.fromkeys(found))


def _two_bodies(root: ET.Element) -> list[str]:
    """A note on every link with more than one body."""
    return [
        f"link {link.get('name')}: has several <inertial>, expected one: the first counts"
        for link in root.findall("link")
        if len(link.findall("inertial")) > 1
    ]


def _range(
    where: str, element: ET.Element | None, lower: str = "lower", upper: str = "upper"
) -> tuple[float, float] | None:
    """Both ends, zero where one is not stated; none where it states neither, or is endless.

    Args:
        where: it stands, for the message.
        element: that states it.
        lower, upper: its attributes.
    """
    stated = [key for key in (lower, upper) if element is not None and key in element.attrib]
    if not stated or None in [_limit(where, element, key) for key in stated]:
        return None
    return _limit(where, element, lower) or 0.0, _limit(where, element, upper) or 0.0


def _mass(path: Path, link: ET.Element) -> Mass | None:
    inertial = link.find("inertial")
    if inertial is None:
        return None
    where = f"{path}: link {link.get('name')}"
    mass = _number(where, _inner(where, inertial, "mass", "value"))
    X = _origin(where, inertial.find("origin"))
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    xx, xy, xz, yy, yz, zz = (
        _number(where, _inner(where, inertial, "inertia", key)) for key in keys
    )
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Mass(mass, np.zeros(3), tensor).seen_from(X)


def _shapes(path: Path, link: ET.Element) -> tuple[Geometry, ...]:
    """What the link collides with, or else looks like."""
    where = f"{path}: link {link.get('name')}"
    drawn = link.findall("collision") or link.findall("visual")
    found = []
    for element in drawn:
        X = _origin(where, element.find("origin"))
        found += [_geometry(where, shape, X) for shape in element.findall("geometry/*")]
    return tuple(found)


def _geometry(where: str, shape: ET.Element, X: Array) -> Geometry:
    kind = str(shape.tag)
    if kind == "mesh":
        scale = tuple(_vector(where, shape.get("scale", "1 1 1"), 3).tolist())
        return Geometry(kind, X, file=shape.get("filename", ""), scale=scale)
    if kind == "box":
        return Geometry(kind, X, tuple(_vector(where, _attribute(where, shape, "size"), 3)))
    keys = {"sphere": ("radius",), "cylinder": ("radius", "length")}
    keys["capsule"] = keys["cylinder"]
    return Geometry(
        kind, X, tuple(_number(where, _attribute(where, shape, key)) for key in keys.get(kind, ()))
    )


def _origin(where: str, element: ET.Element | None) -> Array:
    if element is None:
        return np.eye(4)
    xyz = _vector(where, element.get("xyz", "0 0 0"), 3)
    if "quat_xyzw" in element.attrib:
        xyzw = _vector(where, element.get("quat_xyzw", ""), 4)
        return pose(xyz, from_quaternion(np.roll(xyzw, 1)))
    rpy = _vector(where, element.get("rpy", "0 0 0"), 3)
    if np.abs(rpy).max() > MOST_TURN:
        raise InputError(
            f"{where}: found rpy={element.get('rpy')!r}, expected radians; this looks like degrees"
        )
    return pose(xyz, rotation_rpy(_quarters(rpy)))


def _quarters(rpy: Array) -> Array:
    """Angles with those that are a rounded quarter turn (1.5708, 3.1416) exact."""
    exact = np.round(rpy / (np.pi / 2)) * (np.pi / 2)
    return np.where(np.abs(rpy - exact) < ROUNDED, exact, rpy)


def _rounded_angles(root: ET.Element) -> int:
    """How many `rpy` hold a quarter turn that was written with few digits."""
    count = 0
    for origin in root.iter("origin"):
        rpy = _vector("origin", origin.get("rpy", "0 0 0"), 3)
        count += bool((np.abs(_quarters(rpy) - rpy) > 1e-9).any())
    return count


def _coarse_angles(root: ET.Element) -> list[str]:
    """A note where an `rpy` looks like a quarter turn, and is off by more than its rounding."""
    found = []
    for origin in root.iter("origin"):
        for word in origin.get("rpy", "").split():
            turns = round(float(word) / (np.pi / 2))
            off = abs(float(word) - turns * np.pi / 2)
            if turns and ROUNDED <= off < COARSE and word not in found:
                found.append(word)
    if not found:
        return []
    return [
        f"rpy {', '.join(found)}: read as {'it stands' if len(found) == 1 else 'they stand'}, up "
        "to 2 mrad off a quarter turn; if right angles are meant, write them as 1.5707963 and "
        "3.1415927"
    ]


def rotation_rpy(rpy: Array) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll), shape (3, 3)."""
    (cr, cp, cy) = np.cos(rpy)
    (sr, sp, sy) = np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _name(path: Path, element: ET.Element, what: str) -> str:
    name = element.get("name")
    if not name:
        raise InputError(f"{path}: a {what} has no name")
    return name


def _inner(where: str, element: ET.Element, tag: str, key: str) -> str:
    """An attribute of the element of this tag within another one.

    Args:
        where: it stands, for the message.
        element: that has the other one within it.
        tag: of that one.
        key: of the attribute.
    """
    value = None if (inner := element.find(tag)) is None else inner.get(key)
    if value is None:
        raise InputError(f'{where}: found no <{tag} {key}="…">, expected one')
    return value


def _attribute(where: str, element: ET.Element, key: str) -> str:
    if element.get(key) is None:
        raise InputError(f"{where}: found no {key}, expected one")
    return str(element.get(key))


def _optional(where: str, element: ET.Element | None, key: str) -> float | None:
    if element is None or element.get(key) is None:
        return None
    return _number(where, str(element.get(key)))


def _limit(where: str, element: ET.Element | None, key: str) -> float | None:
    """A limit; none where it is infinite, as simulators have it."""
    text = "" if element is None else element.get(key, "")
    endless = text.strip().lstrip("+-").lower() in {"inf", "infinity"}
    return None if endless else _optional(where, element, key)


def _number(where: str, text: str) -> float:
    return float(_vector(where, text, 1)[0])


def _vector(where: str, text: str, count: int) -> Array:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        wanted = "a finite number" if count == 1 else f"{count} finite numbers"
        raise InputError(f"{where}: found {text!r}, expected {wanted}")
    return np.array(values)
