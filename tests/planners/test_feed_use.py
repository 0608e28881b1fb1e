"""What a plan says about its feed, against the motion itself."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners import Plan, builders, plan_path
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.feed_use import HELD, _joined
from irb2400_ctrl.planners.timing.motion_limits import linear_bounds
from irb2400_ctrl.planners.timing.sampled_timing import guarantee_note

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
CORNER = [[0.9, 0.0, 0.5], [0.95, 0.0, 0.5], [0.95, 0.05, 0.5]]


def speeds(plan: Plan) -> tuple[Array, Array]:
    """Times and speeds of the TCP, 20,000 times a second [s], [m/s]."""
    time = np.arange(0.0, plan.duration, 5e-5)
    _, q, qd, _ = plan.certificate.law.motion(plan.certificate.path, time)
    step = np.arange(0, len(q), 4)
    rates = [MODEL.tcp_jacobian(q[k])[:3] @ qd[k] for k in step]
    return time[step], np.linalg.norm(rates, axis=1)


@pytest.fixture(scope="module")
def corner() -> Plan:
    return plan_path(ROBOT, builders.way_points(CORNER, feed=0.1))


def test_stretches_with_less_than_half_a_millimetre_between_them_are_one() -> None:
    way = 1e-4 * np.array([0, 1, 2, 6, 7, 13, 14])
    assert _joined(np.array([(0, 2), (3, 4), (5, 6)]), way) == [(0, 4), (5, 6)]


def test_the_share_at_the_feed_is_that_of_the_motion(corner: Plan) -> None:
    use = corner.feed_use
    assert use is not None
    time, speed = speeds(corner)
    assert speed.max() <= 0.1 * (1 + 1e-9)
    held = np.trapezoid(np.where(speed >= HELD * 0.1, speed, 0.0), time)
    assert use.programmed == pytest.approx(0.1, rel=2e-3)
    assert use.held == pytest.approx(held, abs=5e-4)
    assert use.share > 0.9


def test_stretches_say_where_and_why(corner: Plan) -> None:
    use = corner.feed_use
    assert use is not None
    assert [part.place for part in use.stretches] == ["start", "corner", "end"]
    assert [part.point for part in use.stretches] == [1, 2, 3]
    time, speed = speeds(corner)
    for part in use.stretches:
        assert part.limit.split(" of ")[0] in {"torque", "speed", "torque rate, jerk or the rows"}
        inside = (time >= part.time[0]) & (time <= part.time[1])
        assert speed[inside].min() <= part.slowest * (1 + 1e-3)
    turn = use.stretches[1]
    inside = (time >= turn.time[0]) & (time <= turn.time[1])
    assert turn.slowest == pytest.approx(speed[inside].min(), rel=0.05)
    assert turn.begin < 0.05 < turn.end
    summary = corner.summary()["feed"]
    assert summary["share_at_feed"] == use.share
    assert sum(summary["below_by_place_mm"].values()) == pytest.approx(
        sum(summary["below_by_limit_mm"].values())
    )


def test_a_feed_that_an_axis_cannot_keep_names_the_axis() -> None:
    # the tool turns by 80 deg over 40 mm: at 1 m/s an axis would have to turn too fast
    lean = np.radians(np.linspace(-40, 40, 41))
    places = np.array([0.9, 0.0, 0.5]) + np.linspace(0, 0.04, 41)[:, None] * [1.0, 0.0, 0.0]
    axes = np.stack([np.sin(lean), 0 * lean, np.cos(lean)], axis=1)
    plan = plan_path(ROBOT, builders.way_points(places, axes, feed=1.0))
    use = plan.feed_use
    assert use is not None
    assert use.share < 0.1
    # what is said to be reached is reached
    time = np.linspace(0, plan.duration, 2000)
    _, q, qd, qdd = plan.certificate.law.motion(plan.certificate.path, time)
    used = {
        "speed": (np.abs(qd) / ROBOT.qd_max).max(axis=0),
        "torque": (np.abs(MODEL.inverse_dynamics(q, qd, qdd)) / ROBOT.tau_max).max(axis=0),
    }
    named = [part.limit for part in use.stretches if " of axis " in part.limit]
    assert named
    for limit in named:
        kind, axis = limit.split(" of axis ")
        assert used[kind][int(axis) - 1] > 0.9


def test_without_a_feed_nothing_is_said() -> None:
    plan = plan_path(ROBOT, builders.way_points(CORNER[:2]))
    assert plan.feed_use is None
    assert plan.summary()["feed"] is None


def test_a_bound_that_is_linear_in_the_cells_keeps_the_feed_and_wastes_little() -> None:
    G = np.random.default_rng(3).uniform(0.8, 1.2, (50, 5, 2))
    first, last = linear_bounds(G)
    t = np.linspace(0, 1, 101)
    value = np.einsum("tk,mkj->mtj", bernstein.basis(4, t), G).max(axis=2)
    x = first[:, None] + (last - first)[:, None] * t
    assert (value * x <= 1 + 1e-12).all()
    assert (value * x).max(axis=1).min() > 0.8
    # where the speed changes evenly nothing is lost
    even = bernstein.linear(np.full((1, 1), 1.0), np.full((1, 1), 1.21))
    raised = bernstein.product(even, np.ones((1, 4, 1)))
    ends = linear_bounds(raised)
    assert np.allclose(ends[:, 0], [1.0, 1 / 1.21], rtol=0.02)


def test_the_axes_of_a_cell_have_their_names() -> None:
    seventh = PathDynamics(MODEL, 3, (0.0, 1.0, 0.0))
    names = [seventh.axis(j) for j in (5, 6, 7, 8)]
    assert names == ["axis 6", *(f"external axis {name}" for name in ("rail", "tilt", "turn"))]
    assert PathDynamics(MODEL, 2).axis(7) == "external axis turn"


def test_what_is_not_guaranteed_says_what_to_try() -> None:
    dynamics = PathDynamics(MODEL)
    assert guarantee_note(dynamics, certified=True, holds=True) == ""
    # an option of the command, too, which has none for the cells
    assert "--tolerance-mm" in guarantee_note(dynamics, certified=True, holds=False)
