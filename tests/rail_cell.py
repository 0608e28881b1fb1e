"""What a written motion of an arm on a carriage that moves does and needs, with kinematics and
dynamics that share nothing with the library; and cells and paths drawn anew for it.

Places, accelerations and moments are those in the frame of the floor, on which the carriage
accelerates: nothing is said here of a gravity that leans.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from independent_plant.parameters import FRICTION, SPEEDS, TORQUE_LIMITS, paper_arm
from scipy.spatial.transform import Rotation
from turning_part import DH, RATE, TIP, Line, hermite, to_polygon

from irb2400_ctrl.cell import Cell
from irb2400_ctrl.planners import Plan, ToolPath
from irb2400_ctrl.trajectory.file import load_trajectory

Array = npt.NDArray[np.float64]
DOWN = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class Track:
    """A rail under the arm, limits in mm, and a part; a table under it that turns, or none."""

    way: Array
    ends: tuple[float, float]
    speed: float
    acceleration: float
    place: Array
    """of the part's zero in the base of the carriage at zero [m]"""
    table: Line | None = None

    @property
    def unit(self) -> Array:
        return np.asarray(self.way / np.linalg.norm(self.way))

    def cell(self) -> Cell:
        text = f"""schema_version = 1
name = "track"
[work_object]
place_mm = {(1e3 * self.place).tolist()}
[rail]
direction = {self.way.tolist()}
range_mm = {list(self.ends)}
position_mm = "move"
speed_mm_s = {self.speed}
acceleration_mm_s2 = {self.acceleration}
"""
        if self.table is not None:
            text += f"""[positioner]
position_deg = "move"
turn = {self.table.toml()}
"""
        return Cell.model_validate(tomllib.loads(text))

    def on_part(self, p: Array, axis: Array, e: Array) -> tuple[Array, Array]:
        """A place and a direction on the floor, as the part sees them; e as in the file."""
        if self.table is not None:
            R, shift = self.table.turn(e[:, 2])
            p = np.einsum("nji,nj->ni", R, p - shift)
            axis = np.einsum("nji,nj->ni", R, axis)
        return p - self.place, axis


@dataclass(frozen=True)
class Driven:
    """An arm on a carriage at n instants, on the floor."""

    tau: Array
    """of the actuators, friction included [Nm], shape (n, 6)"""
    tip: Array
    axis: Array
    """of the tool, towards the spindle, shape (n, 3)"""


def driven(q: Array, qd: Array, qdd: Array, base: Array, push: Array) -> Driven:
    """Newton's and Euler's laws for every body about its centre of mass, on the floor.

    Args:
        q, qd, qdd: of the actuators, shape (n, 6).
        base, push: place and acceleration of the carriage, shape (n, 3).
    """
    bodies = paper_arm().packed()[:60].reshape(6, 10)
    theta = q + np.array([0, -np.pi / 2, 0, 0, np.pi, 0])
    theta[:, 2] -= q[:, 1]
    rate, rate2 = (np.column_stack([v[:, :2], v[:, 2] - v[:, 1], v[:, 3:]]) for v in (qd, qdd))
    n = len(q)
    R = np.tile(np.eye(3), (n, 1, 1))
    o = base.copy()
    a = push.copy()
    w = np.zeros((n, 3))
    dw = np.zeros((n, 3))
    joints = []
    wrenches = []
    for j, (length, alpha, d) in enumerate(DH):
        arm = R @ np.array([length, 0.0, 0.0])
        a = a + np.cross(dw, arm) + np.cross(w, np.cross(w, arm))
        o = o + arm
        turn = Rotation.from_rotvec(theta[:, j, None] * [0.0, 0.0, 1.0]).as_matrix()
        R = R @ Rotation.from_euler("x", alpha, degrees=True).as_matrix() @ turn
        z = R[:, :, 2]
        dw = dw + z * rate2[:, j, None] + np.cross(w, z * rate[:, j, None])
        w = w + z * rate[:, j, None]
        shift = d * z
        a = a + np.cross(dw, shift) + np.cross(w, np.cross(w, shift))
        o = o + shift
        joints.append((o, z))
        mass = bodies[j, 0]
        centre = bodies[j, 1:4]
        xx, yy, zz, xy, xz, yz = bodies[j, 4:]
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        inertia = R @ own @ R.transpose(0, 2, 1)
        c = R @ centre
        force = mass * (a + np.cross(dw, c) + np.cross(w, np.cross(w, c)) - DOWN)
        spin = np.einsum("nij,nj->ni", inertia, w)
        moment = np.einsum("nij,nj->ni", inertia, dw) + np.cross(w, spin)
        wrenches.append((o + c, force, moment))
    own = np.empty((n, 6))
    for j, (at, z) in enumerate(joints):
        felt = sum(np.cross(c - at, force) + moment for c, force, moment in wrenches[j:])
        own[:, j] = (z * felt).sum(axis=1)
    own[:, 1] -= own[:, 2]
    static, coulomb, viscous, stribeck = FRICTION.T
    level = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
    tau = own + level * np.sign(qd) + viscous * qd
    # the spindle points along x of the flange at its tip
    return Driven(tau, o + 0.085 * R[:, :, 2] + R @ TIP, -R[:, :, 0])


@dataclass(frozen=True)
class Seen:
    """The largest of 10,000 looks a second."""

    torque: float
    velocity: float
    """over the robot's own limits"""
    deviation_mm: float
    axis_deg: float
    """at both ends of the path"""
    speed: float
    """of the tip on the part [m/s]"""
    fast: Array
    sharp: Array
    """of the further axes that move, over their limits, in mm or degrees"""
    between: Array
    """least and largest place of the carriage [m]"""
    pushed: float
    """share of the torque limit that the acceleration of the carriage alone makes"""

    def above(self, plan: Plan) -> list[str]:
        """Bounds of a plan that are below what was seen."""
        feed = float(plan.path.feed[1])
        found = [
            name
            for name, seen, bound in (
                ("torque", self.torque, plan.max_torque_ratio + 1e-9),
                ("velocity", self.velocity, plan.max_velocity_ratio + 1e-9),
                ("deviation", self.deviation_mm, 1e3 * plan.max_tcp_deviation),
                ("axis", np.radians(self.axis_deg), plan.max_tool_axis_deviation + 1e-7),
                # differences of places over 0.1 ms are rounded to parts of a million
                ("feed", self.speed, (plan.max_feed_ratio or 0.0) * feed * (1 + 1e-6)),
                ("carriage", self.between[1], plan.external[0].most + 1e-12),
                ("carriage", -self.between[0], 1e-12 - plan.external[0].least),
            )
            if not seen <= bound
        ]
        moving = [plan.external[0], *plan.external[2:]]
        for axis, fast, sharp in zip(moving, self.fast, self.sharp, strict=True):
            if fast > axis.speed * (1 + 1e-9) + 1e-12:
                found.append("speed of a further axis")
            if sharp > axis.acceleration * (1 + 1e-9) + 1e-12:
                found.append("acceleration of a further axis")
            if max(axis.speed, axis.acceleration) > 1:
                found.append("limit of a further axis")
        return found


def looked_at(plan: Plan, track: Track, path: ToolPath, folder: Path) -> Seen:
    """Write a plan, read its text and follow it."""
    plan.write(folder)
    motion = load_trajectory(folder / "trajectory.csv")
    assert motion.external is not None
    at = np.arange(0, motion.duration, 1 / RATE)
    q, qd, qdd = hermite(motion.time, motion.q, motion.qd, at)
    e, ed, edd = hermite(motion.time, motion.external.q, motion.external.qd, at)
    base, push = (v[:, :1] * track.unit for v in (e, edd))
    found = driven(q, qd, qdd, base, push)
    still = driven(q, qd, qdd, base, 0 * push)
    tip, axis = track.on_part(found.tip, found.axis, e)
    ends = np.arccos(np.clip((axis[[0, -1]] * path.axis[[0, -1]]).sum(axis=1), -1, 1))
    moving = [0] if track.table is None else [0, 2]
    limits = [(track.speed / 1e3, track.acceleration / 1e3)]
    if track.table is not None:
        limits.append((np.radians(track.table.speed), np.radians(track.table.acceleration)))
    fast, sharp = np.array(limits).T
    return Seen(
        float((np.abs(found.tau) / TORQUE_LIMITS).max()),
        float((np.abs(qd) / SPEEDS).max()),
        1e3 * float(to_polygon(tip, path.position).max()),
        float(np.degrees(ends.max())),
        float(np.linalg.norm(np.diff(tip, axis=0), axis=1).max() * RATE),
        np.abs(ed[:, moving]).max(axis=0) / fast,
        np.abs(edd[:, moving]).max(axis=0) / sharp,
        np.array([e[:, 0].min(), e[:, 0].max()]),
        float((np.abs(found.tau - still.tau) / TORQUE_LIMITS).max()),
    )


def long_path(rng: np.random.Generator, length: float, feed: float) -> ToolPath:
    """A way along y that swings to the side and up, the tool leaning."""
    y = np.linspace(0, length, max(int(length / 0.06), 12))
    swing = rng.uniform(0.02, 0.12) * np.sin(y * rng.uniform(2, 7) + rng.uniform(0, 6))
    height = rng.uniform(0.0, 0.08) * np.sin(y * rng.uniform(1, 4))
    lean = 0.3 * rng.uniform(-1, 1, 2)[:, None] * np.cos(y * rng.uniform(0.5, 2))
    axis = np.stack([lean[0], lean[1], np.ones_like(y)], axis=1)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    place = np.stack([swing, y, height], axis=1)
    return ToolPath(place, axis=axis, feed=np.full(len(y), feed), name="long")


def drawn(seed: int) -> tuple[Track, ToolPath]:
    """A rail that is not quite level or along y, and a long way beside it, with a table under
    every third part."""
    rng = np.random.default_rng(seed)
    way = np.array([rng.uniform(-0.15, 0.15), 1.0, rng.uniform(-0.05, 0.05)])
    length = float(rng.uniform(2.6, 4.4))
    place = np.array([rng.uniform(0.95, 1.2), rng.uniform(-0.4, 0.4), rng.uniform(0.35, 0.8)])
    table = None
    if seed % 3 == 0:
        foot = place + np.array([0, length / 2, -0.1])
        table = Line(
            np.array([0.0, 0.0, 1.0]), foot, rng.uniform(20, 60), rng.uniform(30, 90), 20.0
        )
    track = Track(
        way,
        (-800.0, 5200.0),
        float(rng.uniform(400, 2000)),
        float(rng.uniform(500, 4000)),
        place,
        table,
    )
    return track, long_path(rng, length, float(rng.uniform(0.1, 0.9)))
