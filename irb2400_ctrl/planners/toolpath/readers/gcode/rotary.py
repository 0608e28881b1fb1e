"""Tool axes from rotary words, tilted planes and vectors in G-code."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, rotation_about
from irb2400_ctrl.errors import InputError

REFUSAL = (
    "A, B and C turn a table or a head, and where the tool then is depends on the machine: state "
    "its rotations from part to tool (rotary='C,A' or --rotary C,A) for a program with tool centre "
    "control (G43.4, M128, TRAORI), or write APT with tool axes"
)

UNCONTROLLED = (
    "A, B and C turn a table or a head, and without tool centre control (G43.4, M128, TRAORI) or a "
    "tilted plane (G68.2) the place of the tool in the part depends on the machine; let the CAM "
    "system write with tool centre control, or APT with tool axes; where the coordinates are those "
    "of the tip in the part all the same (the control's own kinematics), put G43.4 before the moves"
)


@dataclass(frozen=True)
class Rotary:
    """The tool axis in the part: the named rotations, from part to tool, applied to z.

    With signs as in ISO 841 it does not matter which of them turn the table. `-C` turns the other
    way.
    """

    order: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, text: str) -> Rotary:
        """ "C,A", "C,B", "-C,B", …"""
        parts = [part.strip().upper() for part in text.split(",") if part.strip()]
        names = [part.lstrip("+-") for part in parts]
        wrong = [n for n in names if re.fullmatch("[ABC]", n) is None] or (
            names if len(set(names)) != len(names) or not names else []
        )
        if wrong:
            raise InputError(
                f"rotary: found {text!r}, expected the rotary axes from part to tool, such as C,A"
            )
        return cls(tuple((p.lstrip("+-"), -1.0 if p[0] == "-" else 1.0) for p in parts))

    def axis(self, degrees: dict[str, float]) -> Array:
        """From the tip towards the spindle, in the part, shape (3,).

        Raises:
            InputError: another axis than the stated ones is turned.
        """
        return np.asarray(self.rotation(degrees)[:, 2])

    def rotation(self, degrees: dict[str, float], place: str = "") -> Array:
        """Of the tool against the part, shape (3, 3).

        Raises:
            InputError: another axis than the stated ones is turned.
        """
        before = f"{place}: " if place else ""
        known = [name for name, _ in self.order]
        others = [name for name, angle in degrees.items() if angle != 0 and name not in known]
        if others:
            raise InputError(
                f"{before}axis {others[0]} turns, but only {', '.join(known)} are stated"
            )
        R = np.eye(3)
        for name, sign in self.order:
            R = R @ rotation_about("ABC".index(name), sign * math.radians(degrees[name]))
        return R


def tilted_plane(values: dict[str, float], unit: float) -> Array:
    """G68.2 X Y Z I J K: origin and Euler angles z, x', z'' [deg] (Fanuc)."""
    R = np.eye(3)
    for index, letter in ((2, "I"), (0, "J"), (2, "K")):
        R = R @ rotation_about(index, math.radians(values.get(letter, 0.0)))
    X = np.eye(4)
    X[:3, :3] = R
    X[:3, 3] = [unit * values.get(letter, 0.0) for letter in "XYZ"]
    return X
