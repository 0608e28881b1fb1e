"""Closed-form inverse kinematics of the IRB 2400 family, vectorised over poses.

The wrist centre gives (q1, q2, q3): two ways to face it (axis 1), two elbows; the wrist's
orientation gives (q4, q5, q6): two flips. Eight branches in all, numbered 4 * rear + 2 * elbow +
flip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.model.geometry import ArmGeometry

Array = npt.NDArray[np.float64]

# below this the projection of the flange axis has no direction: q4 is free and taken from the seed
# [-]
WRIST_EPSILON = 1e-9


@dataclass(frozen=True)
class Branches:
    """All branches of many poses: angles in (-pi, pi] and how far each pose is out of reach."""

    q: Array
    """[rad], shape (n, 8, 6); not finite where the branch does not exist"""
    overreach: Array
    """distance by which the wrist centre is out of reach of a branch, 0 where it exists [m], shape
    (n, 8)"""


def solve(geometry: ArmGeometry, X_BF: Array, q_seed: Array | None = None) -> Branches:
    """All eight branches for flange poses X_BF (n, 4, 4).

    `q_seed` (6,) or (n, 6) [rad] decides what geometry leaves open: q1 with the wrist centre on
    axis 1, q4 with the wrist straight (default zero).
    """
    g = geometry
    n = len(X_BF)
    seed = np.zeros((n, 6)) if q_seed is None else np.broadcast_to(q_seed, (n, 6))
    R = X_BF[:, :3, :3]
    wrist = X_BF[:, :3, 3] - g.d7 * R[:, :, 2]
    radius = np.hypot(wrist[:, 0], wrist[:, 1])
    heading = np.where(radius > 1e-12, np.arctan2(wrist[:, 1], wrist[:, 0]), seed[:, 0])

    q = np.empty((n, 8, 6))
    overreach = np.zeros((n, 8))
    gamma = np.arctan2(g.d4, g.a3)
    for rear in (0, 1):
        q1 = _wrap(heading + np.pi * rear)
        u = (radius if rear == 0 else -radius) - g.a1
        v = wrist[:, 2] - g.d1
        distance = np.hypot(u, v)
        cos_bend = (distance**2 - g.a2**2 - g.forearm**2) / (2 * g.a2 * g.forearm)
        gap = np.maximum(distance - (g.a2 + g.forearm), abs(g.a2 - g.forearm) - distance)
        # rounding may put a stretched arm a hair outside: up to a nanometre counts as reached
        outside = gap > 1e-9
        bend = np.arccos(np.clip(cos_bend, -1.0, 1.0))
        for elbow, beta in ((0, bend), (1, -bend)):
            q2 = np.arctan2(u, v) - np.arctan2(
                g.forearm * np.sin(beta), g.a2 + g.forearm * np.cos(beta)
            )
            q3 = q2 + beta - gamma
            first = 4 * rear + 2 * elbow
            for branch, wrist_angles in zip(
                (first, first + 1), _wrist(q1, q3, R, seed[:, 3]), strict=True
            ):
                q[:, branch, 0] = q1
                q[:, branch, 1] = _wrap(q2)
                q[:, branch, 2] = _wrap(q3)
                q[:, branch, 3:] = wrist_angles
                q[outside, branch] = np.nan
                overreach[:, branch] = np.where(outside, gap, 0.0)
    return Branches(q, overreach)


def _wrist(q1: Array, q3: Array, R: Array, q4_seed: Array) -> tuple[Array, Array]:
    """Both wrists (n, 3) for the flange rotation R (n, 3, 3) on a forearm at (q1, q3).

    With R_3F the flange in the forearm frame, its axis is z = (-c4 s5, c5, s4 s5), so w = s5 (c4,
    s4) = (-z_x, z_z).
    """
    c1 = np.cos(q1)
    s1 = np.sin(q1)
    c3 = np.cos(q3)
    s3 = np.sin(q3)
    zero = np.zeros_like(q1)
    # columns of R_B3 (product of eqs. 3-5): forearm x, y, z axes in the base
    x3 = np.stack([c1 * s3, s1 * s3, c3], axis=1)
    y3 = np.stack([c1 * c3, s1 * c3, -s3], axis=1)
    z3 = np.stack([-s1, c1, zero], axis=1)
    R_3F = np.einsum("nji,njk->nik", np.stack([x3, y3, z3], axis=2), R)
    w_x = -R_3F[:, 0, 2]
    w_y = R_3F[:, 2, 2]
    c5 = R_3F[:, 1, 2]
    s5 = np.hypot(w_x, w_y)
    solutions = []
    for sign in (1.0, -1.0):
        q5 = np.arctan2(sign * s5, c5)
        q4 = np.where(s5 > WRIST_EPSILON, np.arctan2(sign * w_y, sign * w_x), q4_seed)
        c4 = np.cos(q4)
        s4 = np.sin(q4)
        # columns of R_4^3: eq. 6 with the missing minus of its second element
        # (docs/paper_errata.md)
        x4 = np.stack([c4, zero, -s4], axis=1)
        y4 = np.stack([-s4, zero, -c4], axis=1)
        x_F = R_3F[:, :, 0]
        a = (x4 * x_F).sum(1)
        b = (y4 * x_F).sum(1)
        # component of x_F along the forearm (y of frame 3 = z of frame 4)
        d = x_F[:, 1]
        # x_F in frame 5 (columns of eq. 7) is (cos q6, 0, sin q6) by eq. 8
        q6 = np.arctan2(-b, -np.cos(q5) * a - np.sin(q5) * d)
        solutions.append(np.stack([_wrap(q4), q5, q6], axis=1))
    return solutions[0], solutions[1]


def _wrap(angle: Array) -> Array:
    """Into (-pi, pi]."""
    wrapped: Array = np.pi - np.mod(np.pi - angle, 2 * np.pi)
    return wrapped


def windings(q: Array, q_min: Array, q_max: Array) -> Array:
    """Every q + 2 pi k inside the joint box, shape (m, 6), for branches q (b, 6) [rad]."""
    tolerance = 1e-9
    found = []
    for row in q[np.isfinite(q).all(axis=1)]:
        choices = []
        for angle, low, high in zip(row, q_min, q_max, strict=True):
            first = np.ceil((low - tolerance - angle) / (2 * np.pi))
            last = np.floor((high + tolerance - angle) / (2 * np.pi))
            choices.append(angle + 2 * np.pi * np.arange(first, last + 1))
        grid = np.meshgrid(*choices, indexing="ij")
        found.append(np.stack([axis.ravel() for axis in grid], axis=1))
    return np.concatenate(found) if found else np.empty((0, q.shape[1]))
