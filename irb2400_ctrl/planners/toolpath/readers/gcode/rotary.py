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

PLANE_APART_DEG = 0.1
"""angles of axes and of planes are written with three decimals or four"""
STEP_DEG = 2.0
"""of a rotary axis, between tool axes on the way of one move"""
BESIDE_DEG = 0.05
"""off the shortest way, from which tool axes have to be stated on the way"""

UNCONTROLLED = (
    "A, B and C turn a table or a head, and without tool centre control (G43.4, M128, TRAORI) or a "
    "tilted plane (G68.2) the place of the tool in the part depends on the machine; let the CAM "
    "system write with tool centre control, or APT with tool axes; where the coordinates are those "
    "of the tip in the part all the same (the control's own kinematics), put G43.4 before the moves"
)

LEFT_TURNED = (
    "a cut behind the end of tool centre control (G49, TRAFOOF, M129), with the tool as a vector "
    "had turned it: where its tip is then depends on the machine; expected the axes turned before "
    "it (G0 A0 C0, CYCLE800, G68.2), or the cut under tool centre control"
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

    def leads_to(self, normal: Array, degrees: dict[str, float]) -> None:
        """The axis is that of a tilted plane.

        Args:
            normal: of the plane, shape (3,).
            degrees: of each rotary axis.

        Raises:
            InputError: it is another one: so are the machine's axes.
        """
        apart = math.degrees(math.acos(min(float(self.axis(degrees) @ normal), 1.0)))
        if apart > PLANE_APART_DEG:
            angles = " ".join(f"{k}{v:g}" for k, v in degrees.items() if v)
            raise InputError(
                f"the tilted plane and its angles {angles} differ by {apart:.1f} deg with "
                "the stated rotary axes: the machine has them in another order, another sign (-C), "
                "or inclined ones, which are not read; expected others, or APT with tool axes"
            )

    def rotation(self, degrees: dict[str, float]) -> Array:
        """Of the tool against the part, shape (3, 3).

        Raises:
            InputError: another axis than the stated ones is turned.
        """
        known = [name for name, _ in self.order]
        others = [name for name, angle in degrees.items() if angle != 0 and name not in known]
        if others:
            raise InputError(f"axis {others[0]} turns, but only {', '.join(known)} are stated")
        R = np.eye(3)
        for name, sign in self.order:
            R = R @ rotation_about("ABC".index(name), sign * math.radians(degrees[name]))
        return R

    def way(self, before: dict[str, float], after: dict[str, float]) -> Array:
        """Tool axes while all rotary axes turn evenly from one stand to another, as under tool
        centre control: every other degree, the last included, shape (m, 3); only the last where
        the way is the shortest one.

        A head that is tilted by 30 degrees and turned by C180 leads its axis along a cone, not
        through upright. No axis turns by more than half a turn: from C350 to C10 some controls go
        on by 20 degrees, others back by 340.
        """
        turns = {k: after[k] - before[k] for k in after}
        turns = {k: t if abs(t) <= 180.0 else math.remainder(t, 360.0) for k, t in turns.items()}
        count = max(math.ceil(max(map(abs, turns.values())) / STEP_DEG), 1)
        shares = np.arange(count + 1) / count
        axes = np.array(
            [self.axis({k: before[k] + share * turns[k] for k in after}) for share in shares]
        )
        beside = np.degrees(np.arccos(np.clip((axes * _shortest(axes)).sum(axis=1), -1.0, 1.0)))
        return axes[-1:] if beside.max() < BESIDE_DEG else axes[1:]


def _shortest(axes: Array) -> Array:
    """As many axes evenly along the great circle from the first to the last, shape (m, 3)."""
    start = axes[0]
    side = axes[-1] - (axes[-1] @ start) * start
    length = float(np.linalg.norm(side))
    angle = math.atan2(length, float(axes[-1] @ start))
    turn = np.linspace(0.0, angle, len(axes))[:, None]
    return np.asarray(np.cos(turn) * start + np.sin(turn) * side / max(length, 1e-12))


def tilted_plane(values: dict[str, float], unit: float) -> Array:
    """G68.2 X Y Z I J K: origin and Euler angles z, x', z'' [deg] (Fanuc)."""
    R = np.eye(3)
    for index, letter in ((2, "I"), (0, "J"), (2, "K")):
        R = R @ rotation_about(index, math.radians(values.get(letter, 0.0)))
    X = np.eye(4)
    X[:3, :3] = R
    X[:3, 3] = [unit * values.get(letter, 0.0) for letter in "XYZ"]
    return X
