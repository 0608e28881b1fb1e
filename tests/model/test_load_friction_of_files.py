"""What a robot file says of friction that grows with the load."""

from __future__ import annotations

import numpy as np
import pytest
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError


def test_load_friction_of_a_file_departs_by_a_power_of_the_load_alone(
    robot: irb.Robot, states: States
) -> None:
    """Older files hold one number; that it holds more where the load brakes is of one log."""
    mu = 0.05
    power = 0.01
    one = LIBRARY["load_friction"].of(2, coefficient=mu, discrepancy=(power,))
    rigid = irb.Model(robot).inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    load = np.abs(np.asarray(rigid)[:, 1])
    whole = irb.Model(robot.with_effects(one)).inverse_dynamics(states.q, states.qd, states.qdd)
    plain = irb.Model(robot).inverse_dynamics(states.q, states.qd, states.qdd)
    more = (mu * load + power * load * np.log(load / 50.0 + 1e-3)) * np.sign(states.qd[:, 1])
    fast = np.abs(states.qd[:, 1]) > 0.1
    assert fast.any()
    found = np.asarray(whole - plain)
    np.testing.assert_allclose(found[fast, 1], more[fast], rtol=1e-6, atol=1e-6)
    with pytest.raises(InputError, match="a discrepancy of 2 numbers, expected 1 or none"):
        robot.with_effects(LIBRARY["load_friction"].of(2, coefficient=mu, discrepancy=(0.1, 0.1)))
