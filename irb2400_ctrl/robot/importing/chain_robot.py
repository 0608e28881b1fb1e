"""One chain of a tree becomes a `Robot`: fixed joints folded, every joint axis turned to z."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import ValidationError

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.importing.arm_outline import Drawn, with_outline
from irb2400_ctrl.robot.importing.joint_tables import joint_table
from irb2400_ctrl.robot.importing.mimic_joints import Driven, driven
from irb2400_ctrl.robot.importing.tree import (
    TURNING,
    Mass,
    Tree,
    TreeJoint,
    inverse,
    pose,
    rotation_to,
)
from irb2400_ctrl.robot.importing.which_joints import (
    end_of_arm,
    frames_beyond,
    left_out,
    stood_still,
    turning_only,
)

DRAWN = {"mass_relative": 0.06, "com_m": 0.015, "inertia_relative": 0.15}
"""one standard deviation of bodies that somebody drew: three times those of a data sheet"""
_OF_ONE = re.compile(r"(?P<what>joint|link) (?P<name>[^ :]+)(?P<says>: .*)")


@dataclass(frozen=True)
class Imported:
    """The robot, and what a reader of the file it came from should know."""

    robot: Robot
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Payload:
    """A load on the flange: mass [kg], centre of mass in the flange frame [m]."""

    mass: float
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass
class _Collected:
    """Links of the chain so far: frame in the one before, and everything fixed to it."""

    frames: list[Array]
    masses: list[Mass]
    joints: list[TreeJoint]
    drawn: list[Drawn]
    X: Array
    """the link last looked at, in the frame of the last joint, shape (4, 4)"""


WEIGHTLESS = (
    "no link has mass: plans keep speeds alone, and what needs torques (diagnose, control) needs it"
)


def chain_robot(
    tree: Tree,
    *,
    base: str | None = None,
    tip: str | None = None,
    coupling: tuple[tuple[int, int, float], ...] = (),
    payload: Payload | None = None,
    outline: bool = True,
) -> Imported:
    """The robot of the chain from `base` to `tip`.

    Args:
        tree: the file.
        base, tip: links; default the root, and the end of the longest chain.
        coupling: (i, j, factor): theta_i = q_i + factor q_j; a parallelogram on axis 3 is (3, 2,
            -1).
        payload: on the flange.
        outline: with the space that the arm takes up, where the file draws it.

    Raises:
        InputError: a chain that is none, a joint that slides or follows another.
    """
    notes = list(tree.notes)
    base = base or tree.root()
    end = tip or end_of_arm(tree, base)
    path = stood_still(tree.path(base, end), notes)
    path, followers = driven(tree, turning_only(tree, path), notes)
    notes += [f"chain from {base} to {end}", *([] if tip else frames_beyond(tree, end))]
    chain = _Collected([], [], [], [], np.eye(4))
    on_path = {joint.name for joint in path}
    _gather(tree, base, np.eye(4), on_path, chain, notes)
    for joint in path:
        _step(tree, joint, chain, on_path, notes)
    if not chain.joints:
        where = "joint that turns" if base == end else f"joint that turns between {base} and {end}"
        raise InputError(f"{tree.name}: found no {where}, expected those of an arm")
    tables = [joint_table(joint, notes) for joint in chain.joints]
    notes += _one_limit([t["limits"].get("torque_Nm") for t in tables])
    n = len(chain.joints)
    if coupling or followers:
        notes.append("ranges and torque limits are taken as those of the actuators, not of links")
    fields: dict[str, Any] = {
        "name": tree.name,
        "source": tree.source,
        **_gravity(tree, base, notes),
        "uncertainty": DRAWN if tree.drawn else {},
        "coupling": _coupling(n, followers, coupling),
        "links": [
            _link(joint, frame, mass, tree.source, notes)
            for joint, frame, mass in zip(chain.joints, chain.frames, chain.masses, strict=True)
        ],
        "joints": tables,
        "flange": _transform(chain.X),
    }
    fields["effects"] = _rotors(chain.joints) + _springs(chain.joints)
    fields["tool"] = None if payload is None else _payload(payload)
    notes += _on_bodies(tree, chain)
    drawn = chain.drawn if outline else []
    robot = with_outline(_valid(tree, fields), drawn, tree.folders, notes)
    return Imported(robot, tuple(grouped(notes)))


def _gravity(tree: Tree, base: str, notes: list[str]) -> dict[str, Any]:
    """Gravity as the chain's first link sees it; a note where the file mounts that one turned."""
    gravity = tree.gravity_at(base)
    upright = "the base"
    if not np.allclose(gravity, tree.gravity):
        upright = "what carries the base"
        along = ", ".join(f"{v:.4g}" for v in gravity)
        notes.append(f"link {base} is mounted turned: gravity is [{along}] m/s2 in its frame")
    source = f"assumption: {upright} stands upright; the file does not say"
    return {
        "gravity_m_s2": gravity.tolist(),
        "gravity_source": "the imported file" if tree.gravity_stated else source,
    }


def _on_bodies(tree: Tree, chain: _Collected) -> list[str]:
    """What the reader should know of the masses."""
    if not any(mass.mass for mass in chain.masses):
        return [WEIGHTLESS]
    if not tree.drawn:
        return []
    return [
        f"bodies of a model are taken as known to {100 * DRAWN['mass_relative']:.0f} % of a mass, "
        f"{1e3 * DRAWN['com_m']:.0f} mm and {100 * DRAWN['inertia_relative']:.0f} % of an inertia; "
        "where these are the maker's, state less in [uncertainty]"
    ]


def _rotors(joints: list[TreeJoint]) -> list[dict[str, Any]]:
    return [
        {"kind": "rotor_inertia", "joint": k, "inertia_kgm2": joint.armature}
        for k, joint in enumerate(joints, 1)
        if joint.armature
    ]


def _springs(joints: list[TreeJoint]) -> list[dict[str, Any]]:
    return [
        {
            "kind": "cable_spring",
            "joint": k,
            "stiffness_Nm_rad": joint.stiffness,
            "neutral_rad": joint.rest,
        }
        for k, joint in enumerate(joints, 1)
        if joint.stiffness
    ]


def _valid(tree: Tree, fields: dict[str, Any]) -> Robot:
    """The robot, or what is wrong with its numbers."""
    try:
        return Robot.model_validate(fields)
    except ValidationError as error:
        wrong = []
        for item in error.errors()[:5]:
            place = [str(part) for part in item["loc"]]
            if len(place) > 1 and place[0] in {"links", "joints"}:
                place[:2] = [str(fields[place[0]][int(place[1])]["name"])]
            wrong.append(f"{' '.join(place)}: found {item['input']}, {item['msg']}")
        raise InputError(f"{tree.name}: {'; '.join(wrong)}") from error


def grouped(notes: list[str]) -> list[str]:
    """Notes on several joints or links that say the same, as one."""
    found: dict[tuple[str, str], list[str]] = {}
    for note in notes:
        match = _OF_ONE.fullmatch(note)
        key = (note, "") if match is None else (match["what"], match["says"])
        found.setdefault(key, []).append("" if match is None else match["name"])
    return [
        (f"{what} {names[0]}{says}" if len(names) == 1 else f"{what}s {', '.join(names)}{says}")
        if says
        else what
        for (what, says), names in found.items()
    ]


def _step(
    tree: Tree, joint: TreeJoint, chain: _Collected, on_path: set[str], notes: list[str]
) -> None:
    """Go over one joint of the path: a fixed one moves on, a turning one begins a link."""
    X = chain.X @ joint.X
    if joint.kind in TURNING:
        turned = pose(np.zeros(3), rotation_to(joint.axis, f"joint {joint.name}"))
        chain.frames.append(X @ turned)
        chain.masses.append(Mass(0.0, np.zeros(3), np.zeros((3, 3))))
        chain.joints.append(joint)
        X = inverse(turned)
    chain.X = X
    _gather(tree, joint.child, X, on_path, chain, notes)


def _gather(
    tree: Tree, link: str, X: Array, on_path: set[str], chain: _Collected, notes: list[str]
) -> None:
    """The link and everything that is fixed to it join the last body; the base has no mass data."""
    own = tree.links[link]
    if chain.masses and link in tree.guessed:
        notes.append(_of_shapes(tree, link))
    if chain.masses and own is not None:
        chain.masses[-1] = chain.masses[-1].joined(own.seen_from(X))
    if tree.shapes.get(link):
        chain.drawn.append(Drawn(len(chain.masses), link, X, tree.shapes[link]))
    for joint in tree.hanging_on(link):
        if joint.name in on_path:
            continue
        if joint.kind == "fixed":
            _gather(tree, joint.child, X @ joint.X, on_path, chain, notes)
        else:
            notes.append(left_out(tree, joint, not chain.masses))


def _of_shapes(tree: Tree, link: str) -> str:
    """A note on a link whose mass data the file does not state, or why the arm cannot be had."""
    why = tree.guessed[link]
    if why is not None:
        raise why
    return (
        f"link {link}: the file states no mass data; they are those of its shapes, as MuJoCo makes "
        "them (1000 kg/m3 where no density is stated): a guess, identify them"
    )


def _coupling(
    n: int, followers: list[Driven], terms: tuple[tuple[int, int, float], ...]
) -> dict[str, Any]:
    """What the file states, and then what the user does."""
    A = np.eye(n)
    offset = np.zeros(n)
    for one in followers:
        A[one.axis - 1, one.by - 1] += one.factor
        offset[one.axis - 1] += one.offset
    for i, j, factor in terms:
        if not (1 <= i <= n and 1 <= j <= n and i != j):
            raise InputError(f"coupling {i},{j},{factor:g}: expected two of the joints 1 to {n}")
        A[i - 1, j - 1] = factor
    stated = "stated at the import" if terms else "<mimic> of the imported file"
    return {
        "matrix": A.tolist(),
        "offset_rad": offset.tolist(),
        "source": stated if terms or followers else "serial arm",
    }


def _link(joint: TreeJoint, X: Array, mass: Mass, source: str, notes: list[str]) -> dict[str, Any]:
    if mass.mass == 0.0 and not mass.tensor.any():
        notes.append(f"link {joint.child}: no mass data in the file: massless here")
    return {
        "name": joint.child,
        "frame": _transform(X),
        "body": {
            "mass_kg": mass.mass,
            "com_m": mass.com.tolist(),
            "inertia_kgm2": mass.tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist(),
        },
        "source": source,
    }


def _payload(payload: Payload) -> dict[str, Any]:
    return {
        "name": "payload",
        "tcp": _transform(np.eye(4)),
        "body": {
            "mass_kg": payload.mass,
            "com_m": payload.com,
            "inertia_kgm2": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        },
        "source": "stated at the import; a point mass",
    }


def _transform(X: Array) -> dict[str, Any]:
    return {"transform": X.tolist()}


def _one_limit(torques: list[float | None]) -> list[str]:
    """A note where one number stands for the torque limit of every joint."""
    if len(torques) < 2 or torques[0] is None or len(set(torques)) > 1:
        return []
    return ["all torque limits are the same number: often a placeholder, check them"]
