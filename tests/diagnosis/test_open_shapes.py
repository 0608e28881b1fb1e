"""What an identification leaves open of the shape of a balancer is no second one."""

from __future__ import annotations

from functools import cache

import numpy as np
from diagnosis.plain_motion import BASES, ROBOT, motion

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.preparation.identified_prior import IdentifiedPrior
from irb2400_ctrl.diagnosis.preparation.open_shapes import OpenShapes
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.robot import Identified

NOISE = np.array([1.0, 1.7, 1.0, 0.3, 0.25, 0.25])
"""[Nm] rms"""
SIZE = 900.0
"""[Nm] of the balancer"""


@cache
def robot() -> irb.Robot:
    """Identified, with a balancer of the shape that `identify` gives every one."""
    names = ColumnLayout(6).names()
    known = Identified.of(names, 1e-4 * np.eye(len(names)))
    balancer = LIBRARY["balancer"].of(2, torque_Nm=SIZE, source="identified")
    return ROBOT.model_copy(update={"identified": known}).with_effects(balancer)


@cache
def prior() -> IdentifiedPrior:
    found = IdentifiedPrior.of(robot(), robot().uncertainty, motion())
    return found.beside(OpenShapes.of(BASES, robot(), motion()))


def test_a_number_of_a_shape_is_what_is_written() -> None:
    z = np.zeros(len(prior().root))
    z[-3:] = (0.4, -0.7, 0.2)
    moved = prior().updated(prior().deviations(z))
    by = predicted_torque(moved, motion()) - predicted_torque(robot(), motion())
    np.testing.assert_allclose(prior().columns(BASES.model, motion()) @ z, by, atol=1e-9)
    (balancer,) = [effect for effect in moved.effects if effect.kind == "balancer"]
    assert len(balancer.discrepancy) == 3
    size = np.sqrt(np.mean(by[:, 1] ** 2))
    assert 0.02 < size / np.sqrt(np.mean((SIZE * np.sin(motion().q[:, 1])) ** 2)) < 0.2


def test_a_shape_that_the_file_has_stays_where_nothing_moves() -> None:
    z = np.zeros(len(prior().root))
    moved = prior().updated(prior().deviations(z))
    np.testing.assert_allclose(
        predicted_torque(moved, motion()), predicted_torque(robot(), motion()), atol=1e-9
    )


def test_a_balancer_of_another_shape_is_no_second_one() -> None:
    """A gas spring of an arm nobody had tuned to became another balancer at 0.72 on a warm day."""
    own = LIBRARY["balancer"].of(2, torque_Nm=SIZE, discrepancy=(0.0, 0.06 * SIZE, 0.0))
    when = motion()
    arm = ROBOT.with_effects(own)
    torque = np.asarray(irb.Model(arm).inverse_dynamics(when.q, when.qd, when.qdd))
    torque += NOISE * np.random.default_rng(8).normal(size=torque.shape)
    found = diagnose(robot(), irb.Log(when.time, when.q, torque))
    assert not found.findings
    assert found.identification.error_after.rmse[1] < 1.5 * NOISE[1]
    (balancer,) = [effect for effect in found.robot.effects if effect.kind == "balancer"]
    assert balancer.discrepancy
