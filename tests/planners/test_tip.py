"""Bounds of the TCP along a path hold between the points looked at, and are not far above what is
reached."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toolpath_cases import build

from irb2400_ctrl import load_robot
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import MotionLimits, plan_path
from irb2400_ctrl.planners.enclosure.deviation import deviation
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.redundancy.follow import JointTarget, follow
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import smooth_curve

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
SPINDLE = np.array([0.0, 0.0, 1.0])


def random_tip(seed: int) -> TcpPath:
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.6 * ROBOT.q_min, 0.6 * ROBOT.q_max, (8, 6))
    return TcpPath(MODEL, JointPath.through(np.linspace(0, 1, 8), q), SPINDLE)


def cells(tip: TcpPath, parts: int) -> np.ndarray:
    knots = tip.joints.knots
    s = np.unique(
        np.concatenate(
            [knots, *(k + np.diff(knots)[0] * np.arange(parts) / parts for k in knots[:-1])]
        )
    )
    return s[np.append(True, np.diff(s) > 1e-9)]


@pytest.mark.parametrize("seed", range(5))
def test_position_axis_and_speed_stay_near_their_parabolas(seed: int) -> None:
    tip = random_tip(seed)
    s = cells(tip, 12)
    position, axis = tip.enclosed(np.stack([s[:-1], s[1:]]))
    rate = tip.enclosed_velocity(s)
    piece = tip.joints.piece((s[:-1] + s[1:]) / 2)
    reached = np.zeros(3)
    for t in (0.2, 0.21, 0.5, 0.79, 0.8):
        at = s[:-1] + t * np.diff(s)
        p, a = tip.pose(at, piece)
        weights = np.array([(1 - t) ** 2, 2 * t * (1 - t), t**2])
        for k, (found, true) in enumerate(
            ((position, p), (axis, a), (rate, tip.velocity(at, piece)))
        ):
            away = np.linalg.norm(np.einsum("i,mik->mk", weights, found.points) - true, axis=1)
            assert (away <= found.miss + 1e-12).all()
            reached[k] = max(reached[k], (away / found.miss).max())
            assert (np.linalg.norm(true, axis=1) <= found.size + 1e-12).all()
    # the bounds are worth something
    assert reached.min() > 0.02


def test_what_the_parabolas_miss_falls_with_the_third_power() -> None:
    tip = random_tip(1)
    sizes = [
        tip.enclosed(np.stack([s[:-1], s[1:]]))[0].miss.max()
        for s in (cells(tip, 50), cells(tip, 100))
    ]
    assert 7 < sizes[0] / sizes[1] < 9


def test_length_is_that_of_the_tip() -> None:
    tip = random_tip(2)
    way = tip.pose(np.linspace(0, 1, 200_001))[0]
    assert tip.lengths[-1] == pytest.approx(
        np.linalg.norm(np.diff(way, axis=0), axis=1).sum(), rel=1e-6
    )


def test_deviation_sees_what_happens_between_the_stations() -> None:
    # a bump of the joint path that is zero at every station and in every middle
    path = builders.line((0.9, 0, 0.5), (0.9, 0.2, 0.5))
    orientation = Orientation.of(smooth_curve(path), SPINDLE)
    followed = follow(MODEL, JointTarget.of(orientation, lambda s: np.zeros(len(s)), 0), None)
    true = deviation(TcpPath(MODEL, followed.joints, SPINDLE), orientation, followed)
    assert true.position < 1e-6
    # swing the tool's end out in one piece, by a cubic that vanishes at its ends and its middle
    coefficients = followed.joints.coefficients.copy()
    k = coefficients.shape[1] // 2
    h = np.diff(followed.joints.knots)[k]
    size = 1e-3
    coefficients[1:, k, 1] += size * np.array([0.5 / h, -1.5 / h**2, 1.0 / h**3]) * 6 * np.sqrt(3)
    bent = replace(followed, joints=JointPath(followed.joints.knots.copy(), coefficients))
    s = followed.joints.knots[k] + h * np.linspace(0, 1, 2001)
    seen = np.linalg.norm(
        (TcpPath(MODEL, bent.joints, SPINDLE).pose(s)[0] - path.position[0])[:, [0, 2]], axis=1
    ).max()
    found = deviation(TcpPath(MODEL, bent.joints, SPINDLE), orientation, bent).position
    assert seen <= found < 1.01 * seen
    assert found > 2e-4


def test_feed_holds_at_all_times() -> None:
    path = builders.way_points(
        np.array([[0.9, 0, 0.5], [0.9, 0.1, 0.5], [1.0, 0.15, 0.45], [1.0, 0.2, 0.5]]), feed=0.1
    )
    feed = np.array([0.1, 0.1, 0.03, 0.2])
    plan = plan_path(ROBOT, replace(path, feed=feed))
    assert plan.max_feed_ratio is not None
    # the law reaches the feed; what is read between its rows swings above a speed that stops
    # growing, so that the whole is slowed by some thousandths
    assert 0.99 < plan.max_feed_ratio <= 1 + 1e-9
    time = np.arange(0, plan.duration, 1e-4)
    _, q, qd, _ = plan.certificate.law.motion(plan.certificate.path, time)
    speed = np.linalg.norm(np.einsum("kij,kj->ki", MODEL.tcp_jacobian(q)[:, :3], qd), axis=1)
    assert speed.max() <= feed.max() * (1 + 1e-9)
    # the side to the third point has a feed of its own
    side = path.position[2] - path.position[1]
    along = (MODEL.tcp_pose(q)[:, :3, 3] - path.position[1]) @ side / (side @ side)
    away = np.linalg.norm(
        MODEL.tcp_pose(q)[:, :3, 3] - path.position[1] - along[:, None] * side, axis=1
    )
    slow = (away < 1e-5) & (along > 0.05) & (along < 0.95)
    assert speed[slow].max() <= 0.03 * (1 + 1e-9)
    assert np.median(speed[slow]) > 0.0297
    side = builders.line((0.9, 0, 0.5), (0.9, 0.1, 0.5))
    free = plan_path(ROBOT, side, torque_rate=np.inf)
    assert free.max_feed_ratio is None


def test_lengths_are_those_of_the_tip_whatever_the_tool_turns() -> None:
    rolling = builders.way_points(
        np.array([[0.9, 0, 0.5], [0.9, 0.2, 0.5]]), np.array([[0, 0, 1], [0.6, 0, 0.8]])
    )
    plan = plan_path(ROBOT, rolling, torque_rate=np.inf)
    assert plan.summary()["length_mm"] == pytest.approx(200.0, abs=0.01)
    # the parameter of the joint path counts the turning, too
    assert plan.certificate.path.length > 0.205
    assert plan.trajectory.s[-1] == pytest.approx(plan.length, abs=1e-12)
    # turning on the spot comes first; the place in a message does not count it
    points = np.array([[0.9, 0, 0.5], [0.9, 0, 0.5], [1.6, 0, 0.5]])
    longer = builders.way_points(points, np.array([[0.6, 0, 0.8], [0, 0, 1], [0, 0, 1]]))
    weak = replace(MotionLimits.of(ROBOT), tau_max=np.array([1300, 300, 700, 140, 150, 60.0]))
    with pytest.raises(
        InfeasibleError, match=r"at \d+\.\d mm, axis 2 cannot hold the arm"
    ) as caught:
        plan_path(ROBOT, longer, limits=weak, free_tool_rotation=False)
    assert 650.0 < float(str(caught.value).split()[1]) <= 700.1


def test_passages_are_placed_by_the_tip() -> None:
    path = build(MODEL, kind="wrist", miss=0.01)
    plan = plan_path(ROBOT, path, free_tool_rotation=False, torque_rate=np.inf)
    (passage,) = plan.passages
    # the tip's way between the poses, not the parameter that counts the turning
    way = np.linalg.norm(np.diff(plan.path.position, axis=0), axis=1)
    assert passage["at_mm"] == pytest.approx(1e3 * way[:20].sum(), rel=0.02)
