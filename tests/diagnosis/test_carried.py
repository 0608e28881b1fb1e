"""A law of the load beside a body that the joint carries besides: it is written for both."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, ROBOT, motion

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import rms
from irb2400_ctrl.diagnosis.estimation.carried import (
    as_carried,
    errors_as_carried,
    shares_of_the_loaded,
)
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY

LOAD = LIBRARY["payload"].of(None, mass_kg=20.0, com_m=(0.2, 0.1, 0.1))
LAW = LIBRARY["load_friction"].of(6, coefficient=0.4, reference_Nm=1.0)
FITTER: Any = SimpleNamespace(motion=motion(), bases=BASES)


def shares(*effects: Any) -> tuple[float, ...]:
    fit: Any = SimpleNamespace(effects=effects)
    return shares_of_the_loaded(fit, FITTER)


def test_a_friction_that_grows_with_the_load_has_the_same_torque_on_the_loaded_arm() -> None:
    """Joint 6 of another arm left 0.57 Nm of 0.06 that were there, with 0.34 Nm/Nm for 0.014."""
    of_load, of_law = shares(LOAD, LAW)
    assert of_load == 1.0
    assert of_law < 0.3
    law = as_carried(LAW, of_law)
    assert law.coefficients()[0] == pytest.approx(of_law * 0.4)
    # what the fit took it for, beside what the robot that is written says
    alone, loaded, apart = (
        predicted_torque(ROBOT.with_effects(*effects), motion(), bases)
        for effects, bases in (((LOAD,), None), ((LOAD, law), None), ((LOAD, LAW), BASES))
    )
    found = (apart - alone)[:, 5]
    written = (loaded - alone)[:, 5]
    assert np.sum(found * written) == pytest.approx(np.sum(written**2), rel=1e-6)
    as_found = (predicted_torque(ROBOT.with_effects(LOAD, LAW), motion()) - alone)[:, 5]
    assert rms(as_found) > 3.0 * rms(found)
    assert rms(written) < 1.01 * rms(found)
    assert errors_as_carried(LAW, {"coefficient": 0.1, "friction_share": 0.2}, of_law) == {
        "coefficient": pytest.approx(0.1 * of_law), "friction_share": 0.2
    }  # fmt: skip


def test_what_is_no_law_of_the_load_or_beside_no_body_stays() -> None:
    ripple = LIBRARY["gear_ripple"].of(4, amplitude_Nm=1.0, order=20.0)
    assert shares(LAW, ripple) == (1.0, 1.0)
    assert shares(LOAD, ripple) == (1.0, 1.0)
    for_a_moment = LOAD.model_copy(update={"windows_s": ((1.0, 2.0),)})
    assert shares(for_a_moment, LAW) == (1.0, 1.0)
    assert as_carried(LAW, 1.0) is LAW
    errors = {"com_m": [0.1, 0.2, 0.3]}
    assert errors_as_carried(LOAD, errors, 1.0) is errors


def test_the_robot_that_is_written_has_the_effects_that_are_told(monkeypatch: Any) -> None:
    from irb2400_ctrl.diagnosis import findings

    doubled = LIBRARY["gear_ripple"].of(4, amplitude_Nm=8.0, order=20.0)
    when = motion()
    arm = ROBOT.with_effects(doubled)
    torque = np.asarray(irb.Model(arm).inverse_dynamics(when.q, when.qd, when.qdd))
    noise = 0.2 * np.random.default_rng(2).normal(size=torque.shape)
    log = irb.Log(when.time, when.q, torque + noise)
    monkeypatch.setattr(
        findings, "shares_of_the_loaded", lambda fit, fitter: (0.5,) * len(fit.effects)
    )
    found = irb.diagnose(ROBOT, log)
    (one,) = [f.effect for f in found.findings if f.effect.kind == "gear_ripple"]
    assert one in found.robot.effects
    assert one.sizes()[0] == pytest.approx(4.0, rel=0.1)
