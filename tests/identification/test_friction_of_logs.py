"""How surely the friction of another day is known, of logs whose friction is not the same."""

from __future__ import annotations

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.machine import Machine

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.columns import ColumnLayout

ROBOT = possible_robot()
COLD = (1.25, 1.0, 0.85)
"""friction of each log over the usual one: an arm that warms up"""


def log(seed: int, stiffer: float) -> irb.Log:
    """A motion of one arm, its friction `stiffer` times."""
    machine = PossibleCase(ROBOT, 105, 12.0).machine
    moved = PossibleCase(ROBOT, seed, 12.0)
    friction = machine.friction * [stiffer, stiffer, stiffer, 1.0]
    moved.__dict__["machine"] = Machine(machine.arm, friction, machine.servo)
    return log_of(moved, name=f"motion {seed}")


def standard_errors(levels: tuple[float, ...]) -> np.ndarray:
    """Of the dry friction of every joint, over itself, (n,), as a robot file carries them."""
    found = irb.identify(ROBOT, [log(k + 1, level) for k, level in enumerate(levels)])
    layout = ColumnLayout(ROBOT.n)
    place = layout.drive("coulomb")
    names = layout.names()[place]
    identified = found.robot.identified
    assert identified is not None
    known = np.linalg.norm(identified.rows(names), axis=1)
    assert known == pytest.approx(np.sqrt(np.diag(found.covariance)[place]))
    return np.asarray(known / found.theta[place])


def test_friction_that_differs_between_the_logs_is_not_known_better_than_by_that() -> None:
    """Of a warm day it was a change: 26 % less dry friction on a joint, four standard deviations
    of what the logs of a cold morning and of a warm one had left open together."""
    scatter = float(np.std(COLD, ddof=1))
    known = standard_errors(COLD)
    assert (known > 0.4 * scatter).all()
    assert np.median(known) == pytest.approx(scatter, rel=0.4)


def test_of_days_alike_it_is_known_as_before() -> None:
    assert (standard_errors((1.0, 1.0, 1.0)) < 0.06).all()
