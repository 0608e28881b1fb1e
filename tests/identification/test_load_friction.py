"""Dry friction that grows with the torque of a gear is found by `identify` where logs show it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import motion
from identification.possible_arms import PossibleCase, as_read, log_of, possible_robot
from independent_plant.effects import Effect

import irb2400_ctrl as irb
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting import choice as module
from irb2400_ctrl.identification.fitting.choice import MOST_LOSS, SURE, Choice, _gear_could
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra, columns, torque_of
from irb2400_ctrl.identification.fitting.fit import fit
from irb2400_ctrl.identification.fitting.moments import Recording, heavier_half, recordings
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base

LOAD = Extra("load", 2)


@cache
def case(joint: int | None) -> PossibleCase:
    """An arm whose friction on one joint grows with load: |load|^a, a drawn about one."""
    effects = () if joint is None else (Effect("load_friction", joint, 0.04),)
    return PossibleCase(possible_robot(), 71001, 30.0, *effects)


@cache
def identified(joint: int | None) -> Identification:
    judge = as_read(case(joint).recorded(1), "judge")
    return irb.identify(possible_robot(), log_of(case(joint)), validation=judge)


def loss(found: irb.Robot) -> dict[int | None, float]:
    return {e.joint: e.coefficient for e in found.effects if e.kind == "load_friction"}


@pytest.mark.parametrize("joint", [2, pytest.param(4, marks=pytest.mark.slow)])
def test_what_a_gear_loses_is_found(joint: int) -> None:
    found = identified(joint)
    (effect,) = case(joint).truth
    load = np.sqrt(np.mean(case(joint).plain_torque[:, joint - 1] ** 2))
    # of a power of the load near one, about its share at the load that the joint mostly carries
    (drawn, size, _) = case(joint).sized_effects[0]
    expected = size * load ** (drawn.shape[0] - 1.0)
    assert set(loss(found.robot)) == {joint}
    assert loss(found.robot)[joint] == pytest.approx(expected, rel=0.2)
    assert effect.size == size
    (line,) = [note for note in found.notes if "its gear carries" in note]
    assert line.startswith(f"joint {joint} ")
    (judged,) = [log for log in found.logs if log.role == "validation"]
    ratio = judged.error("unseen").rmse / judged.error("plain").rmse
    assert ratio[joint - 1] < 0.6
    assert ratio.max() < 1.05


def test_an_arm_without_it_has_none() -> None:
    assert loss(identified(None).robot) == {}
    assert not any("its gear carries" in note for note in identified(None).notes)


def test_a_file_that_has_it_is_fitted_anew() -> None:
    """Its torque depends on the bodies: as an effect that stays it was refused."""
    given = identified(2).robot.model_copy(update={"identified": None})
    again = irb.identify(given, log_of(case(2)))
    assert loss(again.robot)[2] == pytest.approx(loss(identified(2).robot)[2], rel=0.05)


def test_the_column_is_the_effect() -> None:
    """At the bodies that press; the torque itself is that of the numbers' own bodies."""
    robot = possible_robot()
    model = irb.Model(robot.model_copy(update={"effects": ()}))
    phi = robot.inertial_parameters.ravel()
    layout = ColumnLayout(6, (LOAD,), tuple(phi.tolist()))
    theta = np.zeros(layout.count)
    theta[: layout.inertial] = phi
    theta[layout.extra(LOAD)] = 0.07
    states = np.random.default_rng(3).normal(size=(3, 40, 6))
    load = model.body_torque(*states, phi)
    added = columns(model, layout, *states) @ theta - load
    np.testing.assert_allclose(added[:, 1], 0.07 * np.abs(load[:, 1]) * np.sign(states[1][:, 1]))
    np.testing.assert_allclose(np.delete(added, 1, axis=1), 0.0, atol=1e-9)
    theta[: layout.inertial] *= 1.3
    other = torque_of(model, layout, theta, *states) - 1.3 * load
    np.testing.assert_allclose(other, 1.3 * added, atol=1e-9)


def test_the_gears_carry_nearly_the_bodies_that_are_found() -> None:
    """Of a fit without such friction: a second one, with what the first had found, moved the
    torque that they carry by three parts in a thousand."""
    motion = motion_of(log_of(case(2)), "angle")
    model = irb.Model(fit_base(possible_robot())[0])
    found = fit(model, recordings([motion]))
    states = (motion.q, motion.qd, motion.qdd)
    carried = model.body_torque(*states, np.array(found.layout.pressing))
    own = model.body_torque(*states, found.theta[:60])
    assert (np.std(carried - own, axis=0) < 0.01 * np.std(own, axis=0)).all()


@pytest.mark.parametrize("kind", ["power", "load"])
@pytest.mark.parametrize(
    ("gains", "reaches", "could", "shown"),
    [
        (True, True, True, True),
        (False, True, True, False),
        (True, False, True, False),
        (True, True, False, False),
    ],
)
def test_friction_is_taken_on_where_it_reaches_further(
    monkeypatch: pytest.MonkeyPatch, kind: str, gains: bool, reaches: bool, could: bool, shown: bool
) -> None:
    monkeypatch.setattr(module, "_gains", lambda extra, trial, now: gains)
    monkeypatch.setattr(module, "_gear_could", lambda extra, trial: could)
    monkeypatch.setattr(Choice, "_reaches_further", lambda self, extra, trial, now: reaches)
    monkeypatch.setattr(Choice, "_speeds_apart", lambda self, extra: True)
    nothing: Any = None
    beyond: Any = {"power": nothing, "load": nothing}
    choice = Choice(nothing, nothing, beyond, nothing, nothing)
    # only a gear loses no more than so much
    expected = shown or (kind == "power" and gains and reaches)
    assert choice._shown(Extra(kind, 2), nothing, nothing) is expected
    monkeypatch.setattr(Choice, "_speeds_apart", lambda self, extra: False)
    assert choice._shown(Extra(kind, 2), nothing, nothing) is (expected and kind == "load")


@pytest.mark.parametrize(
    ("value", "error", "could"),
    [
        (0.05, 0.01, True),
        (0.99 * MOST_LOSS, 0.01, True),
        # not clear; more than a gear loses; none gives back
        (0.05, 0.06 / SURE, False),
        (1.01 * MOST_LOSS, 0.01, False),
        (-0.05, 0.01, False),
    ],
)
def test_only_a_clear_loss_that_a_gear_has_is_one(value: float, error: float, could: bool) -> None:
    layout = ColumnLayout(2, (Extra("stribeck", 1), LOAD))
    theta = np.zeros(layout.count)
    covariance = np.zeros((layout.count, layout.count))
    theta[layout.extra(LOAD)] = value
    covariance[-1, -1] = error**2
    trial: Any = SimpleNamespace(
        layout=layout, like=SimpleNamespace(theta=theta, covariance=covariance)
    )
    assert _gear_could(LOAD, trial) is could


def test_the_heavier_half_is_that_of_each_gear() -> None:
    m = motion()
    model = irb.Model(irb.load_robot("irb2400").model_copy(update={"effects": ()}))
    phi = model.robot.inertial_parameters.ravel()
    known = np.ones_like(m.q, dtype=bool)
    part = Recording(
        replace(m, known=known), np.zeros(len(m.time), dtype=np.int64), np.zeros_like(m.tau)
    )
    layout = ColumnLayout(6, pressing=tuple(phi.tolist()))
    (upper,) = heavier_half(model, layout, [part])
    load = np.abs(model.body_torque(m.q, m.qd, m.qdd, phi))
    seen = upper.motion.known
    assert 0.05 < seen.mean() < 0.6
    for j in range(6):
        assert load[seen[:, j], j].min() >= load[~seen[:, j], j].max()
