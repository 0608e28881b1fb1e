"""The data stream of a simulated drive has the rate that it says, and one instant in a row."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.arms import START, STOP, arm, quintic_move

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.simulation import IDEAL_SENSORS, Sensors, make_loop, simulate

MOVE = quintic_move(START, STOP, 0.4)


@pytest.mark.parametrize(
    ("control", "asked", "given"),
    [
        (1000.0, 500.0, 500.0),
        (1000.0, 333.33, 1000 / 3),
        (200.0, None, 200.0),
        (450.0, None, 225.0),
    ],
)
def test_the_log_has_the_rate_that_simulation_json_says(
    control: float, asked: float | None, given: float
) -> None:
    sensors = Sensors() if asked is None else Sensors(rate_Hz=asked)
    run = simulate(arm(), MOVE, "computed_torque", rate=control, sensors=sensors)
    np.testing.assert_allclose(np.diff(run.log().time), 1 / given, rtol=1e-6)
    assert run.summary()["sensors"]["rate_Hz"] == pytest.approx(given)


@pytest.mark.parametrize(
    ("control", "asked", "tries"),
    [(1000.0, 400.0, "333.3333 or 500$"), (1000.0, 4000.0, "1000$"), (200.0, 150.0, "100 or 200$")],
)
def test_a_rate_between_the_samples_is_refused(control: float, asked: float, tries: str) -> None:
    """It was logged at 500 Hz where 400 were asked for, in silence."""
    with pytest.raises(InputError, match=f"rate_Hz = {asked:g}; expected .* try {tries}"):
        make_loop(arm(), "computed_torque", rate=control, sensors=Sensors(rate_Hz=asked))


def test_the_logged_torque_is_that_of_the_angles_instant() -> None:
    """Each torque is held for a step: told at its beginning, all are early by half of one, which
    looked like an elastic joint where the motion was quick."""
    run = simulate(arm(), quintic_move(START, STOP, 1.2), "computed_torque", sensors=IDEAL_SENSORS)
    qdd = np.gradient(run.qd, run.time, axis=0)
    needed = Model(run.plant).inverse_dynamics(run.q, run.qd, qdd)
    moving = (np.abs(run.qd) > 0.15).all(axis=1)
    moving[[0, -1]] = False
    rate = np.gradient(needed, run.time, axis=0)[moving]
    for told, late in ((run.reported_torque(), 0.0), (run.tau, -5e-4)):
        gap = (needed - told)[moving]
        delay = (rate * gap).sum() / (rate**2).sum()
        assert delay == pytest.approx(late, abs=5e-5)
