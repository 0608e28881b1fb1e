"""Inverse dynamics by the Newton-Euler recursion (eqs. 57-68), written for few operations.

A body with pseudo-inertia [[Sigma, mc], [mc^T, m]] about its link's origin, whose points have the
acceleration a + U r with U = [eps]x + [w]x [w]x (eq. 68), needs (eqs. 58-61 about the origin
instead of the centre of mass)

    f = m a + U mc,    n = mc x a + vee(U Sigma - Sigma U^T).

Gravity enters as an upward acceleration of the base (eq. 64). Links go in groups of parallel axes
(`chain`): the force of a link is carried along the group, its moment goes to the group's frame at
once, because a link of the group shifts the later ones without turning them.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from irb2400_ctrl.model.arm import Arm, arm_of
from irb2400_ctrl.model.chain import CosSin, turned, turned_back
from irb2400_ctrl.robot import Robot

Wrench = tuple[ca.SX, ca.SX]
"""force and moment"""


def inverse_dynamics(
    robot: Robot,
    q: ca.SX,
    qd: ca.SX,
    qdd: ca.SX,
    phi: ca.SX | ca.DM | None = None,
    gravity: ca.SX | ca.DM | None = None,
    added: ca.SX | None = None,
) -> ca.SX:
    """Rigid-body torque of the actuators, no friction, no effects, shape (n,) [Nm] (eqs. 57, 60,
    61).

    The moment on a link is projected on its joint's axis (eq. 57) and tau = B^T tau_phi. Gravity is
    an upward acceleration of the base, which every frame sees turned by (R_i^B)^T (eq. 64). The
    step to the next joint is that of eq. 67. Friction is no part of the recursion: carried down as
    eq. 61 prints it, it would load the joints below.

    Args:
        q, qd, qdd: actuator angles, speeds, accelerations [rad, rad/s, rad/s2], shape (n,).
        phi: inertial parameters (m, mc, I_O) of each link, shape (n, 10); default those of the
            robot.
        gravity: gravity in the base frame [m/s2], shape (3,); default the robot's.
        added: (m, mc, I_O) of a body more on each link, in its frame, shape (n, 10).
    """
    return recursion(robot, q, qd, qdd, phi, gravity, added).tau


@dataclass
class Recursion:
    """What the recursion has come by: the torque, and its steps by name."""

    arm: Arm
    tau: ca.SX
    """shape (n,) [Nm]"""
    steps: dict[str, ca.SX]
    """name and number of the link, `w3` -> expression"""

    def meaning(self, step: str) -> tuple[str, str]:
        """Unit of a step, and what it is."""
        name = step.rstrip("0123456789")
        unit, words = STEPS[name]
        return unit, words.format(link=step.removeprefix(name), unit=self.arm.length)


STEPS = {
    "w": ("rad/s", "angular velocity of link {link}, in its frame (eq. 65)"),
    "eps": ("rad/s2", "angular acceleration of link {link} (eq. 66)"),
    "U": ("1/s2", "[eps]x + [w]x [w]x of link {link} (eq. 68)"),
    "a": (
        "1/s2",
        "acceleration of link {link}'s origin less gravity, over {unit:.4g} m (eqs. 64, 67)",
    ),
    "f": ("Nm", "force that body {link} needs, times {unit:.4g} m (eq. 58)"),
    "n": ("Nm", "moment that body {link} needs, about its origin (eq. 59)"),
    "f_sum": ("Nm", "force at joint {link}, in its group's frame, times {unit:.4g} m (eq. 60)"),
    "n_sum": ("Nm", "moment at joint {link}, in its group's frame (eq. 61)"),
}
"""name of a step of the recursion -> unit, what it is"""


def recursion(
    robot: Robot,
    q: ca.SX,
    qd: ca.SX,
    qdd: ca.SX,
    phi: ca.SX | ca.DM | None = None,
    gravity: ca.SX | ca.DM | None = None,
    added: ca.SX | None = None,
) -> Recursion:
    """`inverse_dynamics` with its steps."""
    arm = arm_of(robot, phi, added)
    B = ca.DM(arm.chain.B)
    gravity = ca.DM(robot.gravity) if gravity is None else gravity
    turns = arm.chain.cos_sin(q)
    steps = dict[str, ca.SX]()
    wrenches = _outwards(arm, turns, B @ qd, B @ qdd, ca.SX(-gravity / arm.length), steps)
    return Recursion(arm, B.T @ _inwards(arm, turns, wrenches, steps), steps)


def _outwards(
    arm: Arm,
    turns: list[CosSin],
    rate: ca.SX,
    rate2: ca.SX,
    a: ca.SX,
    steps: dict[str, ca.SX],
) -> list[Wrench]:
    """Force and moment that each body needs, from the base to the tip.

    Args:
        a: acceleration of the base.
        steps: is told the steps.
    """
    wrenches = []
    w = ca.SX(3, 1)
    eps = ca.SX(3, 1)
    U = ca.SX(3, 3)
    for group in arm.chain.groups:
        R = ca.SX(ca.DM(group.R))
        a_G = R.T @ (a + U @ ca.DM(group.p))
        w_G = R.T @ w
        eps_G = R.T @ eps
        for i in group.links:
            w, eps = _turning(turns[i], w_G, eps_G, rate[i], rate2[i])
            motion = _Motion.of(w, eps)
            U = motion.U
            a = turned_back(turns[i], a_G)
            wrenches.append(_wrench(arm.bodies[i], motion, a))
            told = (w, eps, U, a, *wrenches[-1])
            steps |= {f"{name}{i + 1}": x for name, x in zip(STEPS, told, strict=False)}
            if i + 1 in group.links:
                a_G = a_G + turned(turns[i], U @ ca.DM(group.steps[i - group.links.start]))
    return wrenches


def _inwards(
    arm: Arm, turns: list[CosSin], wrenches: list[Wrench], steps: dict[str, ca.SX]
) -> ca.SX:
    """Torque about each joint's axis, from the tip to the base; each group carries what the later
    ones need."""
    tau = ca.SX(len(wrenches), 1)
    f = ca.SX(3, 1)
    n = ca.SX(3, 1)
    for group in reversed(arm.chain.groups):
        last = group.links[-1]
        f_G = ca.SX(3, 1)
        n_G = ca.SX(3, 1)
        for i in reversed(group.links):
            force, moment = wrenches[i]
            if i == last:
                force = force + f
                moment = moment + n
            tau[i] = moment[2]
            if i != last:
                step = ca.DM(group.steps[i - group.links.start])
                f_i = turned_back(turns[i], f_G)
                tau[i] += step[0] * f_i[1] - step[1] * f_i[0]
                n_G += ca.cross(turned(turns[i], ca.SX(step)), f_G)
            f_G = f_G + turned(turns[i], force)
            n_G = n_G + turned(turns[i], moment)
            steps |= {f"f_sum{i + 1}": f_G, f"n_sum{i + 1}": n_G}
        R = ca.SX(ca.DM(group.R))
        f = R @ f_G
        n = R @ n_G
        n += ca.cross(ca.SX(ca.DM(group.p)), f)
    return tau


def _turning(
    turn: CosSin, w_G: ca.SX, eps_G: ca.SX, rate: ca.SX, rate2: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Angular velocity and acceleration of a link that turns in frame G (eqs. 65, 66), in the
    link's frame."""
    w = turned_back(turn, w_G)
    gyroscopic = ca.vertcat(w[1] * rate, -w[0] * rate, 0)
    z = ca.vertcat(0, 0, 1)
    return w + rate * z, turned_back(turn, eps_G) + gyroscopic + rate2 * z


@dataclass(frozen=True)
class _Motion:
    """U = [eps]x + [w]x [w]x and the differences of its diagonal, which cost less from the
    squares."""

    U: ca.SX
    differences: tuple[ca.SX, ca.SX, ca.SX]
    """U_zz - U_yy, U_xx - U_zz, U_yy - U_xx"""

    @classmethod
    def of(cls, w: ca.SX, eps: ca.SX) -> _Motion:
        x = w[0]
        y = w[1]
        z = w[2]
        xx = x * x
        yy = y * y
        zz = z * z
        xy = x * y
        xz = x * z
        yz = y * z
        U = ca.vertcat(
            ca.horzcat(-(yy + zz), xy - eps[2], xz + eps[1]),
            ca.horzcat(xy + eps[2], -(xx + zz), yz - eps[0]),
            ca.horzcat(xz - eps[1], yz + eps[0], -(xx + yy)),
        )
        return cls(U, (zz - yy, xx - zz, yy - xx))


def _wrench(J: ca.SX, motion: _Motion, a: ca.SX) -> Wrench:
    """Force and moment about the link's origin that the body needs, in the link's frame (eqs. 58,
    59, 68).

    The tool is a part of the last body, so the recursion needs no start of its own (eqs. 62, 63).
    """
    U = motion.U
    (zy, xz, yx) = motion.differences
    S = J[:3, :3]
    mc = J[:3, 3]
    force = J[3, 3] * a + U @ mc
    # vee(U S - S U^T), the products of each off-diagonal second moment gathered
    euler = ca.vertcat(
        S[1, 1] * U[2, 1]
        - S[2, 2] * U[1, 2]
        + S[0, 1] * U[2, 0]
        - S[0, 2] * U[1, 0]
        + S[1, 2] * zy,
        S[2, 2] * U[0, 2]
        - S[0, 0] * U[2, 0]
        + S[1, 2] * U[0, 1]
        - S[0, 1] * U[2, 1]
        + S[0, 2] * xz,
        S[0, 0] * U[1, 0]
        - S[1, 1] * U[0, 1]
        + S[0, 2] * U[1, 2]
        - S[1, 2] * U[0, 2]
        + S[0, 1] * yx,
    )
    return force, ca.cross(mc, a) + euler
