"""Which family an arm belongs to, read from its joint axes: the constants of `ArmGeometry`.

Everything is measured once, at theta = 0, on the six axes as lines in space; so it does not matter
in which frames, with which signs or offsets a robot file describes the arm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.geometry import ArmGeometry
from irb2400_ctrl.robot import Robot

TOLERANCE = 1e-9
"""of angles [rad] and of distances over the arm's size [-]: exact, or only near"""
NEAR = 5e-3
"""the same of an arm that is near a family: what calibration changes, and more"""


@dataclass(frozen=True)
class _Lines:
    """The joint axes at theta = 0 in the base, and the flange there."""

    p: Array
    """a point on each axis, shape (6, 3)"""
    z: Array
    """direction of each axis, shape (6, 3)"""
    X_BF: Array
    size: float
    tolerance: float

    def square(self, i: int, j: int) -> bool:
        """Axes i and j (1…) at right angles."""
        return abs(float(self.z[i - 1] @ self.z[j - 1])) < self.tolerance

    def parallel(self, i: int, j: int) -> bool:
        return float(np.linalg.norm(np.cross(self.z[i - 1], self.z[j - 1]))) < self.tolerance

    def meeting(self, i: int, j: int) -> Array | None:
        """Where axes at right angles meet; None if they pass each other."""
        a = self.p[i - 1]
        b = self.p[j - 1]
        u = self.z[i - 1]
        v = self.z[j - 1]
        if abs((b - a) @ np.cross(u, v)) > self.tolerance * self.size:
            return None
        return np.asarray(a + ((b - a) @ u) * u)

    def on_axis(self, point: Array, i: int) -> bool:
        miss = np.linalg.norm(np.cross(point - self.p[i - 1], self.z[i - 1]))
        return bool(miss < self.tolerance * self.size)


def arm_geometry(robot: Robot) -> ArmGeometry:
    """The constants of an arm of one of the two families, or of the one of them that it is near.

    A calibrated arm's axes miss each other by fractions of a millimetre; `exact` is False then, and
    the constants only lead close to its configurations.

    Raises:
        InputError: the arm is near neither; says what is missing.
    """
    if robot.n != 6:
        raise _other(robot, f"{robot.n} axes, not six")
    try:
        return _of_family(robot, TOLERANCE)
    except InputError:
        return replace(_of_family(robot, NEAR), exact=False)


def has_singularity_factors(robot: Robot) -> bool:
    """Whether the arm is of, or near, one of the two families."""
    try:
        arm_geometry(robot)
    except InputError:
        return False
    return True


def _of_family(robot: Robot, tolerance: float) -> ArmGeometry:
    lines = _lines(robot, tolerance)
    if not (lines.square(1, 2) and lines.parallel(2, 3)):
        raise _other(robot, "axis 1 is not at right angles to parallel axes 2 and 3")
    if lines.parallel(3, 4):
        if not (lines.square(4, 5) and lines.square(5, 6)):
            raise _other(robot, "axes 4, 5 and 6 are not at right angles to one another")
        W = lines.meeting(5, 6)
        if W is None:
            raise _other(robot, "axes 5 and 6 do not meet")
        return _parallel(robot, lines, W)
    if not (lines.square(3, 4) and lines.square(4, 5) and lines.square(5, 6)):
        raise _other(robot, "axes 3 to 6 are not at right angles to one another")
    W = lines.meeting(4, 5)
    if W is None or not lines.on_axis(W, 6):
        raise _other(robot, "axes 4, 5 and 6 do not meet in one point")
    return _spherical(robot, lines, W)


def _other(robot: Robot, reason: str) -> InputError:
    return InputError(
        f"{robot.name}: no closed-form inverse kinematics and no singularity factors for this arm "
        f"({reason}); known are arms with a spherical wrist and arms with three parallel axes"
    )


def _lines(robot: Robot, tolerance: float) -> _Lines:
    X = np.eye(4)
    p = []
    z = []
    for link in robot.links:
        X = X @ link.frame.matrix()
        p.append(X[:3, 3])
        z.append(X[:3, 2])
    X = X @ robot.flange.matrix()
    size = float(np.abs(np.array([*p, X[:3, 3]])).max()) + 1e-3
    return _Lines(np.array(p), np.array(z), X, size, tolerance)


@dataclass(frozen=True)
class _Arm:
    """The plane of the arm at theta = 0: x out, z up along axis 1, y along axis 2."""

    X_B0: Array
    d1: float
    a1: float
    x: Array
    y: Array
    z: Array

    @classmethod
    def of(cls, lines: _Lines) -> _Arm:
        z = lines.z[0]
        y = lines.z[1] - (lines.z[1] @ z) * z
        y = y / np.linalg.norm(y)
        x = np.cross(y, z)
        foot = lines.p[0] + ((lines.p[1] - lines.p[0]) @ z) * z
        d1 = float(foot @ z)
        X_B0 = np.eye(4)
        X_B0[:3, :3] = np.stack([x, y, z], axis=1)
        X_B0[:3, 3] = foot - d1 * z
        return cls(X_B0, d1, float((lines.p[1] - foot) @ x), x, y, z)

    def upright(self, v: Array) -> float:
        """Angle of a direction in the plane from z towards x [rad]."""
        return float(np.arctan2(v @ self.x, v @ self.z))

    def length(self, v: Array) -> float:
        """Of the part in the plane [m]."""
        return float(np.hypot(v @ self.x, v @ self.z))


def _spherical(robot: Robot, lines: _Lines, W: Array) -> ArmGeometry:
    """Canonical directions of Tab. 2: the forearm's axis 4 is y3, x3 = (sin phi3, cos phi3)."""
    arm = _Arm.of(lines)
    upper = lines.p[2] - lines.p[1]
    fore = W - lines.p[2]
    out = lines.z[3] if fore @ lines.z[3] >= -TOLERANCE * lines.size else -lines.z[3]
    phi3 = float(np.arctan2(-(out @ arm.z), out @ arm.x))
    x3 = np.sin(phi3) * arm.x + np.cos(phi3) * arm.z
    x4 = np.cross(-lines.z[4], out)
    phi4 = float(np.arctan2(-(x4 @ arm.y), x4 @ x3))
    phi5 = float(np.arctan2(-(lines.z[5] @ x4), lines.z[5] @ out))
    # x5 at phi5, and with it the frame of W at phi6 = 0
    x6 = -np.cos(phi5) * x4 - np.sin(phi5) * out
    s3 = 1.0 if lines.z[2] @ arm.y > 0 else -1.0
    s4 = 1.0 if out @ lines.z[3] > 0 else -1.0
    M = np.diag([1.0, 1.0, s3, s4, 1.0, 1.0])
    M[2, 1] = 1.0
    home = np.array([0.0, arm.upright(upper), phi3, phi4, phi5, 0.0])
    return _geometry(
        robot, lines, arm, W, "spherical wrist", (M, home), x6,
        (arm.length(upper), float(fore @ x3), float(fore @ out), 0.0),
    )  # fmt: skip


def _parallel(robot: Robot, lines: _Lines, W: Array) -> ArmGeometry:
    """Absolute directions phi2, phi3, phi4 of upper arm, forearm and axis 5; phi5 = 0 puts axis 6
    along axis 2."""
    arm = _Arm.of(lines)
    upper = lines.p[2] - lines.p[1]
    fore = lines.p[3] - lines.p[2]
    axis5 = lines.z[4]
    phi4 = arm.upright(axis5)
    across = np.cos(phi4) * arm.x - np.sin(phi4) * arm.z
    phi5 = float(np.arctan2(-(lines.z[5] @ across), lines.z[5] @ arm.y))
    s3, s4 = (1.0 if lines.z[i] @ arm.y > 0 else -1.0 for i in (2, 3))
    M = np.eye(6)
    M[2, 1:3] = (1.0, s3)
    M[3, 1:4] = (1.0, s3, s4)
    home = np.array([0.0, arm.upright(upper), arm.upright(fore), phi4, phi5, 0.0])
    last = W - lines.p[3]
    return _geometry(
        robot, lines, arm, W, "parallel axes", (M, home), axis5,
        (arm.length(upper), arm.length(fore), float(last @ axis5), float(last @ across)),
    )  # fmt: skip


def _geometry(
    robot: Robot,
    lines: _Lines,
    arm: _Arm,
    W: Array,
    family: str,
    angles: tuple[Array, Array],
    x6: Array,
    lengths: tuple[float, float, float, float],
) -> ArmGeometry:
    a2, a3, d4, e4 = lengths
    geometry_size = TOLERANCE * lines.size
    if a2 < geometry_size or (family == "parallel axes" and a3 < geometry_size):
        raise _other(robot, "two of the parallel axes are one")
    M, home = angles
    X_06 = np.eye(4)
    X_06[:3, :3] = np.stack([x6, np.cross(lines.z[5], x6), lines.z[5]], axis=1)
    X_06[:3, 3] = W
    offset = _snapped(M @ robot.offset + home)
    return ArmGeometry(
        family=family,  # type: ignore[arg-type]
        d1=_clean(arm.d1),
        a1=_clean(arm.a1),
        a2=_clean(a2),
        a3=_clean(a3),
        d4=_clean(d4),
        e4=_clean(e4),
        # beside axis 1: the frame of link 2 may stand anywhere along axis 2
        b=_clean(float((W - arm.X_B0[:3, 3]) @ arm.y)),
        C=M @ robot.A,
        offset=offset,
        X_B0=_clean_pose(arm.X_B0),
        X_6F=_clean_pose(np.linalg.inv(X_06) @ lines.X_BF),
    )


def _clean(value: float) -> float:
    """Without the rounding of the frames before: 1e-12 m is no length."""
    return float(round(value, 15)) if abs(value) > 1e-12 else 0.0


def _clean_pose(X: Array) -> Array:
    whole = np.round(X)
    return np.where(np.abs(X - whole) < 1e-12, whole, X)


def _snapped(angle: Array) -> Array:
    """Into (-pi, pi], multiples of 90 degrees exact."""
    wrapped = np.pi - np.mod(np.pi - angle, 2 * np.pi)
    quarter = np.round(wrapped / (np.pi / 2)) * (np.pi / 2)
    near = np.abs(wrapped - quarter) < 1e-12
    snapped = np.where(near, quarter, wrapped)
    return np.where(np.abs(snapped + np.pi) < 1e-12, np.pi, snapped)
