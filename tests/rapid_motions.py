"""Motions that the tests of RAPID modules share."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb

Array = npt.NDArray[np.float64]
HOME = np.radians([10.0, -15.0, 12.0, 100.0, 50.0, -250.0])
WORK = np.eye(4)
WORK[:3, :3] = Rotation.from_euler("xyz", [5.0, -8.0, 33.0], degrees=True).as_matrix()
WORK[:3, 3] = [0.8, -0.2, 0.4]


@cache
def circle(model: irb.Model, count: int = 1001) -> tuple[Array, Array]:
    """A plan over 4 s: the tool goes round a circle of 60 mm and tilts by some degrees, from rest
    to rest."""
    time = np.linspace(0.0, 4.0, count)
    share = time / time[-1]
    phase = 2 * np.pi * share**3 * (10 - 15 * share + 6 * share**2)
    X = model.tcp_pose(HOME)
    q = [HOME]
    for angle in phase[1:]:
        X_k = X.copy()
        X_k[:3, 3] += 0.06 * np.array([np.cos(angle) - 1, np.sin(angle), 0.0])
        X_k[:3, :3] = (
            X[:3, :3]
            @ Rotation.from_rotvec([0.0, 0.1 * np.sin(angle), 0.05 * np.sin(angle)]).as_matrix()
        )
        q.append(model.inverse_kinematics(X_k, q[-1])[0])
    return time, np.array(q)


def wrist_passage(model: irb.Model) -> tuple[Array, Array]:
    """Axis 5 runs through zero at mid-way while axes 1 and 2 move."""
    time = np.linspace(0.0, 2.0, 500)
    share = time / 2.0
    ease = share**3 * (10 - 15 * share + 6 * share**2)
    a = np.radians([0, 0, 0, 20.0, -25.0, 0])
    b = np.radians([15.0, 10.0, 0, 20.0, 30.0, 0])
    return time, a + ease[:, None] * (b - a)
