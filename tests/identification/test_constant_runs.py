"""Friction from runs at constant speed: eqs. 70-74, Tab. 5."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from identification.slow_runs import LAW, OFFSET, log_of

import irb2400_ctrl as irb
from irb2400_ctrl.excitation.friction_runs import few_speeds, velocity_grid
from irb2400_ctrl.identification.constant_runs import friction_points, runs_of
from irb2400_ctrl.identification.friction_curve import (
    friction_curves,
    log_of_runs,
    with_curves,
)
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.report.figures.friction_figures import friction_figure, law_rows, run_figure

DATA = Path(str(files("irb2400_ctrl") / "data" / "arm"))
SPEEDS = [0.002, 0.004, 0.006, 0.008, 0.01, 0.014, 0.02, 0.05, 0.1, 0.2, 0.4]
TRUE = np.array([LAW.static, LAW.coulomb, LAW.viscous, LAW.stribeck])


def test_the_grid_is_that_of_the_paper() -> None:
    grid = velocity_grid()
    steps = np.diff(np.concatenate([[0.0], grid]))
    for low, high, step in ((0.0, 0.015, 1e-5), (0.015, 0.2, 2e-4), (0.2, 0.5, 1e-3)):
        inside = (grid > low + 1e-9) & (grid < high + 1e-9)
        np.testing.assert_allclose(steps[inside], step, rtol=1e-6)
    assert grid[0] == pytest.approx(1e-5)
    assert grid[-1] == pytest.approx(0.5)
    few = few_speeds()
    assert (np.diff(few) > 0).all()
    assert (few < 0.015).sum() >= 6


def test_half_the_difference_is_friction_and_half_the_sum_is_gravity() -> None:
    points = friction_points(runs_of(log_of(SPEEDS)))
    assert [p.forth.joint for p in points] == [2] * len(SPEEDS)
    for point, speed in zip(points, SPEEDS, strict=True):
        assert point.speed == pytest.approx(speed, rel=2e-3)
        assert abs(point.torque - LAW.torque(speed)) < 4.0 * max(point.error, 0.03)
        assert point.level == pytest.approx(100.0 * np.cos(-0.2) + OFFSET, abs=1.0)


def test_the_law_lies_within_its_errors() -> None:
    curve = friction_curves(runs_of(log_of(SPEEDS)))[0]
    assert curve.joint == 2
    assert curve.shows_rise
    assert (np.abs(curve.law - TRUE) < 3.5 * curve.errors).all()
    assert (curve.errors < [0.6, 0.4, 2.0, 8e-4]).all()
    robot = with_curves(irb.load_robot("irb2400"), [curve])
    np.testing.assert_allclose(robot.friction[1], curve.law)
    np.testing.assert_allclose(robot.friction[0], irb.load_robot("irb2400").friction[0])


@pytest.mark.parametrize("slowest", [3, 4])
def test_runs_above_the_stribeck_speed_do_not_bend_the_law(slowest: int) -> None:
    """A straight line through a rise that is clear had half of the viscous friction."""
    curve = friction_curves(runs_of(log_of(SPEEDS[slowest:])))[0]
    assert curve.shows_rise
    assert (np.abs(curve.law - TRUE) < 3.5 * curve.errors).all()
    assert curve.law[1:3] == pytest.approx(TRUE[1:3], rel=0.05)


def test_a_rise_that_the_runs_do_not_show_is_not_made_up() -> None:
    """Fast runs alone, and friction without a rise: the file's own rise stays."""
    flat = FrictionLaw(20.0, 20.0, 9.0, 0.008)
    given = irb.load_robot("irb2400")
    for log in (log_of(SPEEDS[-4:]), log_of(SPEEDS, law=flat)):
        curve = friction_curves(runs_of(log))[0]
        assert not curve.shows_rise
        assert "slower runs would help" in curve.says()
        assert curve.law[1:3] == pytest.approx(TRUE[1:3], abs=1.5)
        friction = with_curves(given, [curve]).friction[1]
        before = given.friction[1]
        assert friction[0] - friction[1] == pytest.approx(before[0] - before[1])
        assert friction[3] == before[3]
        assert curve.to_json()["stribeck_rad_s"] is None
        assert "not shown" in law_rows([curve])[1][0]


def test_a_joint_that_sticks_and_slips_is_left_out_and_said() -> None:
    def jerks(time: np.ndarray) -> np.ndarray:
        return np.where(time < 20.0, 2e-4 * np.sin(2 * np.pi * 10.0 * time), 0.0)

    log = log_of(SPEEDS, jerks=jerks)
    runs = runs_of(log)
    assert any(not run.steady for run in runs)
    curve = friction_curves(runs)[0]
    assert "stick and slip" in curve.says()
    assert min(p.speed for p in curve.points) > 0.002


def test_runs_in_another_posture_are_no_pair() -> None:
    log = log_of(SPEEDS)
    moving = np.gradient(log.q[:, 1], log.time) < 0
    q = np.array(log.q)
    q[:, 3] += np.where(moving, 0.1, 0.0)
    turned = irb.Log(log.time, q, log.tau, name="runs")
    assert friction_points(runs_of(turned)) == []


def test_an_ordinary_motion_has_none() -> None:
    log = irb.read_log(DATA / "identification.csv.gz")
    curves = friction_curves(runs_of(log))
    assert curves == []
    assert not log_of_runs(log, curves)
    slow = log_of(SPEEDS)
    curves = friction_curves(runs_of(slow))
    assert log_of_runs(slow, curves)
    # the same beside an hour of something else
    time = np.append(slow.time, slow.time[-1] + 3600.0)
    more = [np.vstack([part, part[-1]]) for part in (slow.q, slow.tau)]
    assert not log_of_runs(irb.Log(time, *more, name=slow.name), curves)


def test_figures_hold_every_point_and_both_directions() -> None:
    curve = friction_curves(runs_of(log_of(SPEEDS)))[0]
    panel = friction_figure([curve]).axes[0]
    slow = [p for p in curve.points if p.speed <= 0.15]
    drawn = panel.lines[0].get_xdata()
    assert len(drawn) == len(slow)
    assert len(run_figure(curve).axes[1].lines) == 3
