"""A motion whose rows swing above a limit is slower there, and keeps its own speed elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import builders, check, plan_path
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.sampled_reference.local_slowing import slowing
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

ROBOT = load_robot("irb2400")


def raster(lines: int = 3, points: int = 30) -> ToolPath:
    """Lines over waves, the tool tilting with them, 30 mm/s."""
    k = np.arange(lines * points)
    row, column = np.divmod(k, points)
    x = np.where(row % 2 == 0, column, points - 1 - column) - points / 2
    slope = 0.5 * np.cos(2 * np.pi * x / 60)
    size = np.hypot(slope, 1)
    z = 5 * np.sin(2 * np.pi * x / 60)
    place = np.stack([950 + x, 2.0 * row, 500 + z], axis=1)
    axis = np.stack([-slope / size, 0 * x, 1 / size], axis=1)
    return builders.way_points(1e-3 * place, axis, feed=0.03)


def test_the_factor_is_reached_where_it_is_wanted_and_is_one_farther_away() -> None:
    wanted = np.ones(200)
    wanted[[60, 120]] = 1.2, 1.05
    factor = slowing(wanted)
    assert (factor[[60, 61]] >= 1.2 - 1e-12).all()
    assert (factor[[120, 121]] >= 1.05 - 1e-12).all()
    assert (factor[:40] == 1).all()
    assert (factor[80:100] == 1).all()
    assert factor.max() <= 1.2 + 1e-12
    assert np.abs(np.diff(factor)).max() < 0.06


def test_the_factor_does_not_change_at_the_ends() -> None:
    wanted = np.ones(200)
    wanted[[3, 192]] = 1.3
    factor = slowing(wanted)
    assert np.ptp(factor[:5]) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(factor[-5:]) == pytest.approx(0.0, abs=1e-12)


def test_a_jumping_law_is_as_it_was_elsewhere() -> None:
    s = np.linspace(0.0, 1.0, 101)
    law = PiecewiseConstantLaw(s, np.minimum(np.minimum(2 * s, 2 * (1 - s)), 0.25))
    time = np.arange(0.0, law.duration, 0.004)
    factor = np.where(np.abs(time - law.duration / 2) < 0.05, 1.1, 1.0)
    slower = law.slowed_at(time, factor)
    at = np.interp(law.duration / 2, law.time, law.s)
    assert slower.on(np.array([at]))[0] == pytest.approx(law.on(np.array([at]))[0] / 1.21)
    outside = np.abs(s - at) > 0.05
    assert np.allclose(slower.on(s[outside])[0], law.x[outside])
    assert slower.duration - law.duration == pytest.approx(0.1 * 0.1, rel=0.2)


@pytest.mark.parametrize("torque_rate", [None, np.inf])
def test_a_tilting_raster_is_driven_at_its_feed(torque_rate: float | None) -> None:
    # its rows swing at every corner
    plan = plan_path(ROBOT, raster(), torque_rate=torque_rate)
    assert plan.guaranteed
    assert check(plan.certificate, Model(ROBOT)).holds()
    assert plan.max_feed_ratio is not None
    assert plan.max_feed_ratio <= 1
    assert plan.feed_use is not None
    assert plan.feed_use.share > 0.75


def test_rows_far_apart_from_a_rapid_move_into_a_slow_cut_keep_the_feed() -> None:
    path = builders.way_points([[0.9, 0.0, 0.5], [0.95, 0.0, 0.5], [0.952, 0.0, 0.5]], feed=0.002)
    path = replace(path, feed=np.array([np.inf, np.inf, 0.002]))
    plan = plan_path(ROBOT, path, rate=50.0, torque_rate=np.inf)
    assert plan.guaranteed
    assert plan.max_feed_ratio is not None
    assert plan.max_feed_ratio <= 1
