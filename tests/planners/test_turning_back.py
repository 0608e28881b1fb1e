"""Where the tool turns back (the bottom of a hole), all joints turn back at one place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.planners import Plan, ToolPath, builders, plan_path
from irb2400_ctrl.planners.enclosure.cells import with_reversals
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.programs.rapid import read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_plan
from irb2400_ctrl.planners.toolpath.task_curve import smooth_curve, turning_back
from irb2400_ctrl.planners.toolpath.work_frame import work_frame

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Turning(JointPath):
    """A path whose joints turn back where the test says."""

    roots: tuple[float, ...] = ()

    def reversals(self) -> Array:
        return np.array(self.roots)


@pytest.mark.parametrize(
    "beside",
    [
        (4e-12,),
        (4e-12, 4.001e-12, 4.002e-12, 4.1e-12),
        (-4.1e-12, -4e-12),
        (-4e-12, 1e-16, 4e-12, 5e-12),
    ],
)
def test_of_points_that_fall_together_the_knot_stays(beside: tuple[float, ...]) -> None:
    knots = np.array([0.0, 0.05, 0.1])
    still = np.zeros((4, 2, 6))
    roots = [0.05 + b for b in beside]
    path = Turning(knots, still, (*roots, 0.0713, 0.0713 + 1e-15))
    s = with_reversals(path, np.linspace(0, 0.1, 41))
    # 41 even points, one of them the knot, and one more for the joints that turn back elsewhere
    assert len(s) == 42
    assert np.isin(knots, s).all()
    assert np.diff(s).min() > 1e-5


# down to the bottoms of two holes, the second in two steps
HEIGHTS = [(10, 2), (10, -12), (10, 2), (20, 2), (20, -6), (20, -5), (20, -12), (20, 2)]
HOLES = 1e-3 * np.array([(10, 40, 2), *((x, 10, z) for x, z in HEIGHTS)])
FEED = np.array([np.inf, np.inf, 5e-3, np.inf, np.inf, 5e-3, np.inf, 5e-3, np.inf])
PLACE = (0.9, -0.05, 0.56)


@pytest.fixture(scope="module")
def two_holes() -> Plan:
    path = ToolPath(HOLES, np.tile([0.0, 0.0, 1.0], (9, 1)), None, FEED, "two holes")
    return plan_path(load_robot("irb2400"), path, work_frame=work_frame("900,-50,560,0,0,0"))


def test_two_holes_behind_a_long_rapid_move(two_holes: Plan) -> None:
    assert two_holes.guaranteed
    assert two_holes.max_feed_ratio is not None
    assert two_holes.max_feed_ratio <= 1


def test_holes_are_as_deep_as_stated(two_holes: Plan) -> None:
    rows = two_holes.trajectory
    motion = CubicHermiteSpline(rows.time, rows.q, rows.qd)
    time = np.linspace(0, rows.duration, 20 * len(rows.time))
    tip = Model(two_holes.robot).tcp_pose(motion(time))[:, :3, 3] - PLACE
    for bottom in HOLES[[2, 5, 6, 7]]:
        assert np.linalg.norm(tip - bottom, axis=1).min() < 2e-6
    assert tip[:, 2].min() > -0.012 - 2e-6


def test_rapid_stops_at_the_bottom_of_a_hole(two_holes: Plan) -> None:
    module = read_rapid(rapid_of_plan(two_holes).text)
    model = Model(two_holes.robot)
    tip = model.tcp_pose(module.joint_angles(model))[:, :3, 3] - PLACE
    for bottom in HOLES[[2, 5, 6, 7]]:
        near = np.linalg.norm(tip - bottom, axis=1)
        assert near.min() < 1e-5
        assert module.moves[int(near.argmin())].stops
    assert sum(move.stops for move in module.moves) == 6


@settings(max_examples=40, deadline=None)
@given(
    st.floats(150.1, 180),
    st.tuples(*[st.floats(0.1, 100)] * 2),
    st.sampled_from([1e-5, 5e-5, 1e-3]),
)
def test_a_curve_reaches_the_point_where_it_turns_back_and_goes_no_farther(
    turn: float, lengths: tuple[float, float], tolerance: float
) -> None:
    into = np.array([0.0, 0, -1e-3 * lengths[0]])
    angle = np.radians(turn)
    out = 1e-3 * lengths[1] * np.array([np.sin(angle), 0, -np.cos(angle)])
    path = builders.way_points([-into, np.zeros(3), out])
    curve = smooth_curve(path, tolerance)
    assert turning_back(path).tolist() == [1]
    places = curve(np.linspace(0, curve.segments, 60 * curve.segments + 1))[:, :3]
    assert np.linalg.norm(places, axis=1).min() < 1e-12
    deepest = into / np.linalg.norm(into) - out / np.linalg.norm(out)
    assert (places @ deepest).max() < 1e-12


def test_a_corner_that_does_not_turn_back_is_rounded() -> None:
    path = builders.way_points([[0, 0, 0], [0.1, 0, 0], [0.02, 0.08, 0]])
    assert len(turning_back(path)) == 0
    curve = smooth_curve(path, 1e-4)
    places = curve(np.linspace(0, curve.segments, 60 * curve.segments + 1))[:, :3]
    assert np.linalg.norm(places - [0.1, 0, 0], axis=1).min() == pytest.approx(1e-4, rel=0.1)
