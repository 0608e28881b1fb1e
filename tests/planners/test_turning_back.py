"""Where the tool turns back (the bottom of a hole), all joints turn back at one place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.planners import ToolPath, plan_path
from irb2400_ctrl.planners.enclosure.cells import with_reversals
from irb2400_ctrl.planners.joint_path import JointPath
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


def test_two_holes_behind_a_long_rapid_move() -> None:
    places = [[10, 40, 2], [10, 10, 2], [10, 10, -12], [10, 10, 2], [20, 10, 2], [20, 10, -12]]
    position = 1e-3 * np.array([*places, [20, 10, 2]])
    feed = np.array([np.inf, np.inf, 5e-3, np.inf, np.inf, 5e-3, np.inf])
    path = ToolPath(position, np.tile([0.0, 0.0, 1.0], (7, 1)), None, feed, "two holes")
    plan = plan_path(load_robot("irb2400"), path, work_frame=work_frame("900,-50,560,0,0,0"))
    assert plan.guaranteed
    assert plan.max_feed_ratio is not None
    assert plan.max_feed_ratio <= 1
