"""Parts of the enclosure, the law between its grid points and the limits, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_cells import (
    M,
    N,
    along,
)

from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure import bernstein, parabolas
from irb2400_ctrl.planners.enclosure import cells as enclosed
from irb2400_ctrl.planners.enclosure.cells import with_reversals
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw


def test_the_law_is_motion_at_constant_acceleration() -> None:
    """v = 0 -> 2 m/s over 1 m, 2 m/s over 3 m, to rest over 0.5 m: by the school's formulas."""
    law = PiecewiseConstantLaw(np.array([0.0, 1.0, 4.0, 4.5]), np.array([0.0, 4.0, 4.0, 0.0]))
    np.testing.assert_allclose(law.u, [2.0, 0.0, -4.0])
    np.testing.assert_allclose(law.time, [0.0, 1.0, 2.5, 3.0])
    assert law.duration == 3.0
    time = np.array([-1.0, 0.0, 0.5, 1.0, 1.75, 2.75, 3.0, 9.0])
    s, v, u = law.at(time)
    np.testing.assert_allclose(s, [0.0, 0.0, 0.25, 1.0, 2.5, 4.375, 4.5, 4.5])
    np.testing.assert_allclose(v, [0.0, 0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0])
    np.testing.assert_allclose(u, [0.0, 2.0, 2.0, 0.0, 0.0, -4.0, 0.0, 0.0])
    x, u = law.on(np.array([0.0, 0.5, 1.0, 4.25, 4.5]))
    np.testing.assert_allclose(x, [0.0, 2.0, 4.0, 2.0, 0.0])
    np.testing.assert_allclose(u, [2.0, 2.0, 0.0, -4.0, -4.0])
    np.testing.assert_allclose(law.largest, [4.0, 4.0, 4.0])
    slow = law.slowed(2.0)
    np.testing.assert_allclose(slow.x, [0.0, 1.0, 1.0, 0.0])
    np.testing.assert_allclose(slow.duration, 6.0)


def test_a_law_slowed_where_it_is_asked_for() -> None:
    law = PiecewiseConstantLaw(np.array([0.0, 1.0, 4.0, 4.5]), np.array([0.0, 4.0, 4.0, 0.0]))
    time = np.linspace(0.0, 3.0, 13)
    as_it_is = law.slowed_at(time, np.ones(13))
    np.testing.assert_array_equal(as_it_is.s, law.s)
    np.testing.assert_array_equal(as_it_is.x, law.x)
    factor = np.where(np.isclose(time, 1.75), 2.0, 1.0)
    slow = law.slowed_at(time, factor)
    # passed at 1.5, 1.75 and 2 s; the sample at 1.75 alone is slower
    np.testing.assert_allclose(slow.s, [0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 4.5])
    np.testing.assert_allclose(slow.x, [0.0, 4.0, 4.0, 1.0, 4.0, 4.0, 0.0])
    # what falls on a point of the grid is no point more, and is slower there
    at_point = law.slowed_at(np.array([1.0, 1.5]), np.array([2.0, 1.0]))
    np.testing.assert_allclose(at_point.s, [0.0, 1.0, 2.0, 4.0, 4.5])
    np.testing.assert_allclose(at_point.x, [0.0, 1.0, 4.0, 4.0, 0.0])


def test_grids_are_cut_into_equal_parts() -> None:
    found = divided(np.array([0.0, 1.0, 4.0, 4.5]), np.array([2, 3, 1]))
    np.testing.assert_allclose(found, [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 4.5])


def test_square_of_a_parabola_lies_within_what_its_own_parabola_misses() -> None:
    rng = np.random.default_rng(17)
    speed = rng.normal(size=(M, 3, N))
    parabola, missed = enclosed._square(speed)
    off = np.abs(along(speed) ** 2 - along(parabola))
    assert (off <= missed[:, None] + 1e-12).all()
    # at most twice what is there, and nothing for a straight line squared
    np.testing.assert_allclose(off[:, [0, 50, 100]], 0.0, atol=1e-12)
    assert np.median(missed / off.max(axis=1)) < 1.6
    line = bernstein.raised(speed[:, :2], 2)
    np.testing.assert_allclose(enclosed._square(line)[1], 0.0, atol=1e-12)
    # of t^2 squared, t^4: what the parabola through 0, 1/16 and 1 leaves, at most
    quartic, left = enclosed._square(np.array([[[0.0], [0.0], [1.0]]]))
    np.testing.assert_allclose(quartic[0, :, 0], [0.0, 2 / 16 - 1 / 2, 1.0])
    np.testing.assert_allclose(left, np.sqrt(3) / 36 * 2.5)


def test_the_circle_of_a_middle_is_as_large_as_the_fastest_joint_lets_it() -> None:
    """No joint turns by more than a quarter radian on twice of it, by any derivative."""
    calm = np.array([[1e-9, 1e-9]])
    for order, moved in ((1, 0.25 / 2.0), (2, np.sqrt(0.25 / 2.0)), (3, np.cbrt(0.25 / 2.0))):
        motion = [calm, calm, calm, calm]
        motion[order] = np.array([[0.1, -2.0]])
        np.testing.assert_allclose(parabolas._reach(tuple(motion)), [moved / 2])


def test_a_grid_of_a_path_that_never_turns_back_stays_as_it_is() -> None:
    W = np.array([[0.0, 0.1, 0, 0, 0.5, 0], [0.2, 0.2, 0.1, 0.1, 0.6, 0.1]])
    path = JointPath.through(np.array([0.0, 1.0]), W)
    s = np.linspace(0.0, 1.0, 11)
    np.testing.assert_array_equal(with_reversals(path, s), s)


@pytest.mark.parametrize("off", [-1e-12, 1e-12])
def test_of_points_that_fall_together_the_knot_stays(off: float) -> None:
    W = np.array(
        [[0.0, 0.1, 0, 0, 0.5, 0], [0.1, 0.2, 0.1, 0.1, 0.6, 0.1], [0.3, 0.3, 0.2, 0.3, 0.8, 0.2]]
    )
    path = JointPath.through(np.array([0.0, 0.5, 1.0]), W)
    s = np.linspace(0.0, 1.0, 11)
    assert 0.5 in path.knots
    np.testing.assert_array_equal(with_reversals(path, np.sort(np.append(s, 0.5 + off))), s)


def test_c_lies_between_the_directions_that_occur() -> None:
    """From those for motion backwards, at rest, forwards: 1, 2, 3, or with a range around them."""
    c = [k * np.ones((4, 3, 1)) for k in (1.0, 2.0, 3.0)]
    forwards = np.array([[True], [False], [True], [False]])
    backwards = np.array([[False], [True], [True], [False]])
    low, high = enclosed._static_band(c, [], forwards, backwards)
    np.testing.assert_array_equal(low[:, 0, 0], [3.0, 1.0, 1.0, 2.0])
    np.testing.assert_array_equal(high[:, 0, 0], [3.0, 1.0, 3.0, 2.0])
    around = [enclosed.Range(-0.1 * k * c[0], 0.2 * k * c[0]) for k in (1, 2, 3)]
    low, high = enclosed._static_band(c, around, forwards, backwards)
    np.testing.assert_allclose(low[:, 0, 0], [2.7, 0.9, 0.9, 1.8])
    np.testing.assert_allclose(high[:, 0, 0], [3.6, 1.2, 3.6, 2.4])


def test_a_hair_of_rounding_is_no_motion() -> None:
    s = np.array([0.0, 1.0, 2.0])
    eps = np.finfo(float).eps
    curvature = np.ones((2, 2, 1))
    # 32 roundings of the length, 2, times q'', and of the speed itself
    noise = 32 * eps * (2.0 + 1.0)
    for size, moves in ((0.9 * noise, False), (1.1 * noise, True)):
        speed = np.array([[[1.0], [0.5], [-size]], [[-1.0], [-0.5], [size]]])
        forwards, backwards = enclosed._directions(s, speed, curvature)
        np.testing.assert_array_equal(forwards[:, 0], [True, moves])
        np.testing.assert_array_equal(backwards[:, 0], [moves, True])


def test_factors_of_the_time_add_their_ranges_and_what_is_missed() -> None:
    ones = np.ones((2, 3, 1))
    fitted = [float(k) * ones for k in range(12)]
    remainder = np.arange(12.0)[:, None, None] * np.ones((12, 2, 1))
    low = np.array([-2.0])
    high = np.array([1.0])
    ranges, rest = enclosed._time_ranges(fitted, remainder, (low, high))
    np.testing.assert_allclose([r.low[0, 0, 0] for r in ranges], [-2.0 * k for k in range(6, 12)])
    np.testing.assert_allclose([r.high[0, 0, 0] for r in ranges], range(6, 12))
    np.testing.assert_allclose(rest[:, 0, 0], [k + 2.0 * (k + 6) for k in range(6)])
    none = np.zeros(0)
    assert enclosed._time_ranges(fitted, remainder, (none, none))[0] == []


ARM = MotionLimits(np.array([1.0, 2.0]), np.array([30.0, 40.0]), np.array([np.inf, 5.0]))
RAIL = ExternalAxes(
    names=("turn",), direction=np.array([[0.0, 0, 1]]), point=np.zeros((1, 3)),
    low=np.array([-1.0]), high=np.array([1.0]), speed=np.array([0.5]),
    acceleration=np.array([2.0]), jerk=np.array([7.0]),
)  # fmt: skip


def test_limits_may_only_be_tightened() -> None:
    wider = replace(ARM, tau_max=np.array([30.0, 40.0 * (1 + 2e-9)]))
    assert ARM.within(ARM) is ARM
    with pytest.raises(InputError, match=r"tau_max of axis 2 is 40 Nm"):
        wider.within(ARM)
    assert replace(ARM, tau_max=np.array([30.0, 40.0 * (1 + 5e-10)])).within(ARM)
    with pytest.raises(
        InputError, match=r"found qd_max = array\(\[0., 2.\]\), expected a positive"
    ):
        replace(ARM, qd_max=np.array([0.0, 2.0]))
    with pytest.raises(InputError, match=r"found qdd_max = array\(\[ 1., nan\]\), expected a pos"):
        replace(ARM, qdd_max=np.array([1.0, np.nan]))


def test_rates_are_for_all_axes_or_for_each() -> None:
    assert not ARM.smooth
    rated = ARM.with_rates(100.0, [np.inf, 9.0])
    assert rated.smooth
    np.testing.assert_array_equal(rated.torque_rate, [100.0, 100.0])
    np.testing.assert_array_equal(rated.jerk, [np.inf, 9.0])
    assert not ARM.with_rates(np.inf, None).smooth
    assert ARM.with_rates(None, 3.0).smooth
    assert ARM.with_rates(None, [np.inf, 9.0]).smooth
    for wrong in (0.0, -1.0, [1.0, 0.0], [1.0, 2.0, 3.0], np.nan):
        with pytest.raises(InputError, match="torque_rate"):
            ARM.with_rates(wrong, None)


def test_external_axes_stand_behind_the_arms() -> None:
    found = ARM.with_external(RAIL, None)
    np.testing.assert_array_equal(found.qd_max, [1.0, 2.0, 0.5])
    np.testing.assert_array_equal(found.tau_max, [30.0, 40.0, 2.0])
    np.testing.assert_array_equal(found.qdd_max, [np.inf, 5.0, np.inf])
    np.testing.assert_array_equal(found.torque_rate, [np.inf, np.inf, 7.0])
    assert found.jerk is None
    rated = ARM.with_rates(100.0, 9.0)
    # the smaller of the axis' jerk, 7, and three times its acceleration a second
    np.testing.assert_array_equal(rated.with_external(RAIL, 3.0).torque_rate, [100.0, 100.0, 6.0])
    np.testing.assert_array_equal(rated.with_external(RAIL, 4.0).torque_rate, [100.0, 100.0, 7.0])
    np.testing.assert_array_equal(rated.with_external(RAIL, 4.0).jerk, [9.0, 9.0, np.inf])
    np.testing.assert_array_equal(found.with_room(2, 0.5).tau_max, [30.0, 40.0, 1.0])
    first = rated.with_external(RAIL, 3.0).first(2)
    for name in ("qd_max", "tau_max", "qdd_max", "torque_rate", "jerk"):
        np.testing.assert_array_equal(getattr(first, name), getattr(rated, name))
    assert found.first(2).jerk is None
    assert ARM.first(1).torque_rate is None
