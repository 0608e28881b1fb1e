"""`validate` says where an arm is not as it was when its file was identified."""

from __future__ import annotations

from functools import cache

import numpy as np
from diagnosis.plain_motion import motion

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification import Validation, validate
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.report.pages.validation_page import lines, validation_page
from irb2400_ctrl.robot import Identified

NOISE = np.array([1.0, 1.7, 1.0, 0.3, 0.25, 0.25])
"""[Nm] rms"""


@cache
def robot() -> irb.Robot:
    """An arm whose identification left half its noise of motions that it had not seen."""
    names = ColumnLayout(6).names()
    known = Identified.of(names, 1e-4 * np.eye(len(names)))
    known = known.model_copy(update={"left_Nm": tuple(0.5 * NOISE)})
    return irb.load_robot("irb2400").model_copy(update={"identified": known})


def seen(arm: irb.Robot, factor: float = 1.0, offset_Nm: float = 0.0) -> Validation:
    """The file against a log of an arm, its torques read so many times, that of joint 3 with an
    offset."""
    when = motion()
    torque = np.asarray(irb.Model(arm).inverse_dynamics(when.q, when.qd, when.qdd))
    torque[:, 2] += offset_Nm
    noise = NOISE * np.random.default_rng(4).normal(size=torque.shape)
    return validate(robot(), irb.Log(when.time, when.q, factor * torque + noise, name="a.csv"))


def changed(*given: object, **more: float) -> str:
    (log,) = seen(*given, **more).logs  # type: ignore[arg-type]
    return " ".join(log.changed)


def test_an_arm_as_it_was_is_not_remarked_on() -> None:
    assert not changed(robot())
    stiffer = robot().joints[1].friction
    stiffer = stiffer.model_copy(update={"coulomb_Nm": 1.1 * stiffer.coulomb_Nm})
    joints = list(robot().joints)
    joints[1] = joints[1].model_copy(update={"friction": stiffer})
    assert not changed(robot().model_copy(update={"joints": tuple(joints)}))


def test_a_load_that_nobody_declared_is_told() -> None:
    """It was 107 % of a joint's torque, without a word."""
    load = LIBRARY["payload"].of(None, mass_kg=4.0, com_m=(0.03, -0.02, 0.1))
    told = seen(robot().with_effects(load))
    (said,) = told.logs[0].changed
    assert "not as when this arm was identified" in said
    assert "A load of 4 kg at (" in said
    assert "`irb2400 diagnose LOG --robot FILE`" in said
    assert f"note: a.csv: {said}" in lines(told)
    assert said in validation_page(told).html().replace("&#x27;", "'")
    assert said in told.to_json()["logs"][0]["remarks"]


def test_torques_in_another_unit_are_told_and_what_is_no_load_is_called_none() -> None:
    assert "All torques times 1.5" in changed(robot(), factor=1.5)
    off = changed(robot(), offset_Nm=60.0)
    assert off.startswith("joint 3: not as when")
    assert "A load" not in off
    assert "All torques" not in off


def test_columns_that_are_not_what_they_say_tell_nothing_of_the_arm() -> None:
    told = seen(robot(), factor=1.5).with_problems(["is not understood: torque in percent"])
    assert not [line for line in lines(told) if "not as when" in line]


def test_against_a_file_that_was_not_identified_nothing_has_changed() -> None:
    plain = irb.load_robot("irb2400")
    when = motion()
    torque = 2.0 * np.asarray(irb.Model(plain).inverse_dynamics(when.q, when.qd, when.qdd))
    (log,) = validate(plain, irb.Log(when.time, when.q, torque)).logs
    assert log.changed == ()


def test_a_file_that_was_never_identified_is_said_to_be_one() -> None:
    """Errors of 100 % with a maker's URDF were printed without a word."""
    arm = irb.load_robot("irb2400")
    (said,) = of_the_file(arm.with_unknown_friction(range(1, 7)), arm)
    assert said.startswith("this file was never identified: what it leaves beyond noise, ")
    assert "It states no friction of joints 1, 2, 3, 4, 5 and 6." in said
    assert "`irb2400 identify LOG... --robot FILE`" in said
    assert not of_the_file(arm, arm)
    for load, percent in ((3.0, ""), (4.0, "11 % of the mean torque of joint 3")):
        loaded = arm.with_effects(LIBRARY["payload"].of(None, mass_kg=load))
        assert [percent in one for one in of_the_file(arm, loaded)] == [True] * bool(percent)
    assert not of_the_file(robot(), arm.with_effects(LIBRARY["payload"].of(None, mass_kg=4.0)))


def of_the_file(file: irb.Robot, arm: irb.Robot) -> list[str]:
    """What is said of a file on a log of an arm."""
    when = motion()
    torque = np.asarray(irb.Model(arm).inverse_dynamics(when.q, when.qd, when.qdd))
    torque += NOISE * np.random.default_rng(5).normal(size=torque.shape)
    (log,) = validate(file, irb.Log(when.time, when.q, torque, name="a.csv")).logs
    return [one for one in log.notes if "never identified" in one]
