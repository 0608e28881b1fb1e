"""Frames of the chain and the Jacobian (eqs. 1-33)."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.model.chain import cos_sin
from irb2400_ctrl.robot import Robot


def rotation_z(c: ca.SX, s: ca.SX) -> ca.SX:
    """Rotation about z from cosine and sine, shape (3, 3)."""
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))


def joint_transforms(robot: Robot, q: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
    """(R, p) of frame i in frame i - 1, i = 1…n (eqs. 2-8): rotation (3, 3) and position (3,)
    [m]."""
    transforms = []
    for link, (c, s) in zip(robot.links, cos_sin(robot.A, robot.offset, q), strict=True):
        X = ca.DM(link.frame.matrix())
        transforms.append((ca.SX(X[:3, :3]) @ rotation_z(c, s), ca.SX(X[:3, 3])))
    return transforms


def homogeneous(R: ca.SX, p: ca.SX) -> ca.SX:
    """[[R, p], [0, 1]], shape (4, 4)."""
    return ca.vertcat(ca.horzcat(R, p), ca.horzcat(0, 0, 0, 1))


def link_poses(robot: Robot, q: ca.SX) -> list[ca.SX]:
    """X_B1 … X_Bn, the frames of the links in the base (eq. 13), each (4, 4)."""
    X = ca.SX.eye(4)
    poses = []
    for R, p in joint_transforms(robot, q):
        X = X @ homogeneous(R, p)
        poses.append(X)
    return poses


def flange_pose(robot: Robot, q: ca.SX) -> ca.SX:
    """X_BF, frame 7 (tool 0) in the base (eqs. 9, 13), shape (4, 4)."""
    return link_poses(robot, q)[-1] @ ca.SX(ca.DM(robot.flange.matrix()))


def tcp_pose(robot: Robot, q: ca.SX) -> ca.SX:
    """X_BT, the TCP in the base (eqs. 12-26), shape (4, 4)."""
    return flange_pose(robot, q) @ ca.SX(ca.DM(robot.X_FT))


def point_jacobian(robot: Robot, q: ca.SX, point: ca.SX, link: int) -> ca.SX:
    """Jacobian of a point fixed to link 1…n, base frame, shape (6, n): linear rows, then angular
    (eqs. 27-33).

    Serial columns are [z_i x (p - o_i); z_i] (eq. 32); q moves the joints through theta = A q, so
    J_q = J_theta A. For q2 this leaves z_2 x (o_3 - o_2) and no rotation: the parallelogram column
    of eq. 33.

    Args:
        robot: the arm.
        q: angles of the axes [rad], shape (n,), symbols.
        point: in the base frame [m], shape (3,).
        link: that carries it, 1 to n.
    """
    columns = []
    for i, X in enumerate(link_poses(robot, q)):
        if i < link:
            z = X[:3, 2]
            columns.append(ca.vertcat(ca.cross(z, point - X[:3, 3]), z))
        else:
            columns.append(ca.SX(6, 1))
    return ca.horzcat(*columns) @ ca.DM(robot.A)


def tcp_jacobian(robot: Robot, q: ca.SX) -> ca.SX:
    """Jacobian of the TCP, base frame, shape (6, n): linear rows, then angular (eq. 33)."""
    return point_jacobian(robot, q, tcp_pose(robot, q)[:3, 3], robot.n)
