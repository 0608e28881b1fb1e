"""Closed loops on an arm of two axes, and on one whose file leaves its torque limits out."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.planar_arm import planar, reach

from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded
from irb2400_ctrl.report.pages.simulation_page import simulation_page
from irb2400_ctrl.simulation import make_loop, simulate


@pytest.mark.parametrize("name", CONTROLLERS)
def test_every_controller_moves_an_arm_of_two_axes(name: str) -> None:
    """`adaptive` divided by what a planar arm's motion shows of a load's place along its axes."""
    run = simulate(planar(), reach(), guarded(controller(name, planar()), planar()))
    assert np.degrees(np.abs(run.q - run.q_ref).max()) < 2.0
    assert run.summary()["bounds_reached"]["brake_closed_s"] is None


def test_a_load_is_learned_where_the_motion_shows_it() -> None:
    rate = next(f for f in controller("adaptive", planar()).parameters if f.name == "rate")
    assert rate.default.count(0.0) == 1
    assert max(rate.default) < 1e4


def test_a_closed_brake_holds_an_axis_of_unknown_torque_limit() -> None:
    """It held with nothing, the arm fell from where it was."""
    robot = planar(limits=False)
    loop = make_loop(robot, guarded(controller("computed_torque", robot), robot))
    lost = np.arange(1501) >= 400
    run = loop.run(reach(), lost=lost, hold=0.5)
    closed = run.summary()["bounds_reached"]["brake_closed_s"]
    assert closed == pytest.approx(0.42)
    later = run.time > closed + 0.1
    assert np.abs(run.qd[later]).max() < 1e-6


def test_an_unknown_torque_limit_has_no_share() -> None:
    run = simulate(planar(limits=False), reach(), "computed_torque")
    assert run.summary()["max_torque_ratio"] == [None, None]
    assert run.summary()["saturated_share"] == [0.0, 0.0]
    page = simulation_page(run, "computed_torque").html()
    assert "limits unknown" in page
    assert "torque share" not in page
