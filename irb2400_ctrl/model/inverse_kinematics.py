"""Closed-form inverse kinematics of both families of `geometry`, as one CasADi function.

The wrist centre W gives phi1 (two ways to face it); spherical wrists then have two elbows and two
flips of the wrist, arms of parallel axes two signs of phi5 and two elbows for each. Eight branches
in all, numbered 4 * rear + 2 * elbow + flip; flip is the sign of sin phi5.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.geometry import ArmGeometry

BRANCHES = 8
# below this the projection of the flange axis has no direction: the angle is free and taken from
# the seed [-]
WRIST_EPSILON = 1e-9
# rounding may put a stretched arm a hair outside: up to a nanometre counts as reached [m]
REACHED = 1e-9
_TURN = 2 * np.pi


@dataclass(frozen=True)
class Branches:
    """All branches of many poses: angles in (-pi, pi] and how far each pose is out of reach."""

    q: Array
    """[rad], shape (n, b, 6); not finite where the branch does not exist"""
    overreach: Array
    """distance by which the wrist centre is out of reach of a branch, 0 where it exists [m], shape
    (n, b)"""


def closed_form(geometry: ArmGeometry) -> ca.Function:
    """(X_BF (4, 4), seed (6,)) -> (q (6, 8), overreach (8,)), free of branches in the code.

    The seed [rad] decides what geometry leaves open: phi1 with W on axis 1, and with a straight
    wrist phi4 (spherical wrist) or the direction of axis 5 (parallel axes). Where a branch does not
    exist its overreach is positive and its angles are those of the nearest reach.
    """
    g = geometry
    X_BF = ca.SX.sym("X_BF", 4, 4)
    seed = ca.SX.sym("seed", 6)
    X = ca.DM(np.linalg.inv(g.X_B0)) @ X_BF @ ca.DM(np.linalg.inv(g.X_6F))
    phi_seed = ca.DM(g.C) @ seed + ca.DM(g.offset)
    from_seed = (phi_seed[0], phi_seed[3])
    columns = []
    overreach = []
    for rear in (0, 1):
        facing = _facing(g, X, from_seed[0], rear)
        branches = (_spherical if g.spherical else _parallel)(g, facing, from_seed[1])
        for phi, gap in branches:
            q = ca.DM(np.linalg.inv(g.C)) @ (phi - ca.DM(g.offset))
            columns.append(ca.vertcat(*(_wrap(angle) for angle in ca.vertsplit(q))))
            outside = ca.fmax(gap, facing.gap)
            overreach.append(ca.if_else(outside > REACHED, outside, 0))
    outputs = ca.cse([ca.horzcat(*columns), ca.vertcat(*overreach)])
    return ca.Function(
        "inverse_kinematics", [X_BF, seed], outputs, ["X_BF", "seed"], ["q", "overreach"]
    )


@dataclass(frozen=True)
class _Facing:
    """The pose in the plane of the arm: x out, y along axis 2, z up."""

    phi1: ca.SX
    u: ca.SX
    """of W from axis 2, out [m]"""
    v: ca.SX
    """of W from axis 2, up [m]"""
    R: ca.SX
    """frame of W in the plane's frame, shape (3, 3)"""
    gap: ca.SX
    """by which W is too close to axis 1 for the arm's sideways offset [m]"""


def _facing(g: ArmGeometry, X: ca.SX, phi1_seed: ca.SX, rear: int) -> _Facing:
    x = X[0, 3]
    y = X[1, 3]
    z = X[2, 3]
    square = x * x + y * y
    radius = ca.sqrt(square)
    heading = ca.if_else(radius > 1e-12, ca.atan2(y, x), phi1_seed)
    out = radius
    gap = ca.SX(0)
    if g.b != 0.0:
        out = ca.sqrt(ca.fmax(square - g.b**2, 0))
        gap = abs(g.b) - radius
    if rear:
        out = -out
    phi1 = heading - (np.pi * rear if g.b == 0.0 else ca.atan2(g.b, out))
    c = ca.cos(phi1) if g.b else (1 - 2 * rear) * ca.cos(heading)
    s = ca.sin(phi1) if g.b else (1 - 2 * rear) * ca.sin(heading)
    R = X[:3, :3]
    turned = ca.vertcat(c * R[0, :] + s * R[1, :], c * R[1, :] - s * R[0, :], R[2, :])
    return _Facing(phi1, out - g.a1, z - g.d1, turned, gap)


def _two_links(
    a2: float, length: float, u: ca.SX, v: ca.SX
) -> tuple[list[tuple[ca.SX, ca.SX]], ca.SX]:
    """(upper arm, bend) for both elbows of a planar arm that reaches (u, v), angles from the
    upright; and by how much it does not."""
    square = u * u + v * v
    distance = ca.sqrt(square)
    gap = ca.fmax(distance - (a2 + length), abs(a2 - length) - distance)
    cosine = ca.fmax(ca.fmin((square - (a2**2 + length**2)) * (0.5 / (a2 * length)), 1), -1)
    sine = ca.sqrt((1 - cosine) * (1 + cosine))
    bend = ca.atan2(sine, cosine)
    aim = ca.atan2(u, v)
    inner = ca.atan2(length * sine, a2 + length * cosine)
    return [(aim - inner, bend), (aim + inner, -bend)], gap


@dataclass(frozen=True)
class _Wrist:
    """Axis 4 for one sign of phi5; the other flip has phi4 + half, -phi5 and phi6 + half."""

    phi4: ca.SX
    c4: ca.SX
    """times length, as s4"""
    s4: ca.SX
    length: ca.SX
    """sin phi5; 1 in a straight wrist"""
    s5: ca.SX
    half: ca.SX
    """pi; 0 in a straight wrist, where phi4 is the seed's for both"""


def _wrist(w_x: ca.SX, w_y: ca.SX, phi4_seed: ca.SX) -> _Wrist:
    """From w = s5 (c4, s4), s5 > 0."""
    s5 = ca.sqrt(w_x * w_x + w_y * w_y)
    bent = s5 > WRIST_EPSILON
    return _Wrist(
        ca.if_else(bent, ca.atan2(w_y, w_x), phi4_seed),
        ca.if_else(bent, w_x, ca.cos(phi4_seed)),
        ca.if_else(bent, w_y, ca.sin(phi4_seed)),
        ca.if_else(bent, s5, 1),
        s5,
        np.pi * bent,
    )


def _spherical(g: ArmGeometry, at: _Facing, phi4_seed: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
    """(phi, gap) of elbow and flip. With z = axis 6 in the forearm frame (-c4 s5, c5, s4 s5), w =
    s5 (c4, s4) = (-z_x, z_z)."""
    elbows, gap = _two_links(g.a2, g.forearm, at.u, at.v)
    gamma = np.arctan2(g.d4, g.a3)
    found = []
    for phi2, bend in elbows:
        phi3 = phi2 + bend - gamma
        c3 = ca.cos(phi3)
        s3 = ca.sin(phi3)
        # the frame of W in the forearm's: x3 = (s3, 0, c3), y3 = (c3, 0, -s3), z3 = y of the plane
        R = ca.vertcat(
            s3 * at.R[0, :] + c3 * at.R[2, :], c3 * at.R[0, :] - s3 * at.R[2, :], at.R[1, :]
        )
        wrist = _wrist(-R[0, 2], R[2, 2], phi4_seed)
        c5 = R[1, 2]
        phi5 = ca.atan2(wrist.s5, c5)
        # both times the wrist's length, which the angle does not see
        along = wrist.c4 * R[0, 0] - wrist.s4 * R[2, 0]
        across = wrist.s4 * R[0, 0] + wrist.c4 * R[2, 0]
        phi6 = ca.atan2(across, -c5 * along - wrist.s5 * wrist.length * R[1, 0])
        arm = ca.vertcat(at.phi1, phi2, phi3)
        found.append((ca.vertcat(arm, wrist.phi4, phi5, phi6), gap))
        found.append((ca.vertcat(arm, wrist.phi4 + wrist.half, -phi5, phi6 + wrist.half), gap))
    return found


def _parallel(g: ArmGeometry, at: _Facing, phi4_seed: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
    """(phi, gap) of elbow and flip. Axis 6 is cos phi5 y - sin phi5 (cos phi4, -sin phi4) in the
    plane."""
    wrist = _wrist(-at.R[0, 2], at.R[2, 2], phi4_seed)
    phi5 = ca.atan2(wrist.s5, at.R[1, 2])
    # x of W's frame against axis 5 and against axis 6 x axis 5, times the wrist's length
    x5 = wrist.s4 * at.R[0, 0] + wrist.c4 * at.R[2, 0]
    y_W = wrist.s4 * at.R[0, 1] + wrist.c4 * at.R[2, 1]
    phi6 = ca.atan2(-y_W, x5)
    u = (g.d4 * wrist.s4 + g.e4 * wrist.c4) / wrist.length
    v = (g.d4 * wrist.c4 - g.e4 * wrist.s4) / wrist.length
    opposite = 1 - wrist.half * (2 / np.pi)
    flips: list[list[tuple[ca.SX, ca.SX]]] = []
    for sign, half in ((1, 0), (opposite, wrist.half)):
        elbows, gap = _two_links(g.a2, g.a3, at.u - sign * u, at.v - sign * v)
        last = ca.vertcat(wrist.phi4 + half, -phi5 if flips else phi5, phi6 + half)
        flips.append([(ca.vertcat(at.phi1, p2, p2 + bend, last), gap) for p2, bend in elbows])
    return [flips[flip][elbow] for elbow in (0, 1) for flip in (0, 1)]


def _wrap(angle: ca.SX) -> ca.SX:
    """Into (-pi, pi]."""
    return angle - _TURN * ca.ceil((angle - np.pi) * (1 / _TURN))
