"""The named tool paths of `toolpaths.toml`."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import ToolPath
from irb2400_ctrl.planners.toolpath import builders

CASES: list[dict[str, Any]] = tomllib.loads((Path(__file__).parent / "toolpaths.toml").read_text())[
    "case"
]


def build(model: Model, kind: str, **arguments: Any) -> ToolPath:
    """The tool path of a case."""
    path: ToolPath = _BUILDERS[kind](model, **arguments)
    return path


def _points(
    model: Model, points: Any, axis: Any = (0, 0, 1), axes: Any = None, feed: float = np.inf
) -> ToolPath:
    return builders.way_points(
        np.array(points) / 1e3, axis if axes is None else axes, feed=feed / 1e3
    )


def _circle(
    model: Model, centre: Any, radius: float, start: float = 0, sweep: float = 360
) -> ToolPath:
    return builders.circle(
        np.array(centre) / 1e3, radius / 1e3, start=np.radians(start), sweep=np.radians(sweep)
    )


def _steps(model: Model, start: Any, step: Any, count: int) -> ToolPath:
    return builders.way_points((np.array(start) + np.arange(count)[:, None] * np.array(step)) / 1e3)


def _passes(model: Model, start: Any, length: float, pitch: float, count: int) -> ToolPath:
    """To and fro, each pass slanting to the start of the next."""
    way = np.arange(count + 1)
    offset = np.stack([length * (way % 2), pitch * way, 0 * way], axis=1)
    return builders.way_points((np.array(start) + offset) / 1e3)


def _spline(model: Model, points: Any) -> ToolPath:
    return builders.spline(np.array(points) / 1e3)


def _raster(
    model: Model, centre: Any, length: float, width: float, lines: int, points: int, feed: float
) -> ToolPath:
    return builders.raster(
        np.array(centre) / 1e3,
        length / 1e3,
        width / 1e3,
        lines=lines,
        points=points,
        feed=feed / 1e3,
        height=lambda x, y: 0.01 * np.sin(2 * np.pi * x / 0.15) * np.cos(np.pi * y / 0.06),
    )


def _wrist(model: Model, miss: float) -> ToolPath:
    """Poses on which q5 runs from -20 to 20 deg while the wrist passes its singularity at the angle
    `miss`."""
    q = np.array([0.1, 0.2, 0.1, 0.3, 0.0, 0.2])
    along = np.array([np.cos(q[3]), np.sin(q[3])])
    across = np.array([-np.sin(q[3]), np.cos(q[3])])
    poses = []
    for angle in np.radians(np.linspace(-20, 20, 41)):
        state = q.copy()
        state[4] = angle
        if miss:
            w = np.sin(angle) * along + np.sin(np.radians(miss)) * across
            state[3] = np.arctan2(w[1], w[0])
            state[4] = np.arcsin(np.hypot(*w))
            # straight, only the sum of axes 4 and 6 counts
            state[5] = q[5] + q[3] - state[3]
        poses.append(model.tcp_pose(state))
    return builders.poses(poses)


def _wind_up(model: Model, turns: float) -> ToolPath:
    q = np.array([0.1, 0.2, 0.1, 0.3, 0.9, 0.0])
    poses = []
    for angle in np.linspace(-np.pi * turns, np.pi * turns, int(24 * turns) + 1):
        poses.append(model.tcp_pose(q + np.array([0, 0, 0, 0, 0, angle])))
    return builders.poses(poses)


def _reach_out(model: Model, beyond: float) -> ToolPath:
    """Straight out in the direction of the forearm; the arm is stretched at the end, or would have
    to be longer."""
    g = model.arm_geometry
    stretched = np.array([0.1, 0.9, 0.0, 0.3, 0.8, 0.2])
    # q2 - q3 with k = 0, eq. 36
    stretched[2] = stretched[1] - np.arctan2(g.d4, g.a3)
    end = model.tcp_pose(stretched)
    shoulder = np.array([g.a1 * np.cos(0.1), g.a1 * np.sin(0.1), g.d1])
    wrist = model.flange_pose(stretched)[:3, 3] - g.d7 * model.flange_pose(stretched)[:3, 2]
    out = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
    poses = []
    for distance in np.linspace(-0.3, beyond / 1e3 - (0.005 if not beyond else 0.0), 16):
        X = end.copy()
        X[:3, 3] += distance * out
        poses.append(X)
    return builders.poses(poses)


def _through_shoulder(model: Model) -> ToolPath:
    """The wrist centre passes straight over axis 1 with the orientation held."""
    g = model.arm_geometry
    q = np.array([0.0, -0.6, -0.3, 0.0, 0.9, 0.0])
    X = model.tcp_pose(q)
    wrist = model.flange_pose(q)[:3, 3] - g.d7 * model.flange_pose(q)[:3, 2]
    poses = []
    for y in np.linspace(-0.15, 0.15, 21):
        pose = X.copy()
        pose[:3, 3] += np.array([-wrist[0], y - wrist[1], 0.0])
        poses.append(pose)
    return builders.poses(poses)


_BUILDERS: dict[str, Callable[..., ToolPath]] = {
    "points": _points,
    "circle": _circle,
    "steps": _steps,
    "spline": _spline,
    "passes": _passes,
    "raster": _raster,
    "wrist": _wrist,
    "wind_up": _wind_up,
    "reach_out": _reach_out,
    "poses_through_shoulder": _through_shoulder,
}
