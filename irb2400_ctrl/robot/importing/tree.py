"""A robot as other formats have it: links that carry mass, joints between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.geometry import Geometry

TURNING = {"revolute", "continuous"}
ROUNDED = 1e-5
"""a quarter turn with four decimals is off by less [rad]"""
COARSE = 2e-3
"""one with two decimals (3.14) by less than this"""


@dataclass(frozen=True)
class Mass:
    """Mass data in a frame: mass [kg], centre of mass (3,) [m], tensor about it (3, 3) [kg m2]."""

    mass: float
    com: Array
    tensor: Array

    def seen_from(self, X: Array) -> Mass:
        """The same body in the frame that the pose X (4, 4) leads to."""
        R = X[:3, :3]
        return Mass(self.mass, R @ self.com + X[:3, 3], R @ self.tensor @ R.T)

    def joined(self, other: Mass) -> Mass:
        """Both bodies as one, in the same frame."""
        total = self.mass + other.mass
        if total == 0.0:
            return Mass(0.0, np.zeros(3), self.tensor + other.tensor)
        com = (self.mass * self.com + other.mass * other.com) / total
        tensor = np.zeros((3, 3))
        for body in (self, other):
            r = body.com - com
            tensor += body.tensor + body.mass * (r @ r * np.eye(3) - np.outer(r, r))
        return Mass(total, com, tensor)


@dataclass(frozen=True)
class TreeJoint:
    """One joint; None is what the file does not say."""

    name: str
    kind: str
    """`revolute`, `continuous`, `fixed`, or what else the format knows"""
    parent: str
    child: str
    X: Array
    """pose of the child's frame in the parent's at angle zero, shape (4, 4)"""
    axis: Array
    """direction in the child's frame, not of unit length, shape (3,)"""
    range: tuple[float, float] | None = None
    """[rad]"""
    soft: tuple[float, float] | None = None
    """where a controller begins to slow the joint down, within the range [rad]"""
    speed: float | None = None
    """[rad/s]"""
    effort: float | None = None
    """[Nm]"""
    damping: float | None = None
    """[Nm s/rad]"""
    dry: float | None = None
    """[Nm]"""
    armature: float | None = None
    """rotor inertia on the joint's side [kg m2]"""
    gear: float | None = None
    """motor turns per joint turn [-]"""
    acceleration: float | None = None
    """largest one [rad/s2]"""
    stiffness: float | None = None
    """of a spring across the joint [Nm/rad]"""
    rest: float = 0.0
    """where that spring is at rest [rad]"""
    mimics: str | None = None
    multiplier: float = 1.0
    """of the joint that it follows"""
    offset: float = 0.0
    """[rad]"""
    unread: tuple[str, ...] = ()
    """what the file says of it in words that mean nothing in this format"""


@dataclass(frozen=True)
class Tree:
    """Links by name, joints in the order of the file."""

    name: str
    source: str
    links: dict[str, Mass | None]
    joints: tuple[TreeJoint, ...]
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    gravity_stated: bool = False
    """whether the file says it, not only which way is up"""
    notes: tuple[str, ...] = ()
    shapes: dict[str, tuple[Geometry, ...]] = field(default_factory=dict)
    """what the file draws on a link"""
    folders: tuple[Path, ...] = ()
    """where meshes are looked for"""
    guessed: dict[str, InputError | None] = field(default_factory=dict)
    """links whose mass data the file does not state: those of their shapes, or why there are none
    and no arm can have it"""
    drawn: bool = False
    """whether its bodies are those of somebody's model, not a maker's numbers in a table"""

    def root(self) -> str:
        """The link that hangs on no joint.

        Raises:
            InputError: none, or several.
        """
        if not self.links:
            raise InputError(
                f"{self.name}: found no link, expected a robot; a file that only defines or "
                "includes macros holds none"
            )
        children = {joint.child for joint in self.joints}
        roots = [name for name in self.links if name not in children]
        if len(roots) != 1:
            if not roots:
                raise InputError(
                    f"{self.name}: found every link hanging on a joint, expected one that hangs on "
                    "none: the joints close a loop; take out the one that only closes it"
                )
            raise InputError(
                f"{self.name}: found the root links {', '.join(roots)}, expected one link that "
                "hangs on no joint; with several robots in one file choose one of them with "
                "--base-link"
            )
        return roots[0]

    def path(self, base: str, tip: str) -> list[TreeJoint]:
        """The joints from one link out to another.

        Raises:
            InputError: no such link, or it does not hang on the base.
        """
        for name in (base, tip):
            if name not in self.links:
                known = ", ".join(self.links)
                raise InputError(f"{self.name} has no link {name!r}; it has {known}")
        above = {joint.child: joint for joint in self.joints}
        path: list[TreeJoint] = []
        link = tip
        while link != base:
            if link not in above or len(path) > len(self.joints):
                raise InputError(f"{self.name}: no chain of joints leads from {base} to {tip}")
            path.append(above[link])
            link = above[link].parent
        return path[::-1]

    def gravity_at(self, link: str) -> Array:
        """Gravity in the frame of a link, all joints before it at zero [m/s2], shape (3,)."""
        above = {joint.child: joint for joint in self.joints}
        R = np.eye(3)
        for _ in self.joints:
            if link not in above:
                break
            R = above[link].X[:3, :3] @ R
            link = above[link].parent
        # what rounding leaves of a quarter turn is none
        return np.asarray(np.round(R.T @ np.array(self.gravity), 12) + 0.0)

    def hanging_on(self, link: str) -> list[TreeJoint]:
        """Joints whose parent is this link."""
        return [joint for joint in self.joints if joint.parent == link]


def pose(xyz: Array, R: Array) -> Array:
    """[[R, p], [0, 1]], shape (4, 4)."""
    X = np.eye(4)
    X[:3, :3] = R
    X[:3, 3] = xyz
    return X


def inverse(X: Array) -> Array:
    """The inverse of a pose."""
    R = X[:3, :3].T
    return pose(-R @ X[:3, 3], R)


def right_angled(R: Array, link: str) -> tuple[Array, list[str]]:
    """A rotation (3, 3), exact where it is one by right angles but for few digits, and a note."""
    exact = R.round() + 0.0
    off = float(np.abs(R - exact).max())
    if off < ROUNDED:
        said = f"link {link}: a quarter turn of few digits (1.5708, 0.70711) is read as exact"
        return exact, [said] if off > 1e-9 else []
    if off > COARSE or np.array_equal(exact, np.eye(3)):
        return R, []
    said = "turned as it stands, up to 2 mrad off right angles; if these are meant, write 1.5707963"
    return R, [f"link {link}: {said}"]


def rotation_to(axis: Array, where: str) -> Array:
    """A rotation whose z axis points along `axis`; exact for the axes of the frame, shape (3, 3).

    Args:
        where: whose axis it is, for the sentence.

    Raises:
        InputError: an axis of no length.
    """
    length = float(np.linalg.norm(axis))
    if not np.isfinite(length) or length < 1e-9:
        raise InputError(f"{where}: found an axis of {axis.tolist()}, expected a direction")
    z = axis / length
    helper = np.roll(np.eye(3)[int(np.argmax(np.abs(z)))], 1)
    x = np.cross(helper, z)
    if z[2] > 0.999:
        # an axis along z keeps the frame of the file
        x = np.array([1.0, 0.0, 0.0]) - z[0] * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)
