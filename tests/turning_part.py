"""What a written motion of arm and positioner does, with kinematics that share nothing with the
library; and cells and paths drawn anew for it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from irb2400_ctrl.cell import Cell
from irb2400_ctrl.planners import Plan, ToolPath
from irb2400_ctrl.trajectory.file import load_trajectory

Array = npt.NDArray[np.float64]
# of the IRB 2400: a, alpha, d of modified DH (Craig) and its tip, from the paper's tables
DH = [(0, 0, 0.615), (0.1, -90, 0), (0.705, 0, 0), (0.135, -90, 0.755), (0, 90, 0), (0, 90, 0)]
TIP = np.array([0.24, 0.0, 0.162])
RATE = 1e4


@dataclass(frozen=True)
class Line:
    """An axis of a positioner at zero angles, and its limits in degrees."""

    direction: Array
    point: Array
    """[m]"""
    speed: float
    acceleration: float
    reach: float = 720.0

    def toml(self) -> str:
        return (
            f"{{ direction = {self.direction.tolist()}, point_mm = {(1e3 * self.point).tolist()}, "
            f"range_deg = [{-self.reach}, {self.reach}], speed_deg_s = {self.speed}, "
            f"acceleration_deg_s2 = {self.acceleration} }}"
        )

    def turn(self, angle: Array) -> tuple[Array, Array]:
        """Rotations (n, 3, 3) and shifts (n, 3) of what the axis carries."""
        unit = self.direction / np.linalg.norm(self.direction)
        R = Rotation.from_rotvec(angle[:, None] * unit).as_matrix()
        return R, self.point - R @ self.point


@dataclass(frozen=True)
class Table:
    """A tilting turn table with a part on it."""

    tilt: Line
    turn: Line
    place: Array
    """of the part's zero, its axes as those of the base [m]"""

    def cell(self) -> Cell:
        import tomllib

        text = f"""schema_version = 1
name = "table"
[work_object]
place_mm = {(1e3 * self.place).tolist()}
[positioner]
position_deg = "move"
tilt = {self.tilt.toml()}
turn = {self.turn.toml()}
"""
        return Cell.model_validate(tomllib.loads(text))

    def tip(self, q: Array, e: Array) -> tuple[Array, Array]:
        """Tip of the tool and its direction, towards the spindle, as the part sees them [m]."""
        theta = q + np.array([0, -np.pi / 2, 0, 0, np.pi, 0])
        theta[:, 2] -= q[:, 1]
        R = np.tile(np.eye(3), (len(q), 1, 1))
        p = np.zeros((len(q), 3))
        for joint, (a, alpha, d) in enumerate(DH):
            p = p + R @ np.array([a, 0.0, 0.0])
            turned = Rotation.from_rotvec(theta[:, joint, None] * [0.0, 0.0, 1.0]).as_matrix()
            R = R @ Rotation.from_euler("x", alpha, degrees=True).as_matrix() @ turned
            p = p + d * R[:, :, 2]
        p = p + 0.085 * R[:, :, 2] + R @ TIP
        # the spindle points along x of the flange at its tip
        axis = -R[:, :, 0]
        for line, angle in ((self.tilt, e[:, 0]), (self.turn, e[:, 1])):
            R_e, p_e = line.turn(angle)
            p = np.einsum("nji,nj->ni", R_e, p - p_e)
            axis = np.einsum("nji,nj->ni", R_e, axis)
        return p - self.place, axis


@dataclass(frozen=True)
class Seen:
    """The largest of 10,000 looks a second."""

    deviation_mm: float
    axis_deg: float
    """at both ends of the path"""
    speed: float
    """of the tip on the part [m/s]"""
    fast: Array
    sharp: Array
    """speeds and accelerations of both axes over their limits, shape (2,)"""
    between: Array
    """least and largest angles [rad], shape (2, 2)"""

    def above(self, plan: Plan) -> list[str]:
        """Bounds of a plan that are below what was seen."""
        found = []
        if self.deviation_mm > 1e3 * plan.max_tcp_deviation:
            found.append("deviation")
        if np.radians(self.axis_deg) > plan.max_tool_axis_deviation + 1e-7:
            found.append("axis")
        feed = float(plan.path.feed[1])
        # differences of places over 0.1 ms are rounded to parts of a million
        if plan.max_feed_ratio is None or self.speed > plan.max_feed_ratio * feed * (1 + 1e-6):
            found.append("feed")
        for j, axis in enumerate(plan.external):
            if self.fast[j] > axis.speed * (1 + 1e-9) + 1e-12:
                found.append(f"speed {j + 1}")
            if self.sharp[j] > axis.acceleration * (1 + 1e-9) + 1e-12:
                found.append(f"acceleration {j + 1}")
            if self.between[0, j] < axis.least - 1e-12 or self.between[1, j] > axis.most + 1e-12:
                found.append(f"range {j + 1}")
            if max(axis.speed, axis.acceleration) > 1:
                found.append(f"limit {j + 1}")
        return found


def looked_at(plan: Plan, table: Table, path: ToolPath, folder: Path) -> Seen:
    """Write a plan, read its text and follow it."""
    plan.write(folder)
    motion = load_trajectory(folder / "trajectory.csv")
    assert motion.external is not None
    at = np.arange(0, motion.duration, 1 / RATE)
    q = hermite(motion.time, motion.q, motion.qd, at)[0]
    e, ed, edd = hermite(motion.time, motion.external.q, motion.external.qd, at)
    tip, axis = table.tip(q, e)
    ends = np.arccos(np.clip((axis[[0, -1]] * path.axis[[0, -1]]).sum(axis=1), -1, 1))
    limits = np.array([[line.speed, line.acceleration] for line in (table.tilt, table.turn)]).T
    return Seen(
        1e3 * float(to_polygon(tip, path.position).max()),
        float(np.degrees(ends.max())),
        float(np.linalg.norm(np.diff(tip, axis=0), axis=1).max() * RATE),
        np.degrees(np.abs(ed).max(axis=0)) / limits[0],
        np.degrees(np.abs(edd).max(axis=0)) / limits[1],
        np.stack([e.min(axis=0), e.max(axis=0)]),
    )


def hermite(time: Array, value: Array, rate: Array, at: Array) -> tuple[Array, Array, Array]:
    """Cubics between rows and their two derivatives."""
    k = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    h = (time[k + 1] - time[k])[:, None]
    t = (at - time[k])[:, None] / h
    a = value[k]
    va = h * rate[k]
    vb = h * rate[k + 1]
    way = value[k + 1] - a
    c = 3 * way - 2 * va - vb
    d = va + vb - 2 * way
    first = (va + t * (2 * c + 3 * d * t)) / h
    return a + t * (va + t * (c + t * d)), first, (2 * c + 6 * d * t) / h**2


def to_polygon(points: Array, corners: Array) -> Array:
    """Distance of points from a polygon."""
    best = np.full(len(points), np.inf)
    for start, end in itertools.pairwise(corners):
        way = end - start
        t = np.clip((points - start) @ way / (way @ way), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - start - t[:, None] * way, axis=1))
    return best


def cone(radius: float, degrees: float, slopes: tuple[float, float], feed: float) -> ToolPath:
    """Around a cone whose slope grows, the tool across the surface."""
    count = max(int(degrees / 7), 12)
    share = np.linspace(0, 1, count)
    angle = np.radians(degrees) * share
    slope = np.radians(slopes[0] + (slopes[1] - slopes[0]) * share)
    flat = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    out = np.sin(slope)[:, None] * flat + np.cos(slope)[:, None] * [0, 0, 1]
    place = radius * flat + [0, 0, 0.03]
    return ToolPath(place, axis=out, feed=np.full(count, feed), name="cone")


def drawn(seed: int) -> tuple[Table, ToolPath]:
    """A table with skew axes somewhere in front of the arm, and a way around a cone on it."""
    rng = np.random.default_rng(seed)
    foot = np.array([rng.uniform(0.95, 1.2), rng.uniform(-0.2, 0.2), rng.uniform(0.3, 0.5)])
    heading = rng.uniform(0, 2 * np.pi)
    skew = rng.uniform(-0.15, 0.15, (2, 3))
    tilt = np.array([np.cos(heading), np.sin(heading), 0.0]) + skew[0]
    turn = np.array([0.0, 0.0, 1.0]) + skew[1]
    table = Table(
        Line(tilt, foot, rng.uniform(20, 90), rng.uniform(40, 300), 110.0),
        Line(
            turn,
            foot + rng.uniform(-0.03, 0.03, 3),
            rng.uniform(30, 180),
            rng.uniform(60, 600),
        ),
        foot + np.array([0, 0, rng.uniform(0.05, 0.15)]),
    )
    degrees = rng.choice([-1, 1]) * rng.uniform(120, 480)
    slopes = (rng.uniform(20, 80), rng.uniform(20, 80))
    path = cone(rng.uniform(0.04, 0.1), abs(degrees), slopes, rng.uniform(0.03, 0.3))
    if degrees < 0:
        mirror = np.array([1.0, -1.0, 1.0])
        assert path.axis is not None
        path = ToolPath(path.position * mirror, path.axis * mirror, feed=path.feed, name="cone")
    return table, path
