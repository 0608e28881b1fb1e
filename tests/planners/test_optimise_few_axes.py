"""Motions of free geometry on an arm that has no singularity factors."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.planar_arm import planar

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import optimise_motion

WAYPOINTS = [[-1.0, 0.5], [0.2, -0.8], [1.0, 0.6]]


def test_an_arm_of_two_axes_is_optimised_and_has_no_margins() -> None:
    """Joint space needs no closed form, but the factors were asked for all the same."""
    found = optimise_motion(planar(), WAYPOINTS, intervals=40)
    assert not found.fell_back
    assert found.ratio < 0.95
    assert found.motion.margins == {}
    assert found.motion.checked.torque_ratio <= 1.0
    assert np.abs(found.waypoints - WAYPOINTS).max() == 0.0


def test_a_margin_of_a_factor_that_the_arm_lacks_is_refused() -> None:
    with pytest.raises(InputError, match="no singularity factors for this arm"):
        optimise_motion(planar(), WAYPOINTS, margins={"wrist": 0.1})
