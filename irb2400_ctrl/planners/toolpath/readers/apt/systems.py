"""Several `CSYS/` in one file (SolidWorks CAM): in which frame the points are."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt import frames
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement

SAME = 1e-5
"""by which directions and zeros differ through rounding [-], [unit of the file]"""


def in_one_frame(statements: Iterable[object]) -> bool:
    """Whether the points are in one frame and `CSYS/` only says how the part stands: behind each
    `CSYS/` that turns, every `GOTO/` has i,j,k, and they are the z axis of `CSYS/` seen from that
    frame (in its own frame they would be 0,0,1, so that one which turns about z alone tells
    nothing). All have the same zero.
    """
    try:
        return _stated([s for s in statements if isinstance(s, Statement)])
    except InputError:
        # said where the statement is carried out
        return False


def _stated(statements: list[Statement]) -> bool:
    X = np.eye(4)
    systems = []
    told = False
    for statement in statements:
        if statement.word == "CSYS":
            X = frames.of_rows(statement.numbers(), 1.0)
            systems.append(X)
        turned = not np.allclose(X[:3, :3], np.eye(3), atol=SAME)
        if statement.word == "GOTO" and turned:
            values = statement.numbers()
            if len(values) != 6 or not np.allclose(values[3:], X[:3, 2], atol=SAME):
                return False
            told |= not np.allclose(X[:3, 2], (0.0, 0.0, 1.0), atol=SAME)
    if len(systems) < 2 or not told:
        return False
    spread = np.ptp(systems, axis=0)
    return bool(spread[:3, 3].max() < SAME < spread[:3, :3].max())
