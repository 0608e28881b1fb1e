"""Geometry of the IRB 2400 family: six axes, spherical wrist, an arm of two parallel axes.

Closed-form inverse kinematics and the factored singularities hold for this family only; the
constants are read from the chain, and a chain of another shape is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import ModifiedDH, Robot

HALF = np.pi / 2


@dataclass(frozen=True)
class ArmGeometry:
    """Constants of Tab. 2 [m]."""

    d1: float
    a1: float
    a2: float
    a3: float
    d4: float
    d7: float

    @property
    def forearm(self) -> float:
        """Distance from the elbow axis to the wrist centre [m]."""
        return float(np.hypot(self.a3, self.d4))


def arm_geometry(robot: Robot) -> ArmGeometry:
    """The constants of Tab. 2, if the chain has the shape of Tab. 2.

    Raises:
        InputError: the chain is another one; the closed forms do not hold.
    """
    frames = [link.frame for link in robot.links]
    twists = (0.0, -HALF, 0.0, -HALF, HALF, HALF)
    offsets = (0.0, -HALF, 0.0, 0.0, np.pi, 0.0)
    absolute_q3 = np.eye(6)
    absolute_q3[2, 1] = -1.0
    if (
        robot.n == 6
        and all(isinstance(f, ModifiedDH) for f in (*frames, robot.flange))
        and np.allclose([f.alpha_rad for f in frames], twists)  # type: ignore[union-attr]
        and np.allclose(robot.offset, offsets)
        and np.allclose(robot.A, absolute_q3)
    ):
        a = [f.a_m for f in frames]  # type: ignore[union-attr]
        d = [f.d_m for f in frames]  # type: ignore[union-attr]
        if not any((a[0], d[1], d[2], a[4], d[4], a[5], d[5])):
            assert isinstance(robot.flange, ModifiedDH)
            return ArmGeometry(d1=d[0], a1=a[1], a2=a[2], a3=a[3], d4=d[3], d7=robot.flange.d_m)
    raise InputError(
        f"{robot.name}: closed-form inverse kinematics and singularity factors need the chain of "
        "Tab. 2 "
        "(modified DH, spherical wrist, q3 absolute); use a numerical inverse kinematics for this "
        "arm"
    )


def singularity_factors(geometry: ArmGeometry, q: Any) -> tuple[Any, Any, Any]:
    """(wrist, shoulder, elbow) = (sin q5, r, k) with det J = -a2 sin q5 r k (eqs. 34-36).

    r = a1 + a2 sin q2 + a3 sin q3 + d4 cos q3   distance of the wrist centre from axis 1 [m]
    k = d4 cos(q2 - q3) - a3 sin(q2 - q3)        zero for the stretched arm [m]

    Eq. 36 is the product r k: it holds two singularities, not one (docs/paper_errata.md).

    Args:
        q: actuator angles [rad], a CasADi column or an array of shape (6, …).
    """
    g = geometry
    sin = np.sin if isinstance(q, np.ndarray) else ca.sin
    cos = np.cos if isinstance(q, np.ndarray) else ca.cos
    r = g.a1 + g.a2 * sin(q[1]) + g.a3 * sin(q[2]) + g.d4 * cos(q[2])
    k = g.d4 * cos(q[1] - q[2]) - g.a3 * sin(q[1] - q[2])
    return sin(q[4]), r, k
