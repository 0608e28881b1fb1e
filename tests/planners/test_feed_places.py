"""The programmed feed holds from the way-point on at which it changes."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.planners import builders, plan_path
from irb2400_ctrl.planners.timing.feed_use import _corners
from irb2400_ctrl.planners.toolpath.task_curve import smooth_curve

ROBOT = load_robot("irb2400")


@pytest.mark.parametrize(
    "before", [0.002, *(pytest.param(time, marks=pytest.mark.slow) for time in (0.007, 0.05))]
)
def test_a_rapid_approach_ends_where_the_cut_begins(before: float) -> None:
    # down a straight line: rapid to 0.55, then 100 mm at 5 mm/s
    top = 0.55 + before
    points = [[0.9, 0.0, 0.75], [0.9, 0.0, top], [0.9, 0.0, 0.55], [0.9, 0.0, 0.45]]
    path = builders.way_points(points, feed=[np.inf, np.inf, np.inf, 5e-3])
    plan = plan_path(ROBOT, path, rate=500.0)
    model = Model(ROBOT)
    z = np.array([model.tcp_pose(q)[2, 3] for q in plan.trajectory.q])
    speed = np.abs(np.diff(z)) * 500
    cutting = z[:-1] < 0.55 - 1e-4
    assert cutting.sum() > 1000
    assert speed[cutting].max() <= 5e-3 * 1.001
    assert speed[~cutting].max() > 0.1


def test_segments_meet_at_way_points_where_the_feed_changes() -> None:
    points = np.array([[0, 0, 0], [0.007, 0, 0], [0.19, 0, 0], [0.2, 0, 0]])
    slow = builders.way_points(points, feed=[np.inf, np.inf, 1e-3, 2e-3])
    curve = smooth_curve(slow, 5e-5)
    for number in (2, 3):
        first = int(np.argmax(curve.origin == number))
        place = curve(np.array([float(first)]))[0, :3]
        assert np.allclose(place, points[number - 1], atol=1e-6)
    # without a change nothing is added
    even = smooth_curve(builders.way_points(points, feed=1e-3), 5e-5)
    assert len(even.control) == len(points) + 2


@pytest.mark.parametrize(("bend", "smooth"), [(0.28, True), (0.32, False)])
def test_a_path_bends_gently_up_to_three_tenths_of_a_radian(bend: float, smooth: bool) -> None:
    turn = bend * np.arange(8)
    points = np.cumsum(0.005 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1), axis=0)
    curve = smooth_curve(builders.way_points(points), 5e-5)
    passed = curve(np.searchsorted(curve.origin, np.arange(8), side="right").astype(float))[:, :3]
    assert np.allclose(passed, points, atol=1e-9) == smooth
    assert len(_corners(curve)) == (0 if smooth else 6)
