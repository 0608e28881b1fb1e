"""A log that somebody made of the model itself: there is no noise in it at all."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.trajectory import from_angles

ROBOT = load_robot("irb2400")
TIME = np.linspace(0.0, 20.0, 5001)
PHASE = np.outer(TIME, 1.0 + 0.17 * np.arange(6))
REST = np.sin(np.pi * TIME / TIME[-1])[:, None] ** 2
Q = 0.6 * REST * np.sin(PHASE) + [0.1, 0.2, -0.1, 0.0, 0.5, 0.0]


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_log_without_noise_has_nothing_that_is_missing(noise: float) -> None:
    m = from_angles(TIME, Q)
    exact = np.asarray(Model(ROBOT).inverse_dynamics(m.q, m.qd, m.qdd))
    tau = exact + noise * np.random.default_rng(1).standard_normal(Q.shape)
    told = diagnose(ROBOT, Log(TIME, Q, tau))
    assert told.verdict == "nothing_missing"
    assert not told.findings


def test_a_load_is_named_without_noise() -> None:
    load = LIBRARY["payload"].of(None, **LIBRARY["payload"].example)
    m = from_angles(TIME, Q)
    tau = np.asarray(Model(ROBOT.with_effects(load)).inverse_dynamics(m.q, m.qd, m.qdd))
    told = diagnose(ROBOT, Log(TIME, Q, tau))
    assert [(f.effect.kind, f.effect.joint) for f in told.findings] == [("payload", None)]
