"""What moves and turns the coordinates: datum shift (cycle 7), rotation (cycle 10), `PLANE …`."""

from __future__ import annotations

import math
import re

import numpy as np

from irb2400_ctrl.arrays import Array, rotation_about
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import REFUSAL, Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.state import (
    AXES,
    ROTARY,
    GcodeState,
)
from irb2400_ctrl.planners.toolpath.readers.heidenhain.statements import NUMBER, as_number
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

_ANGLE = re.compile(rf"\b(SP[ABC]|EUL(?:PR|NU|ROT)|[BN][XYZ]|[ABC])\s*({NUMBER})")
_SHIFT = re.compile(rf"\b(I?)([XYZ])\s*({NUMBER})")
_UNREAD_ANGLE = re.compile(r"\b(?:SP[ABC](?!TIAL\b)|EUL(?!ER\b)|[BN][XYZ]|[ABC]\s*[-+]?\s*Q)\S*")
_EYE = np.eye(4)
FORMS = "PLANE SPATIAL, AXIAL, EULER and VECTOR"


class PlainFrames:
    """Carries them out on the state; the tool stays where it is."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState, rotary: Rotary | None) -> None:
        self._builder = builder
        self._state = state
        self._rotary = rotary
        self._shift = np.zeros(3)
        """[m]"""
        self._turn = 0.0
        """[deg]"""
        self._inside = False
        """the datum was moved in the tilted plane"""
        self.turned = True
        """the tool is turned to the plane, by the control or by the file"""

    def transform(self, code: str) -> None:
        """TRANS DATUM AXIS X+10, TRANS DATUM RESET: as cycle 7."""
        axes = "X0 Y0 Z0" if code.split()[2:] == ["RESET"] else code.partition("AXIS")[2]
        self.shift(axes or code, "TRANS DATUM")

    def shift(self, code: str, order: str = "CYCL DEF 7") -> None:
        """CYCL DEF 7.1 X+10: the new datum, in the tilted plane where there is one; axes that are
        not named stay.

        Raises:
            InputError: a row of a table that is kept in the control, or a turned frame.
        """
        found = _SHIFT.findall(code)
        if not found:
            raise InputError(
                f"{code[:30]!r} takes its datum from a table of the control; expected X, Y, Z"
            )
        if self._turn:
            raise InputError("a datum shift in rotated coordinates (cycle 10); not read")
        tilted = not np.array_equal(self._state.plane_pose, _EYE)
        zero = not any(as_number(stated) for _, _, stated in found)
        if tilted and not self._inside and self._shift.any() and not zero:
            raise InputError(
                "the datum is moved in the tilted plane, and was moved before it: how "
                "the two add up is not known here; expected one of them"
            )
        for step, letter, stated in found:
            i = AXES.index(letter)
            way = as_number(stated) * self._state.unit
            self._shift[i] = self._shift[i] + way if step else way
        self._inside = tilted and bool(self._shift.any())
        self._builder.assume(f"{order}: the datum is moved by what it states")
        self._apply()

    def preset(self) -> None:
        """CYCL DEF 247: another preset ends shifts and rotations."""
        if self._turn or self._shift.any():
            self._shift = np.zeros(3)
            self._turn = 0.0
            self._inside = False
            self._builder.assume("CYCL DEF 247 ends the datum shift and the rotation")
            self._apply()

    def turn(self, code: str) -> None:
        """CYCL DEF 10.1 ROT+30: about the datum, in the plane X Y."""
        found = re.search(rf"\b(I?)ROT\s*({NUMBER})", code)
        if found is None:
            raise InputError("CYCL DEF 10 without ROT; expected ROT+30")
        angle = as_number(found[2])
        self._turn = self._turn + angle if found[1] else angle
        self._apply()

    def plane(self, code: str) -> None:
        """PLANE SPATIAL SPA SPB SPC …, PLANE RESET.

        Raises:
            InputError: a form that is not read, or a datum in the plane that goes.
        """
        state = self._state
        form = code.split()[1] if len(code.split()) > 1 else ""
        values = self._angles(code)
        R = np.eye(3) if form == "RESET" else self._rotation(form, values)
        if self._inside:
            raise InputError(
                "another plane while the datum is moved in the tilted one; expected "
                "CYCL DEF 7 with zeros before it"
            )
        X = np.eye(4)
        X[:3, :3] = R
        tilted = not np.allclose(R, np.eye(3))
        stays = "STAY" in code
        was_tilted = not np.array_equal(state.plane_pose, _EYE)
        # a plane that is left and lets the tool stay: turned to it is turned no longer
        self.turned = (
            not stays or state.turned_by_file or (not tilted and was_tilted != self.turned)
        )
        if not stays:
            state.rotary = dict.fromkeys(ROTARY, 0.0)
        if not (stays and tilted):
            state.turned_by_file = False
        state.reframe(plane_pose=X if tilted else np.eye(4))
        if stays and not tilted:
            return
        self._builder.assume(
            "PLANE turns table or head, and may draw the tool back; the robot goes on at the next "
            "stated place"
        )
        self._builder.leave()
        state.at = [None, None, None]

    def hold_turned(self) -> None:
        """Before a cut.

        Raises:
            InputError: the tool is turned otherwise than the plane.
        """
        if not self.turned:
            raise InputError(
                "a cut in a tilted plane (STAY) that the tool is not "
                "turned to, or turned to a plane that was left (RESET STAY) or by TX, TY, TZ "
                "before M129; expected TURN, or a block with A, B, C before it"
            )

    def _angles(self, code: str) -> dict[str, float]:
        """Of a PLANE, by their names.

        Raises:
            InputError: a word that sounds like an angle and is none that is read.
        """
        found = {key: as_number(n) for key, n in _ANGLE.findall(code)}
        rest = _ANGLE.sub(" ", code)
        if wrong := _UNREAD_ANGLE.search(rest):
            raise InputError(
                f"found {wrong[0]!r} in PLANE, expected words such as SPB+30 or EULNU+30"
            )
        return found

    def _rotation(self, form: str, values: dict[str, float]) -> Array:
        if form == "SPATIAL":
            # about the fixed axes x, y, z one after another
            return _turned("ZYX", [values.get(f"SP{axis}", 0.0) for axis in "CBA"])
        if form == "EULER":
            return _turned("ZXZ", [values.get(f"EUL{name}", 0.0) for name in ("PR", "NU", "ROT")])
        if form == "AXIAL":
            if self._rotary is None:
                raise InputError(f"PLANE AXIAL: {REFUSAL}")
            return self._rotary.rotation({axis: values.get(axis, 0.0) for axis in "ABC"})
        if form == "VECTOR" and {"NX", "NY", "NZ", "BX", "BY", "BZ"} <= set(values):
            z = np.array([values[f"N{axis}"] for axis in AXES])
            x = np.array([values[f"B{axis}"] for axis in AXES])
            z = z / np.linalg.norm(z)
            x = x - (x @ z) * z
            x = x / np.linalg.norm(x)
            return np.stack([x, np.cross(z, x), z], axis=1)
        raise InputError(f"PLANE {form} is not read; expected {FORMS}")

    def _apply(self) -> None:
        moved = np.eye(4)
        moved[:3, 3] = self._shift
        turned = np.eye(4)
        turned[:3, :3] = rotation_about(2, math.radians(self._turn))
        inner = moved @ turned if self._inside else turned
        self._state.reframe(offset=np.eye(4) if self._inside else moved, turned=inner)


def _turned(axes: str, degrees: list[float]) -> Array:
    R = np.eye(3)
    for axis, angle in zip(axes, degrees, strict=True):
        R = R @ rotation_about(AXES.index(axis), math.radians(angle))
    return R
