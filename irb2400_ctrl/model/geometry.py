"""Geometry of the two families of six-axis arms that have a closed form.

Both have axis 1 at right angles to the parallel axes 2 and 3, and a point W, the wrist centre,
that some last axes leave where it is:

- *spherical wrist*: axes 4, 5 and 6 meet in W (IRB 2400 and most industrial arms);
- *parallel axes*: axis 4 is parallel to 2 and 3 too, axes 5 and 6 meet in W (UR).

An arm is described in its own canonical angles phi = C q + offset, link directions measured from
the upright: for the IRB 2400 they are the actuator angles q of Tab. 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array

Family = Literal["spherical wrist", "parallel axes"]


@dataclass(frozen=True)
class ArmGeometry:
    """Constants of one arm [m]; for the spherical wrist those of Tab. 2."""

    family: Family
    d1: float
    """height of axis 2 above the base, along axis 1"""
    a1: float
    """from axis 1 to axis 2"""
    a2: float
    """from axis 2 to axis 3"""
    a3: float
    """from axis 3 to W at right angles to the forearm; parallel axes: from axis 3 to axis 4"""
    d4: float
    """from axis 3 to W along the forearm; parallel axes: from axis 4 to W along axis 5"""
    e4: float
    """parallel axes: from axis 4 to W at right angles to axis 5; otherwise zero"""
    b: float
    """of W beside the plane of the arm, along axis 2"""
    C: Array
    """phi = C q + offset, shape (6, 6)"""
    offset: Array
    """[rad], shape (6,)"""
    X_B0: Array
    """foot of axis 1: z along it, phi1 = 0 along x, shape (4, 4)"""
    X_6F: Array
    """flange in the frame of W that turns with axis 6, shape (4, 4)"""
    exact: bool = True
    """whether the arm is of the family, or only near it (a calibrated one)"""

    @property
    def d7(self) -> float:
        """From W to the flange along axis 6 [m]."""
        return float(self.X_6F[2, 3])

    @property
    def forearm(self) -> float:
        """Distance from axis 3 to where the two-link arm ends: W, or axis 4 [m]."""
        return float(np.hypot(self.a3, self.d4)) if self.spherical else abs(self.a3)

    @property
    def spherical(self) -> bool:
        """Of the spherical-wrist family."""
        return self.family == "spherical wrist"

    @property
    def wound(self) -> tuple[int, int]:
        """Zero-based axes that a path may wind by whole turns."""
        return (3, 5) if self.spherical else (0, 5)

    def canonical(self, q: Array) -> Array:
        """phi of actuator angles q, shape (..., 6) [rad]."""
        return np.asarray(q @ self.C.T + self.offset)

    def forearm_reach(self) -> float:
        """Largest distance from axis 3 to W in the plane of the arm [m]."""
        return self.forearm + (0.0 if self.spherical else float(np.hypot(self.d4, self.e4)))


def singularity_factors(geometry: ArmGeometry, q: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(wrist, shoulder, elbow) = (sin phi5, r, k) with |det J| = a2 |sin phi5 r k| (eqs. 34-36).

    Spherical wrist:
        r = a1 + a2 sin phi2 + a3 sin phi3 + d4 cos phi3    W from axis 1, in the arm's plane [m]
        k = d4 cos(phi2 - phi3) - a3 sin(phi2 - phi3)       zero for the stretched arm [m]
    Parallel axes:
        r = a1 + a2 sin phi2 + a3 sin phi3 + d4 sin phi4 + e4 cos phi4
        k = a3 sin(phi3 - phi2)

    Eq. 36 is the product r k: it holds two singularities, not one (docs/paper_errata.md).

    Args:
        q: actuator angles [rad], a CasADi column or an array of shape (6, …).
    """
    g = geometry
    phi = ca.DM(g.C) @ q + ca.DM(g.offset)
    r = g.a1 + g.a2 * ca.sin(phi[1]) + g.a3 * ca.sin(phi[2])
    if g.spherical:
        r = r + g.d4 * ca.cos(phi[2])
        k = g.d4 * ca.cos(phi[1] - phi[2]) - g.a3 * ca.sin(phi[1] - phi[2])
    else:
        r = r + g.d4 * ca.sin(phi[3]) + g.e4 * ca.cos(phi[3])
        k = g.a3 * ca.sin(phi[2] - phi[1])
    return ca.sin(phi[4]), r, k
