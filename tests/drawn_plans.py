"""Tool paths drawn at random, and what the file of a plan needs, by another engine than the
planner's."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from independent_plant import native
from independent_plant.parameters import paper_arm
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from irb2400_ctrl.planners import Plan, ToolPath
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.robot import Robot

Array = NDArray[np.float64]

RATE = 10_000.0
"""looks per second"""


def drawn_path(seed: int) -> ToolPath:
    """A polygon, a spline, a circle or a zigzag somewhere in front of the arm, with a feed or
    without."""
    rng = np.random.default_rng(seed)
    centre = np.array([rng.uniform(0.75, 1.15), rng.uniform(-0.4, 0.4), rng.uniform(0.35, 0.9)])
    feed = float(rng.choice([np.inf, rng.uniform(0.05, 0.5)]))
    tilt = rng.normal(size=3) * 0.2 + np.array([0.0, 0.0, 1.0])
    axis = tilt / np.linalg.norm(tilt)
    kind = rng.choice(["polygon", "spline", "circle", "zigzag"])
    if kind == "circle":
        return builders.circle(centre, rng.uniform(0.03, 0.15), axis=axis, feed=feed)
    if kind == "spline":
        points = centre + rng.uniform(-0.12, 0.12, (int(rng.integers(3, 6)), 3))
        return builders.spline(points, axis, feed=feed)
    if kind == "zigzag":
        way = np.arange(int(rng.integers(4, 12)))
        length = rng.uniform(0.02, 0.15)
        pitch = rng.uniform(0.001, 0.01)
        points = centre + np.stack([length * (way % 2), pitch * way, 0 * way], axis=1)
        return builders.way_points(points, axis, feed=feed)
    points = centre + rng.uniform(-0.1, 0.1, (int(rng.integers(2, 7)), 3))
    return builders.way_points(points, axis, feed=feed)


@dataclass(frozen=True)
class Looked:
    """Largest values of a written file, looked at 10,000 times a second."""

    torque: float
    """|tau| over the robot's own limit"""
    velocity: float
    """|qd| over the robot's own limit"""
    feed: float
    """speed of the TCP, from place to place, over the feed; zero without one"""
    deviation: float
    """distance of the TCP from the polygon of way-points [m]"""

    def above(self, plan: Plan) -> list[str]:
        """What lies above the plan's bounds."""
        bounds = {
            "torque": plan.max_torque_ratio,
            "velocity": plan.max_velocity_ratio,
            "feed": plan.max_feed_ratio or 0.0,
            "deviation": plan.max_tcp_deviation,
        }
        return [name for name, most in bounds.items() if getattr(self, name) > most + 1e-9]


def looked_at(plan: Plan, robot: Robot, folder: Path) -> Looked:
    """Write the plan, read its file back as numbers, and follow it as the interpolation says."""
    file = plan.write(folder)[0]
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    time = table[:, 0]
    q, qd, qdd = (np.radians(table[:, 1 + 6 * k : 7 + 6 * k]) for k in range(3))
    at = np.arange(0.0, time[-1], 1 / RATE)
    if plan.interpolation == "linear":
        motion = [_straight(at, time, column) for column in (q, qd, qdd)]
    else:
        cubic = CubicHermiteSpline(time, q, qd)
        motion = [cubic(at), cubic(at, 1), cubic(at, 2)]
    arm = paper_arm().packed()
    tau = native.inverse_dynamics(arm, *motion) + _friction(robot, motion[1])
    tip = native.tool_tip(motion[0])
    feed = float(np.min(plan.path.feed))
    speed = np.linalg.norm(np.diff(tip, axis=0), axis=1).max() * RATE
    return Looked(
        torque=float((np.abs(tau) / robot.tau_max).max()),
        velocity=float((np.abs(motion[1]) / robot.qd_max).max()),
        feed=float(speed / feed) if np.isfinite(feed) else 0.0,
        deviation=_from_polygon(tip, plan.path.position),
    )


def _straight(at: Array, time: Array, values: Array) -> Array:
    return np.stack([np.interp(at, time, column) for column in values.T], axis=1)


def _friction(robot: Robot, qd: Array) -> Array:
    """Friction of eq. 55 [Nm]."""
    static, coulomb, viscous, stribeck = robot.friction.T
    level = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
    return np.asarray(level * np.sign(qd) + viscous * qd)


def _from_polygon(points: Array, corners: Array) -> float:
    """Largest distance of points from the nearest side [m]."""
    nearest = np.full(len(points), np.inf)
    for start, end in pairwise(corners):
        side = end - start
        part = np.clip((points - start) @ side / max(side @ side, 1e-30), 0, 1)
        off = points - start - part[:, None] * side
        nearest = np.minimum(nearest, np.einsum("ij,ij->i", off, off))
    return float(np.sqrt(nearest.max()))
