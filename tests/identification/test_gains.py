"""Gains of the torque channels from a load that was weighed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine
from independent_plant.parameters import FLANGE_OFFSET

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification import validate
from irb2400_ctrl.identification.gains import CONTRADICTED, Gains
from irb2400_ctrl.robot import Body

ROBOT = possible_robot()
GAIN = np.array([1.0, 1.12, 0.91, 1.0, 1.06, 1.0])
MASS = 8.0
ABOVE = 0.15
LOAD = Body(mass_kg=MASS, com_m=(0.0, 0.0, ABOVE), inertia_kgm2=(0.0,) * 6)


@cache
def log(seed: int, load: float) -> irb.Log:
    """A motion of one arm whose drives read more or less than they make."""
    case = PossibleCase(ROBOT, 105, 20.0)
    machine = case.machine
    centre = np.array([0.0, 0.0, FLANGE_OFFSET + ABOVE])
    arm = replace(machine.arm, payload=_lump(load, centre, 0.02)) if load else machine.arm
    moved = PossibleCase(ROBOT, seed, 20.0)
    moved.__dict__["machine"] = Machine(arm, machine.friction, machine.servo)
    raw = log_of(moved, name=f"motion {seed}")
    return irb.Log(raw.time, raw.q, raw.tau * GAIN, q_ref=raw.q_ref, name=raw.name)


@cache
def identified() -> irb.identification.Identification:
    return irb.identify(ROBOT, log(1, 0.0), loaded=log(1, MASS), load=LOAD)


def test_gains_lie_within_their_errors() -> None:
    gains = identified().gains
    assert gains is not None
    assert gains.known[[1, 2, 4]].all()
    print(gains)
    off = np.abs(gains.values - GAIN)[gains.known]
    assert (off < 3.0 * gains.errors[gains.known] + 0.005).all()
    assert (off < 0.05).all()


def test_the_arm_is_in_true_torque_and_the_robot_says_what_the_log_reads() -> None:
    found = identified()
    friction = PossibleCase(ROBOT, 105, 20.0).machine.friction
    assert found.robot.friction[1, 1] == pytest.approx(friction[1, 1], rel=0.06)
    # friction of joint 2 in the raw reading is 12 % more; the joints tell that among themselves
    raw = irb.identify(ROBOT, log(1, 0.0))
    assert raw.robot.friction[1, 1] == pytest.approx(friction[1, 1], rel=0.06)
    told = validate(found.robot, log(1, 0.0)).error.rmse
    assert (told < 1.02 * validate(raw.robot, log(1, 0.0)).error.rmse).all()


def test_a_load_without_its_log_is_refused() -> None:
    with pytest.raises(InputError, match="expected both"):
        irb.identify(ROBOT, log(1, 0.0), load=LOAD)
    heavy = Body(mass_kg=100.0 * MASS, com_m=LOAD.com_m, inertia_kgm2=(0.0,) * 6)
    with pytest.raises(InputError, match="is the load's mass in kg"):
        irb.identify(ROBOT, log(1, 0.0), loaded=log(1, MASS), load=heavy)


def test_numbers_are_no_surer_than_the_gain_that_they_are_over() -> None:
    """Of a joint whose gain was known to 6 % friction was given to 0.7 %."""
    found = identified()
    gains = found.gains
    assert gains is not None
    names = found.layout.names()
    for j in np.flatnonzero(gains.known):
        place = names.index(f"coulomb_{j + 1}")
        share = found.standard_errors[place] / found.theta[place]
        assert share > 0.75 * gains.errors[j] / gains.values[j]
    known = found.robot.identified
    assert known is not None
    kept = np.linalg.norm(known.rows(names), axis=1)
    np.testing.assert_allclose(kept, found.standard_errors, rtol=1e-4)


def test_a_factor_that_all_gains_share_is_said() -> None:
    """A load of half its mass made all gains twice as large without a remark."""
    errors = np.array([0.01, 0.02, np.inf])
    twice = Gains(np.array([2.1, 1.9, 1.0]), errors).says()
    assert any(line.startswith("all known gains are about 2") for line in twice)
    for values in ([2.1, 1.1, 1.0], [2.1, 0.5, 1.0], [1.1, 0.9, 1.0]):
        assert not any("all known" in line for line in Gains(np.array(values), errors).says())


def test_gains_that_the_file_states_are_kept() -> None:
    """A file from such an identification is identified again: it was refused, as its readings
    depend on the bodies."""
    first = identified()
    assert first.gains is not None
    again = irb.identify(first.robot.model_copy(update={"identified": None}), log(2, 0.0))
    assert again.gains is not None
    assert again.gains.source == "robot file"
    assert again.given.effects == first.robot.effects
    stated = np.where(first.gains.known, first.gains.values, 1.0)
    np.testing.assert_allclose(again.gains.values, stated)
    told = {e.joint: e.gain for e in again.robot.effects if e.kind == "torque_gain"}
    assert told == {j + 1: stated[j] for j in np.flatnonzero(first.gains.known)}
    (line,) = [note for note in again.notes if "as the file has it (torque_gain)" in note]
    assert line.startswith("the torque of joints ")
    assert CONTRADICTED not in again.notes
    # as sure as before, and of the arm in true torque
    (judged,) = again.logs
    assert (judged.error("before").rmse < 1.3 * judged.error("unseen").rmse).all()
    assert validate(again.robot, log(1, 0.0)).error.rmse == pytest.approx(
        validate(first.robot, log(1, 0.0)).error.rmse, rel=0.1
    )
    np.testing.assert_allclose(again.robot.friction[:, 1], first.robot.friction[:, 1], rtol=0.1)


def test_gains_that_are_no_longer_read_are_said() -> None:
    """Torques that somebody has set right since, over gains that the file still has."""
    given = identified().robot.model_copy(update={"identified": None})
    raw = log(2, 0.0)
    right = irb.Log(raw.time, raw.q, raw.tau / GAIN, q_ref=raw.q_ref)
    assert CONTRADICTED in irb.identify(given, right).notes


def test_a_reading_that_bends_is_no_gain() -> None:
    bent = LIBRARY["torque_gain"].of(2, gain=1.1, discrepancy=(1e-4,))
    with pytest.raises(InputError, match="joint 2 that bends"):
        irb.identify(ROBOT.with_effects(bent), log(1, 0.0))
