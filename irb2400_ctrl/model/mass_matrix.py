"""Mass matrix by the composite-rigid-body algorithm in groups of parallel axes, and the solve with
it."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.model.arm import arm_of
from irb2400_ctrl.model.chain import Chain, CosSin, turned, turned_back
from irb2400_ctrl.model.linear_solve import solve_ldl as solve_ldl
from irb2400_ctrl.robot import Robot


def mass_matrix(
    robot: Robot,
    q: ca.SX,
    phi: ca.SX | ca.DM | None = None,
    added: ca.SX | None = None,
) -> ca.SX:
    """M(q) = B^T M_phi B (eq. 50), shape (n, n) [kg m2].

    Composite bodies are gathered from the tip as pseudo-inertias. Column i is the wrench of the
    composite body under unit acceleration of phi_i, carried down to the joints below it. In a group
    of parallel axes phi_i turns link i alone and shifts the later ones. `phi` and `added` as in
    `newton_euler.inverse_dynamics`.

    Args:
        robot: the arm.
        q: angles of the axes [rad], shape (n,), symbols.
    """
    arm = arm_of(robot, phi, added)
    chain = arm.chain
    bodies = arm.bodies
    turns = chain.cos_sin(q)
    B = ca.DM(chain.B)
    M = ca.SX(robot.n, robot.n)
    beyond = ca.SX(4, 4)
    for g, group in reversed(list(enumerate(chain.groups))):
        later_G = ca.SX(4, 4)
        for i in reversed(group.links):
            if i == group.links[-1]:
                body = bodies[i] + beyond
                later = ca.SX(4, 4)
                step = ca.SX(3, 1)
            else:
                body = bodies[i]
                later = later_G
                step = ca.SX(ca.DM(group.steps[i - group.links.start]))
            f, n, M[i, i] = _unit_turn(turns[i], body, later, step)
            for j, value in _carried_down(chain, turns, g, i, f, n):
                M[i, j] = M[j, i] = value
            later_G = _turned_body(turns[i], body) + _shifted(later, turned(turns[i], step))
        X = ca.SX(ca.DM(group.R))
        beyond = _shifted(_rotated(X, later_G), ca.SX(ca.DM(group.p)))
    return B.T @ M @ B


def _unit_turn(turn: CosSin, J: ca.SX, later: ca.SX, step: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(force, moment, own torque) under unit acceleration of phi, in the group's frame about the
    link's origin.

    `later` is the composite of the later links of the group about the end of `step`: it is shifted,
    not turned.
    """
    shift = ca.vertcat(-step[1], step[0], 0)
    force = ca.vertcat(-J[1, 3], J[0, 3], 0) + later[3, 3] * shift
    moment = ca.vertcat(-J[0, 2], -J[1, 2], J[0, 0] + J[1, 1]) + later[3, 3] * ca.cross(step, shift)
    own = moment[2]
    return (
        turned(turn, force),
        turned(turn, moment) + ca.cross(later[:3, 3], turned(turn, shift)),
        own,
    )


def _carried_down(
    chain: Chain, turns: list[CosSin], g: int, i: int, f: ca.SX, n: ca.SX
) -> list[tuple[int, ca.SX]]:
    """(j, generalised force on phi_j) for all joints below link i of group g, from its wrench in
    the group's frame."""
    entries = []
    above = i
    for k in reversed(range(g + 1)):
        group = chain.groups[k]
        if k < g:
            above = group.links[-1]
            entries.append((above, n[2]))
            f = turned(turns[above], f)
            n = turned(turns[above], n)
        for j in reversed(range(group.links.start, above)):
            step = ca.SX(ca.DM(group.steps[j - group.links.start]))
            local = turned_back(turns[j], f)
            entries.append((j, step[0] * local[1] - step[1] * local[0]))
            n = n + ca.cross(turned(turns[j], step), f)
        R = ca.SX(ca.DM(group.R))
        f = R @ f
        n = R @ n
        n = n + ca.cross(ca.SX(ca.DM(group.p)), f)
    return entries


def _turned_body(turn: CosSin, J: ca.SX) -> ca.SX:
    """Rz J Rz^T, by the double-angle form of a turn about z."""
    c, s = turn
    xy2 = J[0, 1] + J[0, 1]
    t = s * (J[0, 0] - J[1, 1]) + c * xy2
    xx = J[0, 0] - s * t
    yy = J[1, 1] + s * t
    xy = c * t - J[0, 1]
    xz, yz, _ = ca.vertsplit(turned(turn, ca.vertcat(J[0, 2], J[1, 2], 0)))
    first = turned(turn, J[:3, 3])
    return ca.vertcat(
        ca.horzcat(xx, xy, xz, first[0]),
        ca.horzcat(xy, yy, yz, first[1]),
        ca.horzcat(xz, yz, J[2, 2], first[2]),
        ca.horzcat(first.T, J[3, 3]),
    )


def _rotated(R: ca.SX, J: ca.SX) -> ca.SX:
    """J in a frame turned by a constant rotation."""
    X = ca.diagcat(R, 1)
    return X @ J @ X.T


def _shifted(J: ca.SX, p: ca.SX) -> ca.SX:
    """J about a point from which the origin is at p."""
    mc = J[:3, 3]
    moved = ca.SX(J)
    moved[:3, :3] = J[:3, :3] + p @ mc.T + mc @ p.T + J[3, 3] * p @ p.T
    moved[:3, 3] = mc + J[3, 3] * p
    moved[3, :3] = moved[:3, 3].T
    return moved
