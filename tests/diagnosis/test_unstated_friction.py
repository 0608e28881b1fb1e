"""What a file can hold is the file's, not a flexible law's."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sound_logs import sound_log

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.unstated_friction import with_friction_first
from irb2400_ctrl.robot import Robot, Uncertainty, load_robot

ROBOT = load_robot("irb2400")


def fitted(robot: Robot) -> tuple[BasePrior, Fit, np.ndarray]:
    """A law without a name on joint 3 that has taken in 3 Nm of dry friction beside its own."""
    prior = BasePrior(robot, Uncertainty(), np.full(6, 10.0), np.ones(6))
    qd = np.sin(np.arange(400) * 0.1)
    k = len(prior.sigmas())
    Z = np.zeros((400, 6, k))
    for kind, signal in enumerate((np.sign(qd), qd)):
        for j in range(6):
            column = k - 18 + 6 * kind + j
            Z[:, j, column] = signal * prior.sigmas()[column]
    torque = np.zeros((400, 6))
    torque[:, 2] = 3.0 * np.sign(qd) + 0.5 * np.cos(3.0 * np.arange(400) * 0.1)
    some: Any = np.zeros(0)
    fit = Fit((), (), some, some, np.zeros(k), np.eye(k), torque, Z, 0.0 * torque, (), (torque,))
    return prior, fit, torque


def test_unknown_friction_takes_what_a_flexible_law_had_taken() -> None:
    """Of a real arm a function of the speed left joint 3 a dry friction of 0.008 Nm, where each
    half of the log says 3: the robot written was 61 % off, not 31."""
    prior, fit, torque = fitted(ROBOT.with_unknown_friction([3]))
    found = with_friction_first(prior, fit)
    friction = prior.updated(found.z).friction[2]
    np.testing.assert_allclose(friction[1], 3.0, rtol=0.03)
    # together they are what they were
    (law,) = found.non_parametric
    np.testing.assert_allclose(law + found.Z @ (found.z - fit.z), torque, atol=1e-9)
    assert np.sqrt(np.mean(law[:, 2] ** 2)) < 0.4


def test_a_friction_that_the_file_states_is_not_moved_by_it() -> None:
    prior, fit, _ = fitted(ROBOT)
    found = with_friction_first(prior, fit)
    np.testing.assert_array_equal(found.z, fit.z)
    assert with_friction_first(prior, replace(fit, non_parametric=())).z is fit.z


def test_the_robot_that_is_written_explains_the_log_better_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bump over the speed that no effect makes, on a joint whose friction the file does not
    state."""
    log = sound_log(601, plain=True).log
    speed = np.gradient(log.q[:, 2], log.time)
    bump = 60.0 * np.tanh(speed / 0.01) * np.exp(-(((np.abs(speed) - 0.5) / 0.3) ** 2))
    log = replace(log, tau=log.tau + bump[:, None] * (np.arange(6) == 2))
    robot = ROBOT.with_unknown_friction([3])
    found = diagnose(robot, log)
    assert [rest.joint for rest in found.unexplained] == [3]
    module = importlib.import_module("irb2400_ctrl.diagnosis.diagnose")
    monkeypatch.setattr(module, "with_friction_first", lambda prior, fit: fit)
    without = diagnose(robot, log)
    errors = [one.identification.error_after.rmse[2] for one in (found, without)]
    assert errors[0] < 0.8 * errors[1]
