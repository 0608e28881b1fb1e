"""Motors of a wrist that the axes before theirs turn along: `identify` finds the ratios."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, as_read, log_of, possible_robot
from independent_plant.effects import Effect

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.geared_motor import GearedMotor
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra, columns
from irb2400_ctrl.identification.fitting.fit import fit
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.geared_motors import (
    _motor,
    _Wrist,
    geared_motors,
    refined,
    turned_over,
)
from irb2400_ctrl.identification.fitting.moments import Recording, recordings
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base

ARMS = ((34001, 4), (34002, 5))
"""seed, and joint that turns the motor of the next"""


@cache
def case(seed: int, joint: int) -> PossibleCase:
    return PossibleCase(possible_robot(), seed, 30.0, Effect("wrist_coupling", joint, 0.05))


@cache
def identified(seed: int, joint: int) -> Identification:
    judge = as_read(case(seed, joint).recorded(1), "judge")
    return irb.identify(possible_robot(), log_of(case(seed, joint)), validation=judge)


def motors_of(robot: irb.Robot) -> list[GearedMotor]:
    return [effect for effect in robot.effects if isinstance(effect, GearedMotor)]


def signals(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """50 states of six joints."""
    q, qd, qdd = rng.normal(size=(3, 50, 6))
    return q, qd, qdd


@pytest.mark.parametrize(("seed", "joint"), ARMS)
def test_the_ratio_of_a_drawn_wrist_is_found(seed: int, joint: int) -> None:
    found = identified(seed, joint)
    (drawn, _, _) = case(seed, joint).sized_effects[0]
    (motor,) = motors_of(found.robot)
    assert motor.joint == joint + 1
    assert motor.ratio == pytest.approx(drawn.shape[0], abs=0.03)
    assert motor.far_ratio == pytest.approx(0.0, abs=0.05)
    (line,) = [note for note in found.notes if "turns along" in note]
    turned = f"{motor.ratio:+.2f} times joint {joint} "
    assert line.startswith(f"joint {joint + 1} has a motor that turns along with {turned}")
    (judged,) = [log for log in found.logs if log.role == "validation"]
    ratio = judged.error("unseen").rmse / judged.error("plain").rmse
    assert ratio[joint - 1 : joint + 1].max() < 0.6
    assert ratio.max() < 1.05


def test_an_arm_whose_axes_turn_no_others_motor_has_none() -> None:
    plain = PossibleCase(possible_robot(), 34001, 30.0)
    assert not motors_of(irb.identify(possible_robot(), log_of(plain)).robot)


def test_it_works_as_much_as_its_motor_less_what_the_joint_alone_would() -> None:
    """Of qd^T tau: T(w) w is what the motor takes up, T(qd_j) qd_j is in the joint's friction."""
    robot = irb.load_robot("irb2400")
    motor = LIBRARY["geared_motor"].of(
        6, ratio=0.7, far_ratio=-0.4, inertia_kgm2=0.2, viscous_Nms_rad=3.0, coulomb_Nm=2.0
    )
    q, qd, qdd = signals(np.random.default_rng(5))
    with_it, without = (irb.Model(one) for one in (robot.with_effects(motor), robot))
    torque = with_it.inverse_dynamics(q, qd, qdd) - without.inverse_dynamics(q, qd, qdd)
    assert not torque[:, :3].any()
    turned = np.array([0, 0, 0, -0.4, 0.7, 1.0])
    w = qd @ turned
    dw = qdd @ turned

    def taken(speed: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        return speed * (0.2 * acceleration + 3.0 * speed + 2.0 * np.sign(speed))

    expected = taken(w, dw) - taken(qd[:, 5], qdd[:, 5])
    np.testing.assert_allclose((torque * qd).sum(axis=1), expected, atol=1e-9)


@pytest.mark.parametrize("ratios", [(0.6, 0.0), (-1.0, 0.3)])
def test_columns_are_the_effects(ratios: tuple[float, float]) -> None:
    robot = irb.load_robot("irb2400")
    layout = ColumnLayout(6, (Extra("motor", 6, ratios),))
    q, qd, qdd = signals(np.random.default_rng(6))
    found = columns(irb.Model(fit_base(robot)[0]), layout, q, qd, qdd)
    for place, field in enumerate(("inertia_kgm2", "viscous_Nms_rad", "coulomb_Nm")):
        motor = LIBRARY["geared_motor"].of(6, ratio=ratios[0], far_ratio=ratios[1], **{field: 1.5})
        with_it, without = (irb.Model(one) for one in (robot.with_effects(motor), robot))
        torque = with_it.inverse_dynamics(q, qd, qdd) - without.inverse_dynamics(q, qd, qdd)
        column = found[:, :, layout.extra(layout.extras[0]).start + place]
        np.testing.assert_allclose(1.5 * column, torque, atol=1e-9)


def parts_of(seed: int, joint: int) -> tuple[irb.Model, list[Recording], Fit]:
    model = irb.Model(fit_base(possible_robot())[0])
    parts = recordings([motion_of(log_of(case(seed, joint)), "angle")])
    return model, parts, fit(model, parts)


def test_ratios_that_are_a_little_off_are_moved_beside_the_fit() -> None:
    model, parts, found = parts_of(*ARMS[1])
    (motor,) = [extra for extra in found.layout.extras if extra.kind == "motor"]
    off = Extra("motor", motor.joint, (motor.ratios[0] + 0.1, 0.0))
    swapped = tuple(off if extra == motor else extra for extra in found.layout.extras)
    layout = replace(found.layout, extras=swapped)
    moved = refined(model, parts, replace(found, layout=layout))
    (back,) = [extra for extra in moved if extra.kind == "motor"]
    assert back.ratios[0] == pytest.approx(motor.ratios[0], abs=0.03)


def late(angle: np.ndarray) -> np.ndarray:
    """Dry friction of one that builds up over 0.4 mrad behind each turn."""
    steps = np.diff(angle, prepend=angle[0])
    found = np.empty_like(angle)
    state = 0.0
    for k, step in enumerate(steps):
        state = np.sign(step) + (state - np.sign(step)) * np.exp(-abs(step) / 4e-4)
        found[k] = state
    return found


@pytest.mark.parametrize("ratio", [0.6, -0.5])
def test_dry_friction_that_is_late_to_turn_is_no_other_ratio(ratio: float) -> None:
    """On 20 s with few turns the ratio that made up for it was 0.03 to 0.12 off."""
    time = np.arange(0.0, 20.0, 0.001)
    q = np.zeros((len(time), 6))
    for joint, parts in ((3, ((0.5, 1.0, 0.3),)), (4, ((0.6, 0.7, 1.1),)), (5, ((0.5, 1.3, 2.0),))):
        q[:, joint] = sum(a * np.sin(w * time + phase) for a, w, phase in parts)
    qd = np.gradient(q, time, axis=0)
    qdd = np.gradient(qd, time, axis=0)
    motor = q[:, 5] + ratio * q[:, 4]
    torque = np.zeros_like(q)
    torque[:, 3] = 9.0 * late(q[:, 3])
    torque[:, 4] = 8.0 * late(q[:, 4]) + ratio * 5.0 * late(motor)
    torque[:, 5] = 5.0 * late(motor)
    torque += 0.1 * np.random.default_rng(3).standard_normal(torque.shape)
    some = slice(None, None, 8)
    known = np.ones_like(q[some], dtype=bool)
    wrist = _Wrist(torque[some], known, qd[some], qdd[some], range(3, 6))
    found = wrist.best(6, [])
    assert found.ratios[0] == pytest.approx(ratio, abs=0.01)
    assert found.ratios[1] == pytest.approx(0.0, abs=0.01)


def test_dry_friction_turns_over_behind_a_turn_alone() -> None:
    slowing, going = turned_over(np.array([0.01, 0.01]), np.array([-2.0, 2.0]))
    assert slowing == 1.0
    assert -1.0 < going < 0.0
    assert turned_over(np.array([-1.0]), np.array([-2.0])) == pytest.approx(-1.0)


def test_arms_of_other_than_six_axes_are_offered_none() -> None:
    assert list(GearedMotor.joints(6)) == [5, 6]
    assert not GearedMotor.joints(5)
    assert not GearedMotor.joints(7)


def test_a_ratio_near_nothing_is_nothing() -> None:
    assert _motor(5, [0.02]).ratios == (0.0, 0.0)
    assert _motor(6, [0.5, -0.01]).ratios == (0.5, 0.0)
    assert _motor(6, [0.5, -0.01]).turns == (0.0, 0.0, 0.0, 0.0, 0.5, 1.0)


def test_nothing_is_offered_where_one_axis_of_the_wrist_was_not_recorded() -> None:
    model, parts, found = parts_of(*ARMS[0])

    def without(joint: int) -> list[Recording]:
        blind = []
        for part in parts:
            known = part.motion.known.copy()
            known[:, joint] = False
            blind.append(replace(part, motion=replace(part.motion, known=known)))
        return blind

    layout = ColumnLayout(6)
    numbers = replace(found.numbers, theta=found.theta[: layout.count])
    plain = replace(found, layout=layout, numbers=numbers)
    assert [extra.joint for extra in geared_motors(model, parts, plain)] == [5]
    assert geared_motors(model, without(5), plain) == []
