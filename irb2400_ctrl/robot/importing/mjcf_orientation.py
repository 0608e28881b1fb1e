"""Orientations of MJCF: quat, euler (any `eulerseq`), axisangle, xyaxes, zaxis."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from irb2400_ctrl.arrays import Array, rotations_about
from irb2400_ctrl.errors import InputError

Numbers = Callable[[str, int], Array]
"""(text, how many) -> numbers"""
TURNS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")


def over(of_class: Mapping[str, str], own: Mapping[str, str]) -> dict[str, str]:
    """Attributes of an element on top of those of its class: one orientation takes the place of
    another, however they are written."""
    turned = any(key in own for key in TURNS)
    return {k: v for k, v in of_class.items() if not (turned and k in TURNS)} | dict(own)


def orientation(keys: Mapping[str, str], numbers: Numbers, unit: float, eulerseq: str) -> Array:
    """R of an element, shape (3, 3); the unit matrix where it states none.

    Args:
        keys: the element's attributes.
        unit: radians per unit of its angles.
        eulerseq: order of the Euler angles; lower case about the turned axes, upper about fixed.

    Raises:
        InputError: numbers of another count, an axis of no length, an unknown order.
    """
    if "quat" in keys:
        return from_quaternion(numbers(keys["quat"], 4))
    if "euler" in keys:
        return _euler(numbers(keys["euler"], 3) * unit, eulerseq)
    if "axisangle" in keys:
        x, y, z, angle = numbers(keys["axisangle"], 4)
        return turn(np.array([x, y, z]), angle * unit)
    if "xyaxes" in keys:
        both = numbers(keys["xyaxes"], 6)
        x_axis = _unit(both[:3])
        y_axis = _unit(both[3:] - (both[3:] @ x_axis) * x_axis)
        return np.stack([x_axis, y_axis, np.cross(x_axis, y_axis)], axis=1)
    if "zaxis" in keys:
        z_axis = _unit(numbers(keys["zaxis"], 3))
        across = np.cross([0.0, 0.0, 1.0], z_axis)
        size = float(np.linalg.norm(across))
        # the shortest turn; about x where z points down
        return turn(across if size > 1e-12 else np.eye(3)[0], np.arctan2(size, z_axis[2]))
    return np.eye(3)


def _euler(angles: Array, sequence: str) -> Array:
    axes = sequence.lower()
    same = sequence in (axes, sequence.upper())
    if len(axes) != 3 or not set(axes) <= set("xyz") or not same:
        raise InputError(f"found eulerseq {sequence!r}, expected three of xyz or of XYZ")
    turns = [turn(np.eye(3)["xyz".index(k)], a) for k, a in zip(axes, angles, strict=True)]
    first, second, third = turns if sequence == axes else reversed(turns)
    return np.asarray(first @ second @ third)


def from_quaternion(q: Array) -> Array:
    """R of (w, x, y, z), of any length, shape (3, 3)."""
    size = float(np.linalg.norm(q[1:]))
    axis = q[1:] if size > 0.0 else np.eye(3)[2]
    return turn(axis, 2.0 * float(np.arctan2(size, q[0])))


def turn(axis: Array, angle: float) -> Array:
    """R about an axis by an angle [rad], quarter turns exact, shape (3, 3)."""
    R = rotations_about(_unit(axis), angle)
    whole = R.round() + 0.0  # no zero below zero
    return np.where(np.abs(R - whole) < 1e-12, whole, R)


def _unit(axis: Array) -> Array:
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        raise InputError(f"found an axis of {axis.tolist()}, expected a direction")
    return np.asarray(axis / length)
