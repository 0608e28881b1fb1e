"""A reference for the smooth timing: another formulation, another discretisation, another solver
(IPOPT).

On a fine grid in s the unknowns are speed v_i, acceleration u_i and the duration dt_i of every
cell; in a cell the path jerk is constant in *time*,

    s_{i+1} - s_i = dt (v_i + dt (2 u_i + u_{i+1}) / 6),      v_{i+1} - v_i = dt (u_i + u_{i+1}) /
    2,

and torque and torque rate are demanded at both ends of every cell, from the coefficients
themselves, their derivatives by differences. Nothing is enclosed and nothing is held back: it may
be a little too fast between its points.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw

Array = npt.NDArray[np.float64]
OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "ipopt.tol": 1e-5,
    "ipopt.max_iter": 250,
    "ipopt.mu_strategy": "adaptive",
}


def reference_duration(
    dynamics: PathDynamics,
    path: JointPath,
    limits: MotionLimits,
    guess: RateLimitedLaw,
    cells: int,
    slower: float = 1.3,
) -> float:
    """Duration [s] of the nonlinear program with about so many cells, from a motion `slower` times
    as long.

    Raises:
        RuntimeError: IPOPT does not converge.
    """
    v_guess, u_guess, s = _grid(path, guess, cells)
    m = len(s) - 1
    scale_v = v_guess.max()
    scale_u = np.abs(u_guess).max()
    dt_guess = guess.duration / m
    V = ca.SX.sym("v", m + 1)
    U = ca.SX.sym("u", m + 1)
    T = ca.SX.sym("t", m)
    v = V * scale_v
    u = U * scale_u
    dt = T * dt_guess
    motion = _constant_jerk(v, u, dt, np.diff(s), scale_v)
    torque = _torque_and_rate(dynamics, path, limits, s, (v, u, dt))
    g = ca.vertcat(motion, torque)
    low = np.concatenate([np.zeros(motion.numel()), -np.ones(torque.numel())])
    high = np.concatenate([np.zeros(motion.numel()), np.ones(torque.numel())])
    lower, upper = _box(path, limits, s, scale_v)
    cost = ca.sum1(dt) / guess.duration
    program = {"x": ca.vertcat(V, U, T), "f": cost, "g": g}
    solver = ca.nlpsol("reference", "ipopt", program, OPTIONS)
    start = np.concatenate(
        [v_guess / slower / scale_v, u_guess / slower**2 / scale_u, np.full(m, slower)]
    )
    found = solver(x0=start, lbx=lower, ubx=upper, lbg=low, ubg=high)
    if not solver.stats()["success"]:
        raise RuntimeError(f"IPOPT: {solver.stats()['return_status']}")
    return float(found["f"]) * guess.duration


def _constant_jerk(v: ca.SX, u: ca.SX, dt: ca.SX, h: Array, scale_v: float) -> ca.SX:
    """Way and speed over every cell, zero where they fit."""
    m = len(h)
    u_start = u[:m]
    u_end = u[1:]
    way = dt * (v[:m] + dt * (2 * u_start + u_end) / 6)
    gained = v[1:] - v[:m] - dt * (u_start + u_end) / 2
    return ca.vertcat(way / h - 1, gained / scale_v)


def _torque_and_rate(
    dynamics: PathDynamics,
    path: JointPath,
    limits: MotionLimits,
    s: Array,
    motion: tuple[ca.SX, ca.SX, ca.SX],
) -> ca.SX:
    """Torque and torque rate of every joint over their limits, at both ends of every cell."""
    v, u, dt = motion
    m = len(s) - 1
    jerk = (u[1:] - u[:m]) / dt
    F_s, F_c, _, stribeck = dynamics.model.robot.friction.T
    sign = np.sign(_middle(path, s))
    assert limits.torque_rate is not None
    g = []
    for at, vs, us in ((0, v[:m], u[:m]), (1, v[1:], u[1:])):
        value, slope, dq = _coefficients(dynamics, path, s, at)
        a, b, e, c = value
        da, db, de, dc = slope
        for j in range(path.n):
            level = F_c[j] + max(F_s[j] - F_c[j], 0) * ca.exp(-((dq[:, j] * vs / stribeck[j]) ** 2))
            smooth = a[:, j] * us + b[:, j] * vs**2 + e[:, j] * vs + c[:, j]
            g.append((smooth + sign[:, j] * level) / limits.tau_max[j])
            rate = (
                (da[:, j] + 2 * b[:, j]) * us * vs
                + a[:, j] * jerk
                + db[:, j] * vs**3
                + dc[:, j] * vs
            )
            rate += e[:, j] * us + de[:, j] * vs**2
            g.append(rate / limits.torque_rate[j])
    return ca.vertcat(*g)


def _box(path: JointPath, limits: MotionLimits, s: Array, scale_v: float) -> tuple[Array, Array]:
    """Bounds of the unknowns: joint speeds, rest at both ends, time runs forwards."""
    m = len(s) - 1
    q_rate = np.abs(path(s, 1)) / limits.qd_max
    top = np.minimum(1 / np.maximum(q_rate.max(axis=1), 1e-9) / scale_v, 1e3)
    lower = np.concatenate([np.zeros(m + 1), np.full(m + 1, -np.inf), np.full(m, 1e-6)])
    upper = np.concatenate([top, np.full(m + 1, np.inf), np.full(m, np.inf)])
    rest = [0, m, m + 1, 2 * m + 1]
    lower[rest] = 0.0
    upper[rest] = 0.0
    return lower, upper


def _grid(path: JointPath, guess: RateLimitedLaw, cells: int) -> tuple[Array, Array, Array]:
    """Even times of a motion nearby, which makes small cells where it is slow; knots and
    reversals."""
    even = np.linspace(0.0, guess.duration, cells + 1)
    s = guess.at(even)[0]
    s[[0, -1]] = guess.s[[0, -1]]
    fixed = np.concatenate([path.knots[1:-1], path.reversals()])
    # a point next to a fixed one gives way to it
    near = np.unique(np.clip(np.searchsorted(s, fixed), 1, cells - 1))
    s = np.unique(np.concatenate([np.delete(s, near), fixed]))
    time = np.interp(s, guess.s, guess.time)
    for _ in range(60):
        at, v, _ = guess.at(time)
        time = np.clip(
            time + (s - at) / np.maximum(v, 1e-6 * np.sqrt(guess.x.max())), 0.0, guess.duration
        )
    _, v, u = guess.at(time)
    v[[0, -1]] = 0.0
    u[[0, -1]] = 0.0
    return v, u, s


def _middle(path: JointPath, s: Array) -> Array:
    middle = (s[:-1] + s[1:]) / 2
    return path(middle, 1)


def _coefficients(
    dynamics: PathDynamics, path: JointPath, s: Array, end: int
) -> tuple[list[Array], list[Array], Array]:
    """a, b, e, c and their slopes at one end of every cell, from inside the cell, and |q'| there;
    each (m, n)."""
    piece = path.piece((s[:-1] + s[1:]) / 2)
    at = s[1:] if end else s[:-1]
    step = 1e-6 * path.length

    def values(where: Array) -> list[Array]:
        a, b, e, _, c, _ = dynamics.coefficients(
            *(path.on_piece(where, piece, order) for order in (0, 1, 2))
        )[:6]
        return [np.array(f) for f in (a, b, e, c)]

    above = values(at + step)
    below = values(at - step)
    slopes = [(p - q) / (2 * step) for p, q in zip(above, below, strict=True)]
    return values(at), slopes, np.abs(path.on_piece(at, piece, 1))
