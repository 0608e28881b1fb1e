"""Time steps of the plant at slow controllers."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.planar_arm import planar, reach

from irb2400_ctrl.controllers import controller
from irb2400_ctrl.simulation import make_loop


@pytest.mark.parametrize(("rate", "steps"), [(4000.0, 1), (1000.0, 1), (400.0, 3), (20.0, 20)])
def test_no_time_step_is_longer_than_a_millisecond(rate: float, steps: int) -> None:
    assert make_loop(planar(), "gravity_pd", rate=rate).substeps == steps


def test_a_slow_controller_does_not_make_a_coarse_plant() -> None:
    """At 200 Hz one step per period told of 60 % of the error that is left of `gravity_pd` near its
    limit of stability."""
    block = controller("gravity_pd", planar(), 0.005, bandwidth=40.0)
    usual, fine, coarse = (
        make_loop(planar(), block, substeps=k).run(reach(), hold=0.3) for k in (None, 40, 1)
    )
    largest = np.abs(fine.q - fine.q_ref).max()
    assert np.abs(usual.q - fine.q).max() < 0.02 * largest
    assert np.abs(coarse.q - fine.q).max() > 0.02 * largest
