"""The paper's dynamic equations 46-68 about the centres of mass, in numpy, with their slips as
switches.

Independent of the library's recursion: link poses from eqs. 3-9, angular quantities in the base
frame (eqs. 65, 66), one link after another, moments about the joints by eqs. 58-61.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from model import printed_kinematics as eq

import irb2400_ctrl as irb

Array = npt.NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
G = 9.81


@dataclass(frozen=True)
class Print:
    """Which printed form to use instead of the corrected one."""

    gravity_without_transpose: bool = False  # eq. 64
    friction_carried_down: bool = False  # eqs. 59, 61
    force_of_the_next_link_as_described: bool = False  # text below Fig. 6 against eq. 58
    kinetic_rotation_not_halved: bool = False  # eq. 46
    friction: Array = field(default_factory=lambda: np.zeros(6))


@dataclass(frozen=True)
class Bodies:
    """Mass, centre of mass and tensor of links 1-6 and of the tool (frame 7)."""

    mass: Array
    com: Array
    tensor: Array

    @classmethod
    def of(cls, robot: irb.Robot) -> Bodies:
        assert robot.tool is not None
        bodies = [*(link.body for link in robot.links), robot.tool.body]
        return cls(
            np.array([b.mass_kg for b in bodies]),
            np.array([b.com_m for b in bodies]),
            np.array([b.tensor() for b in bodies]),
        )


def poses(q: Array) -> list[Array]:
    """X_B1 … X_B7 (eq. 13)."""
    v = eq.Angles.of(q)
    X = np.eye(4)
    found = []
    for factor in (eq.eq_3, eq.eq_4, eq.eq_5, eq.eq_6, eq.eq_7, eq.eq_8, eq.eq_9):
        X = X @ factor(v)
        found.append(X)
    return found


def motion(robot: irb.Robot, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
    """(omega, epsilon, acceleration of the origin) of frames 1-7 in the base, shape (7, 3) each."""
    rate = robot.A @ qd
    rate2 = robot.A @ qdd
    w = np.zeros(3)
    eps = np.zeros(3)
    a = np.zeros(3)
    o = np.zeros(3)
    rows = []
    for i, X in enumerate(poses(q)):
        step = X[:3, 3] - o
        a = a + np.cross(eps, step) + np.cross(w, np.cross(w, step))
        o = X[:3, 3]
        if i < 6:
            z = X[:3, 2]
            eps = eps + z * rate2[i] + np.cross(w, z * rate[i])
            w = w + z * rate[i]
        rows.append((w, eps, a))
    omega, epsilon, acceleration = (np.array(column) for column in zip(*rows, strict=True))
    return omega, epsilon, acceleration


def joint_torques(
    robot: irb.Robot, q: Array, qd: Array, qdd: Array, form: Print | None = None
) -> Array:
    """tau_zi of eqs. 57-68: projections on the joint axes, friction included, without A^T; shape
    (6,)."""
    form = Print() if form is None else form
    bodies = Bodies.of(robot)
    X = poses(q)
    omega, epsilon, acceleration = motion(robot, q, qd, qdd)
    R = [pose[:3, :3] for pose in X]
    sign = -1.0 if form.force_of_the_next_link_as_described else 1.0
    f = np.zeros(3)
    tau = np.zeros(3)
    result = np.zeros(6)
    for i in reversed(range(7)):
        w = R[i].T @ omega[i]  # eq. 65
        eps = R[i].T @ epsilon[i]  # eq. 66
        r = bodies.com[i]
        a_S = R[i].T @ acceleration[i] + np.cross(eps, r) + np.cross(w, np.cross(w, r))  # eq. 68
        g = -(R[i] if form.gravity_without_transpose else R[i].T) @ (G * UP)  # eq. 64
        if i == 6:
            f = bodies.mass[i] * a_S - bodies.mass[i] * g  # eq. 62
            tau = (
                bodies.tensor[i] @ eps + np.cross(w, bodies.tensor[i] @ w) - np.cross(f, r)
            )  # eq. 63
            continue
        R_next = R[i].T @ R[i + 1]
        r_next = r - R[i].T @ (X[i + 1][:3, 3] - X[i][:3, 3])  # eq. 67
        later = sign * R_next @ f
        f = bodies.mass[i] * a_S + later - bodies.mass[i] * g  # eq. 60
        rigid = (
            bodies.tensor[i] @ eps
            + np.cross(w, bodies.tensor[i] @ w)
            + sign * R_next @ tau
            - np.cross(f, r)
            + np.cross(later, r_next)
        )  # eq. 61
        tau = rigid + (form.friction[i] * UP if form.friction_carried_down else 0.0)
        result[i] = rigid[2] + form.friction[i]
    return result


def kinetic_energy(robot: irb.Robot, q: Array, qd: Array, form: Print | None = None) -> float:
    """K of eq. 46, summed over the links and the tool."""
    form = Print() if form is None else form
    bodies = Bodies.of(robot)
    X = poses(q)
    omega, _, _ = motion(robot, q, qd, np.zeros(6))
    half = 1.0 if form.kinetic_rotation_not_halved else 0.5
    K = 0.0
    step = 1e-6
    before = poses(q - step * qd)
    after = poses(q + step * qd)
    for i in range(7):
        place = np.array([*bodies.com[i], 1.0])
        v = ((after[i] - before[i]) @ place)[:3] / (2 * step)
        w = X[i][:3, :3].T @ omega[i]
        K += 0.5 * bodies.mass[i] * v @ v + half * w @ bodies.tensor[i] @ w
    return K


def potential_energy_printed(robot: irb.Robot, q: Array) -> float:
    """P of eq. 48 with g the gravity vector of eqs. 58-64 (pointing down)."""
    bodies = Bodies.of(robot)
    down = -G * UP
    return float(
        sum(
            m * down @ (X @ [*c, 1.0])[:3]
            for m, c, X in zip(bodies.mass, bodies.com, poses(q), strict=True)
        )
    )
