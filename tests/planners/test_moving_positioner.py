"""A positioner that turns the part during the cut: what its file says, followed with kinematics
that share nothing with the library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.cell import Cell, load_cell
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Plan, ToolPath, check, plan_path
from irb2400_ctrl.trajectory.file import load_trajectory

Array = npt.NDArray[np.float64]
ROBOT = load_robot("irb2400")
CELL = """schema_version = 1
name = "turn table"
clearance_mm = 5.0
[work_object]
place_mm = [1100, 0, 500]
[positioner]
position_deg = "move"
[positioner.tilt]
direction = [0, 1, 0]
point_mm = [1100, 0, 400]
range_deg = [-100, 100]
speed_deg_s = 60
acceleration_deg_s2 = 120
[positioner.turn]
direction = [0, 0, 1]
point_mm = [1100, 0, 0]
range_deg = [-400, 400]
speed_deg_s = 90
acceleration_deg_s2 = 200
[[things]]
name = "cone"
role = "part"
frame = "work_object"
shapes = [{ kind = "cylinder", from_mm = [0, 0, -90], to_mm = [0, 0, 20], radius_mm = 20 }]
"""
# of the IRB 2400: a, alpha, d of modified DH (Craig) and its tip, from the paper's tables
DH = [(0, 0, 0.615), (0.1, -90, 0), (0.705, 0, 0), (0.135, -90, 0.755), (0, 90, 0), (0, 90, 0)]
TIP = np.array([0.24, 0.0, 0.162])


def around() -> ToolPath:
    """More than once around a cone whose slope grows, the tool across the surface."""
    share = np.linspace(0, 1, 72)
    angle = np.radians(500) * share
    slope = np.radians(50 + 30 * share)
    out = np.stack(
        [np.sin(slope) * np.cos(angle), np.sin(slope) * np.sin(angle), np.cos(slope)], axis=1
    )
    place = 0.06 * out * [1, 1, 0] / np.sin(slope)[:, None] + [0, 0, 0.03]
    return ToolPath(place, axis=out, feed=np.full(72, 0.1), name="cone")


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Cell:
    file = tmp_path_factory.mktemp("cell") / "cell.toml"
    file.write_text(CELL)
    return load_cell(file)


@pytest.fixture(scope="module")
def plan(cell: Cell) -> Plan:
    return plan_path(ROBOT, around(), cell=cell)


def axis_turn(k: int, angle: Array) -> Array:
    """Turns about axis k of a frame, shape (n, 4, 4)."""
    X = np.tile(np.eye(4), (len(angle), 1, 1))
    i = (k + 1) % 3
    j = (k + 2) % 3
    X[:, i, i] = X[:, j, j] = np.cos(angle)
    X[:, j, i] = np.sin(angle)
    X[:, i, j] = -np.sin(angle)
    return X


def moved(*place: float) -> Array:
    X = np.eye(4)
    X[:3, 3] = place
    return X


def tip_on_part(q: Array, e: Array) -> tuple[Array, Array]:
    """Tip of the tool and its direction, towards the spindle, as the part sees them [m]."""
    theta = q + np.array([0, -np.pi / 2, 0, 0, np.pi, 0])
    theta[:, 2] -= q[:, 1]
    X = np.tile(np.eye(4), (len(q), 1, 1))
    for joint, (a, alpha, d) in enumerate(DH):
        tilted = axis_turn(0, np.radians([float(alpha)]))[0] @ moved(a, 0, 0)
        X = X @ tilted @ axis_turn(2, theta[:, joint]) @ moved(0, 0, d)
    X = X @ moved(0, 0, 0.085)
    place = X[:, :3, :3] @ TIP + X[:, :3, 3]
    # the spindle points along x of the flange at its tip
    spindle = -X[:, :3, 0]
    tilt = axis_turn(1, e[:, 0])
    turn = axis_turn(2, e[:, 1])
    part = moved(1.1, 0, 0.4) @ tilt @ moved(-1.1, 0, -0.4) @ moved(1.1, 0, 0) @ turn
    part = np.linalg.inv(part @ moved(-1.1, 0, 0) @ moved(1.1, 0, 0.5))
    seen = np.einsum("nij,nj->ni", part[:, :3, :3], place) + part[:, :3, 3]
    return seen, np.einsum("nij,nj->ni", part[:, :3, :3], spindle)


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
    return (
        a + t * (va + t * (c + t * d)),
        (va + t * (2 * c + 3 * d * t)) / h,
        (2 * c + 6 * d * t) / h**2,
    )


def to_polygon(points: Array, corners: Array) -> Array:
    """Distance of points from a polygon."""
    side = np.diff(corners, axis=0)
    best = np.full(len(points), np.inf)
    for start, way in zip(corners[:-1], side, strict=True):
        t = np.clip((points - start) @ way / (way @ way), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - start - t[:, None] * way, axis=1))
    return best


def test_the_file_read_ten_thousand_times_a_second_keeps_what_it_says(
    plan: Plan, tmp_path: Path
) -> None:
    plan.write(tmp_path)
    motion = load_trajectory(tmp_path / "trajectory.csv")
    assert motion.external is not None
    at = np.arange(0, motion.duration, 1e-4)
    q, _, _ = hermite(motion.time, motion.q, motion.qd, at)
    e, ed, edd = hermite(motion.time, motion.external.q, motion.external.qd, at)
    tip, spindle = tip_on_part(q, e)
    path = around()
    away = 1e3 * to_polygon(tip, path.position)
    stated = plan.summary()["max_tcp_deviation_mm"]
    assert 0.5 * stated < away.max() <= stated
    # the feed is that of the tool on the part
    speed = np.linalg.norm(np.diff(tip, axis=0), axis=1) / 1e-4
    assert np.quantile(speed, 0.9) / 0.1 > 0.99
    assert speed.max() <= 0.1 * plan.max_feed_ratio * (1 + 1e-6)
    # the limits of tilt and turn, and the bounds of them
    for j, (axis, limits) in enumerate(zip(plan.external, ((60, 120), (90, 200)), strict=True)):
        fastest = np.degrees(np.abs(ed[:, j]).max()) / limits[0]
        sharpest = np.degrees(np.abs(edd[:, j]).max()) / limits[1]
        assert fastest <= axis.speed <= 1
        assert sharpest <= axis.acceleration <= 1
        assert axis.speed < 1.02 * fastest
        assert axis.least <= e[:, j].min()
        assert e[:, j].max() <= axis.most
    assert np.ptp(np.degrees(e[:, 1])) > 360
    assert np.ptp(np.degrees(e[:, 0])) > 20
    # the tool's direction, where the path is at its way-points
    for k in (0, -1):
        assert spindle[k] @ path.axis[k] > np.cos(np.radians(0.01))


def test_the_arm_alone_cannot_go_around(cell: Cell) -> None:
    with pytest.raises(UnreachableError):
        plan_path(ROBOT, around(), cell=cell.on_positioner((-65.0, 0.0)))


def test_the_certificate_holds_for_arm_and_positioner(plan: Plan) -> None:
    assert plan.guaranteed
    found = check(plan.certificate, Model(ROBOT))
    assert found.holds()
    assert plan.certificate.path.n == 8


def test_axes_that_turn_need_limits(tmp_path: Path) -> None:
    file = tmp_path / "cell.toml"
    file.write_text(CELL.replace("speed_deg_s = 60\n", ""))
    with pytest.raises(InputError, match="tilt has no speed_deg_s"):
        load_cell(file)
