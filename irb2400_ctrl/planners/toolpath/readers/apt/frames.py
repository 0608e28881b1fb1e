"""Frames in APT-like files: NX `MSYS`, Creo `$$-> CSYS`, CATIA's matrix in comments, `TRACUT`.

Each is the pose X_PM of the frame M, in which the points are stated, in the part P.
"""

from __future__ import annotations

import re

import numpy as np

from irb2400_ctrl.arrays import Array, are_rotations
from irb2400_ctrl.errors import InputError

ORTHOGONAL = 1e-3


def of_axes(values: list[float], unit: float) -> Array:
    """NX: origin, x axis, y axis (9 numbers, lengths in `unit` [m]); z completes them."""
    if len(values) != 9:
        raise InputError(f"MSYS/ has {len(values)} numbers, expected 9 (origin, x axis, y axis)")
    p, x, y = np.array(values).reshape(3, 3)
    return _pose(np.stack([x, y, np.cross(x, y)], axis=1), unit * p)


def of_rows(values: list[float], unit: float) -> Array:
    """Three rows of a rotation and a translation in `unit` [m]: 12 numbers (Creo, CATIA)."""
    if len(values) != 12:
        raise InputError(
            f"the frame has {len(values)} numbers, expected 12 (three rows of a rotation "
            "and a translation)"
        )
    rows = np.array(values).reshape(3, 4)
    return _pose(rows[:, :3], unit * rows[:, 3])


def numbers_in(text: str) -> list[float]:
    """All numbers of a comment."""
    found = re.findall(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?(?![\w.])", text)
    return [float(n.upper().replace("D", "E")) for n in found]


def _pose(R: Array, p: Array) -> Array:
    """The pose, its rotation made exact."""
    if not are_rotations(R, ORTHOGONAL):
        raise InputError(
            f"the axes of the frame are not at right angles, of length one and "
            f"right-handed; found {np.array2string(R, precision=4)}"
        )
    u, _, vt = np.linalg.svd(R)
    X = np.eye(4)
    X[:3, :3] = u @ vt
    X[:3, 3] = p
    return X
