"""A torque that is cut is said, wherever that happens."""

from __future__ import annotations

import numpy as np
from simulation.planar_arm import planar, reach
from simulation.test_own_block import own

from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.simulation import Actuators, simulate


def test_of_a_controller_that_knows_less_torque_than_the_drive_has() -> None:
    run = simulate(planar(torque=44.0), reach(-1.0), "computed_torque", plant=planar())
    assert np.abs(run.tau[:, 0]).max() <= 44.0
    assert run.summary()["bounds_reached"]["torque_limit"] == [1]
    assert run.summary()["saturated_share"][0] > 0.0


def test_behind_a_lag_that_the_torque_does_not_catch_up_with() -> None:
    lagging = Actuators(lag_s=0.01)
    run = simulate(planar(torque=51.0), reach(-1.0), "computed_torque", actuators=lagging)
    assert np.abs(run.tau[:, 0]).max() < 51.0 * (1 - 1e-4)
    assert run.summary()["bounds_reached"]["torque_limit"] == [1]


def test_none_is_said_of_one_that_is_not() -> None:
    run = simulate(planar(), reach(-1.0), "computed_torque")
    assert run.summary()["bounds_reached"]["torque_limit"] == []


def test_at_a_limit_that_a_gain_lowers_or_a_block_of_ones_own_states() -> None:
    """Of these it said nothing."""
    run = simulate(planar(), reach(-1.0), "computed_torque", gains={"tau_limit": [44.0, 50.0]})
    assert run.summary()["bounds_reached"]["torque_limit"] == [1]
    run = simulate(planar(), reach(), own(low=-10.0, high=1.0))
    assert run.summary()["bounds_reached"]["torque_limit"] == [1, 2]
    assert simulate(planar(), reach(), own()).summary()["saturated_share"] == [0.0, 0.0]


def test_the_error_limit_of_a_gain_is_the_one_that_was_passed() -> None:
    block = guarded(controller("pid", planar()), planar())
    run = simulate(planar(), reach(), block, gains={"error_limit": 1e-3})
    assert run.summary()["bounds_reached"]["brake_closed_far_from_reference"]
