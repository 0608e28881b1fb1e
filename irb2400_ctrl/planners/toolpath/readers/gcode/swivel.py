"""`CYCLE800(…)` (Siemens 840D): a tilted plane, its axes turned one after another.

Source: Siemens, SINUMERIK 840D sl Programming Manual Job Planning, "Programming cycles externally".
"""

from __future__ import annotations

import math
import re

import numpy as np

from irb2400_ctrl.arrays import rotation_about
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import WordError

CYCLE = "CYCLE800"
CALL = re.compile(r"\bCYCLE800\s*\(([^()]*)\)", re.IGNORECASE)
_WAYS = {1: "solid angle", 2: "projection angles", 3: "rotary axes directly"}


def swivel(arguments: tuple[str, ...], state: GcodeState, builder: ProgramBuilder) -> None:
    """Tilt the plane; without arguments the plane is the work frame's again.

    CYCLE800(_FR, _TC, _ST, _MODE, _X0, _Y0, _Z0, _A, _B, _C, _X1, _Y1, _Z1, _DIR, …): to
    (X0, Y0, Z0), turned about the axes that _MODE names two bits each, then on by (X1, Y1, Z1) in
    the turned axes. The machine turns table or head; where the tool is then is known from its next
    stated place on.

    Raises:
        InputError: a plane on top of another one, stated in another way than axis by axis, or that
            the tool is not turned to.
    """
    state.left_turned = False
    if arguments in {(), ("",)}:
        state.reframe(plane_pose=np.eye(4))
        state.turned_by_file = False
        return
    at = [_number(text) for text in arguments] + [0.0] * 16
    status = int(at[2])
    mode = int(at[3])
    # ten thousands and more: in which direction the machine turns
    if status % 10 or status // 100 % 100:
        raise WordError(
            CYCLE,
            f"_ST {status} puts the plane on top of another one, or aligns a turning "
            "tool; expected a new plane (0)",
        )
    if mode >> 6:
        raise WordError(
            CYCLE, f"_MODE {mode} states {_WAYS[mode >> 6 & 3]}; expected axis by axis, such as 57"
        )
    axes = [mode >> shift & 3 for shift in (0, 2, 4)]
    if sorted(axes) != [1, 2, 3]:
        raise WordError(CYCLE, f"_MODE {mode} names no three axes, expected one such as 57")
    X = np.eye(4)
    for axis, angle in zip(axes, at[7:10], strict=True):
        X[:3, :3] = X[:3, :3] @ rotation_about(axis - 1, math.radians(angle))
    turns = at[13] != 0
    if not (turns or state.turned_by_file or np.array_equal(X[:3, :3], np.eye(3))):
        raise WordError(
            CYCLE,
            "_DIR 0 tilts the plane and does not turn the tool to it, nor does the file "
            "by A, B, C before it; expected -1 or 1",
        )
    X[:3, 3] = state.unit * (np.array(at[4:7]) + X[:3, :3] @ np.array(at[10:13]))
    state.reframe(plane_pose=X)
    builder.assume(
        "CYCLE800 turns table or head, and may draw the tool back; the robot goes on at the next "
        "stated place"
        if turns
        else "CYCLE800 with _DIR 0: the file has turned the tool to the plane by A, B, C before it"
    )
    builder.leave()
    state.at = [None, None, None]


def _number(text: str) -> float:
    if not text or text.startswith('"'):
        return 0.0
    try:
        return float(text)
    except ValueError:
        raise WordError(CYCLE, f"found {text!r}, expected a number") from None
