"""A gear that is stiffer today is so at the speed of its motor, which other axes may turn."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import motion

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.preparation import base_prior
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.identified_prior import IdentifiedPrior
from irb2400_ctrl.diagnosis.preparation.turned_motors import (
    TurnedMotors,
    _share,
    with_turning_motors,
)
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.geared_motor import GearedMotor
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.robot import Identified

STIFFER = 1.25


@cache
def robot(factor: float = 1.0) -> irb.Robot:
    """An arm whose axes 4 and 5 turn motor 6, with so much of the friction of joint 6."""
    plain = irb.load_robot("irb2400")
    _, dry, viscous, _ = plain.friction[5]
    motor = LIBRARY["geared_motor"].of(
        6,
        ratio=0.8,
        far_ratio=-0.3,
        inertia_kgm2=0.02,
        coulomb_Nm=float(0.9 * dry * factor),
        viscous_Nms_rad=float(0.6 * viscous * factor),
    )
    friction = plain.joints[5].friction.model_copy(
        update={"coulomb_Nm": float(factor * dry), "viscous_Nms_rad": float(factor * viscous)}
    )
    joints = [*plain.joints[:5], plain.joints[5].model_copy(update={"friction": friction})]
    return plain.model_copy(update={"joints": tuple(joints)}).with_effects(motor)


def motor_of(one: irb.Robot) -> GearedMotor:
    (found,) = [effect for effect in one.effects if isinstance(effect, GearedMotor)]
    return found


def stiffer(prior: BasePrior) -> np.ndarray:
    """Deviations of the base by which joint 6 is stiffer."""
    z = np.zeros(len(prior.sigmas()))
    for kind, column in ((3, 1), (2, 2)):
        place = len(z) - kind * robot().n + 5
        z[place] = (STIFFER - 1.0) * robot().friction[5, column] / prior.sigmas()[place]
    return z


def test_an_arm_that_was_identified_has_them_stiffer_together() -> None:
    names = ColumnLayout(6).names()
    known = Identified.of(names, 1e-4 * np.eye(len(names)))
    one = robot().model_copy(update={"identified": known})
    prior = IdentifiedPrior.of(one, one.uncertainty, motion())
    updated = prior.updated(np.concatenate([stiffer(prior.base), np.zeros(12)]))
    assert motor_of(updated).coulomb_Nm == pytest.approx(motor_of(robot(STIFFER)).coulomb_Nm)
    # offsets and rotors are told beside it
    assert {"torque_offset", "rotor_inertia"} <= {effect.kind for effect in updated.effects}


def test_the_base_has_them_stiffer_together() -> None:
    prior = BasePrior.of(robot(), robot().uncertainty, motion())
    z = stiffer(prior)
    updated = prior.updated(z)
    assert motor_of(updated).coulomb_Nm == pytest.approx(motor_of(robot(STIFFER)).coulomb_Nm)
    assert motor_of(updated).viscous_Nms_rad == pytest.approx(
        motor_of(robot(STIFFER)).viscous_Nms_rad
    )
    torque = [
        np.asarray(irb.Model(one).inverse_dynamics(motion().q, motion().qd, motion().qdd))
        for one in (robot(), robot(STIFFER))
    ]
    moving = (np.abs(motion().qd) > 0.05).all(axis=1)
    expected = (torque[1] - torque[0])[moving]
    found = (prior.columns(irb.Model(robot()), motion()) @ z)[moving]
    np.testing.assert_allclose(found, expected, atol=0.02 * np.abs(expected).max())
    assert np.abs(expected[:, 3:5]).max() > 0.1


def log_of_a_stiffer_day() -> irb.Log:
    rng = np.random.default_rng(8)
    when = motion()
    torque = np.asarray(irb.Model(robot(STIFFER)).inverse_dynamics(when.q, when.qd, when.qdd))
    noise = 0.02 * np.std(torque, axis=0) * rng.normal(size=torque.shape)
    return irb.Log(when.time, when.q, torque + noise, when.qd)


def test_the_friction_of_another_day_is_no_coupling(monkeypatch: Any) -> None:
    def couplings() -> set[int | None]:
        found = irb.diagnose(robot(), log_of_a_stiffer_day()).findings
        return {f.effect.joint for f in found if "wrist_coupling" in f.effect.kind}

    assert not couplings()
    alone = TurnedMotors(())
    monkeypatch.setattr(base_prior.TurnedMotors, "of", classmethod(lambda cls, robot: alone))
    assert couplings()


def test_a_motor_has_no_more_of_a_friction_than_there_is() -> None:
    assert _share(3.0, 2.0) == 1.0
    assert _share(-1.0, 2.0) == 0.0
    assert _share(1.0, 0.0) == 0.0
    assert _share(1.0, 2.0) == 0.5


def test_a_robot_without_such_motors_stays_as_it_is() -> None:
    plain = irb.load_robot("irb2400")
    motors = TurnedMotors.of(plain)
    assert not list(motors.columns(np.ones((4, 6))))
    assert motors.updated(plain, np.ones(6), np.ones(6)) is plain


def test_joints_that_hold_a_motor_still_between_them_tell_nothing_of_its_friction() -> None:
    """Axes 4 to 6 all move and motor 6 rests for half a second: its dry friction may be anything.
    It was a force at the tool, at 0.8, on a log of an unchanged arm."""
    when = motion()
    qd = when.qd.copy()
    turns = np.array(motor_of(robot()).turns(6))
    half = slice(500, 625)
    qd[half, 3:5] = 0.5
    qd[half, 5] = -(qd[half, :5] @ turns[:5])
    held = replace(when, qd=qd)
    found = with_turning_motors(robot(), held)
    assert not found.known[half, 3:].any()
    rows = (held.row_time > held.time[510]) & (held.row_time < held.time[615])
    assert rows.any()
    assert not found.row_known[rows, 3:].any()
    # axes that turn no motor of it, and times at which it turns, stay
    np.testing.assert_array_equal(found.known[:, :3], held.known[:, :3])
    np.testing.assert_array_equal(found.row_known[:, :3], held.row_known[:, :3])
    quick = np.abs(qd @ turns) > 0.5
    assert found.known[quick][:, 3:].mean() > 0.9 * held.known[quick][:, 3:].mean()
    plain = irb.load_robot("irb2400")
    assert with_turning_motors(plain, held) is held


def test_a_diagnosis_and_a_validation_leave_them_out() -> None:
    when = motion()
    torque = np.asarray(irb.Model(robot()).inverse_dynamics(when.q, when.qd, when.qdd))
    log = irb.Log(when.time, when.q, torque + np.random.default_rng(3).normal(size=torque.shape))
    slow = np.abs(prepare(log).qd @ np.array(motor_of(robot()).turns(6))) < 0.02
    assert slow.any()
    assert not irb.diagnose(robot(), log).identification.known[slow, 3:].any()
    (seen,) = irb.identification.validate(robot(), log).logs
    slow = np.abs(seen.qd @ np.array(motor_of(robot()).turns(6))) < 0.02
    assert not seen.known[slow, 3:].any()
