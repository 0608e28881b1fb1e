"""Closed-form inverse kinematics of both families of `geometry`, as one CasADi function.

The wrist centre W gives phi1 (two ways to face it); spherical wrists then have two elbows and two
flips of the wrist, arms of parallel axes two signs of phi5 and two elbows for each. Eight branches
in all, numbered 4 * rear + 2 * elbow + flip; flip is the sign of sin phi5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

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
_BOX_TOLERANCE = 1e-9
_TURN = 2 * np.pi
_MOST_TURNS = 16


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
    c = ca.cos(phi1)
    s = ca.sin(phi1)
    R = X[:3, :3]
    turned = ca.vertcat(c * R[0, :] + s * R[1, :], c * R[1, :] - s * R[0, :], R[2, :])
    return _Facing(phi1, out - g.a1, z - g.d1, turned, gap)


def _two_links(
    a2: float, length: float, u: ca.SX, v: ca.SX
) -> tuple[list[tuple[ca.SX, ca.SX]], ca.SX]:
    """(upper arm, bend) for both elbows of a planar arm that reaches (u, v), angles from the
    upright; and by how much it does not."""
    distance = ca.sqrt(u * u + v * v)
    gap = ca.fmax(distance - (a2 + length), abs(a2 - length) - distance)
    cosine = (distance**2 - a2**2 - length**2) / (2 * a2 * length)
    bend = ca.acos(ca.fmax(ca.fmin(cosine, 1), -1))
    aim = ca.atan2(u, v)
    inner = ca.atan2(length * ca.sin(bend), a2 + length * ca.cos(bend))
    return [(aim - inner, bend), (aim + inner, -bend)], gap


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
        w_x = -R[0, 2]
        w_y = R[2, 2]
        c5 = R[1, 2]
        s5 = ca.sqrt(w_x * w_x + w_y * w_y)
        for sign in (1, -1):
            free = ca.atan2(sign * w_y, sign * w_x)
            phi4 = ca.if_else(s5 > WRIST_EPSILON, free, phi4_seed)
            phi5 = ca.atan2(sign * s5, c5)
            c4 = ca.cos(phi4)
            s4 = ca.sin(phi4)
            along = c4 * R[0, 0] - s4 * R[2, 0]
            across = -s4 * R[0, 0] - c4 * R[2, 0]
            phi6 = ca.atan2(-across, -ca.cos(phi5) * along - ca.sin(phi5) * R[1, 0])
            found.append((ca.vertcat(at.phi1, phi2, phi3, phi4, phi5, phi6), gap))
    return found


def _parallel(g: ArmGeometry, at: _Facing, phi4_seed: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
    """(phi, gap) of elbow and flip. Axis 6 is cos phi5 y - sin phi5 (cos phi4, -sin phi4) in the
    plane."""
    z_x = at.R[0, 2]
    z_y = at.R[1, 2]
    z_z = at.R[2, 2]
    s5 = ca.sqrt(z_x * z_x + z_z * z_z)
    flips = []
    for sign in (1, -1):
        free = ca.atan2(sign * z_z, -sign * z_x)
        phi4 = ca.if_else(s5 > WRIST_EPSILON, free, phi4_seed)
        phi5 = ca.atan2(sign * s5, z_y)
        c4 = ca.cos(phi4)
        s4 = ca.sin(phi4)
        # x of W's frame against axis 5 and against axis 6 x axis 5
        x5 = s4 * at.R[0, 0] + c4 * at.R[2, 0]
        y_W = s4 * at.R[0, 1] + c4 * at.R[2, 1]
        phi6 = ca.atan2(-y_W, x5)
        u = at.u - g.d4 * s4 - g.e4 * c4
        v = at.v - g.d4 * c4 + g.e4 * s4
        elbows, gap = _two_links(g.a2, g.a3, u, v)
        flips.append(
            [
                (ca.vertcat(at.phi1, phi2, phi2 + bend, phi4, phi5, phi6), gap)
                for phi2, bend in elbows
            ]
        )
    return [flips[flip][elbow] for elbow in (0, 1) for flip in (0, 1)]


def _wrap(angle: ca.SX) -> ca.SX:
    """Into (-pi, pi]."""
    return angle - 2 * np.pi * ca.ceil((angle - np.pi) / (2 * np.pi))


def boxed(function: ca.Function, q_min: Array, q_max: Array) -> ca.Function | None:
    """(X_BF, seed) -> (q (6, 8 k), fits (8 k,), overreach (8,)): the branches with every whole turn
    that can lie in the joint box, and which of them do; None where there are too many."""
    most = np.floor((q_max - q_min + 2 * _BOX_TOLERANCE) / _TURN).astype(int) + 1
    turns = _all_turns(tuple(most.tolist()))
    if len(turns) > _MOST_TURNS:
        return None
    X_BF = ca.SX.sym("X_BF", 4, 4)
    seed = ca.SX.sym("seed", 6)
    q, overreach = function(X_BF, seed)
    low = ca.repmat(ca.DM(q_min - _BOX_TOLERANCE), 1, BRANCHES)
    lowest = q + _TURN * ca.ceil((low - q) / _TURN)
    columns = []
    fits = []
    for k in range(BRANCHES):
        for turn in turns:
            angles = lowest[:, k] + ca.DM(_TURN * turn)
            inside = overreach[k] <= 0
            for j in range(len(q_max)):
                inside = ca.logic_and(inside, angles[j] <= q_max[j] + _BOX_TOLERANCE)
            columns.append(angles)
            fits.append(inside)
    outputs = ca.cse([ca.horzcat(*columns), ca.vertcat(*fits), overreach])
    return ca.Function("boxed_inverse_kinematics", [X_BF, seed], outputs,
                       ["X_BF", "seed"], ["q", "fits", "overreach"])  # fmt: skip


def windings(q: Array, q_min: Array, q_max: Array) -> Array:
    """Every q + 2 pi k inside the joint box, shape (m, n), for branches q (b, n) [rad]."""
    first = np.ceil((q_min - _BOX_TOLERANCE - q) / _TURN)
    count = np.floor((q_max + _BOX_TOLERANCE - q) / _TURN) - first + 1.0
    # a branch that does not exist is nan, which compares false
    lowest = q + _TURN * first
    exists = (count >= 1.0).all(axis=1)
    if not exists.any():
        return np.empty((0, q.shape[1]))
    turns = _all_turns(tuple(count[exists].max(axis=0).astype(int).tolist()))
    if len(turns) == 1:
        return np.asarray(lowest[exists])
    fits = (turns < count[:, None, :]).all(axis=2)
    return np.asarray((lowest[:, None, :] + _TURN * turns)[fits])


@cache
def _all_turns(most: tuple[int, ...]) -> Array:
    """Every combination of whole turns below `most`, shape (k, n)."""
    turns = np.indices(most).reshape(len(most), -1).T.astype(float)
    turns.setflags(write=False)
    return np.asarray(turns)
