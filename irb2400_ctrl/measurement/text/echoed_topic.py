"""Names for the columns of `ros2 topic echo --csv` of joint states, which writes none.

A line is a message flattened: seconds, nanoseconds, the frame, the joints' names, and then their
positions, velocities and efforts.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

PARTS = ("position", "velocity", "effort")
LEAST = 2
"""joints of a message that is taken for one"""
_LISTED = re.compile(r"name \d+|field\.name\d+")
_TOGETHER = re.compile(r"([\w./]*[/.])?name")


def echoed_names(row: Sequence[str], number: Callable[[str], bool]) -> list[str] | None:
    """Names of the columns of such a line; None where it is another."""
    if len(row) < 3 or not (number(row[0]) and number(row[1])) or number(row[2]):
        return None
    joints = []
    for cell in row[3:]:
        if not cell or number(cell):
            break
        joints.append(cell)
    n = len(joints)
    values = row[3 + n :]
    if n < LEAST or len(set(joints)) < n or len(values) != n * len(PARTS):
        return None
    if not all(map(number, values)):
        return None
    listed = [f"name {k + 1}" for k in range(n)]
    return ["sec", "nanosec", "frame_id", *listed, *(f"{j}/{p}" for p in PARTS for j in joints)]


def names_joint(column: str, cell: str) -> bool:
    """Whether a cell of a message names a joint, or lists all: it is the same in every message of
    the arm.
    """
    listed = _TOGETHER.fullmatch(column) is not None and cell[:1] in ("[", "(")
    return listed or _LISTED.fullmatch(column) is not None
