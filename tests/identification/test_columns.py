"""The columns, their sums and what is made of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.choice import Choice, _may_be, candidates
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra, columns
from irb2400_ctrl.identification.fitting.consistent_fit import possible, pseudo_inertias
from irb2400_ctrl.identification.fitting.noise import correlation_factor
from irb2400_ctrl.identification.fitting.prior import prior_of
from irb2400_ctrl.identification.gate import _grade, motion_for
from irb2400_ctrl.identification.identified_robot import fit_base, identified_robot
from irb2400_ctrl.robot import Body


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(fit_base(irb.load_robot("irb2400"))[0])


EVERYTHING = (
    Extra("coupling", 5),
    Extra("far_coupling", 4),
    Extra("balancer", 2),
    Extra("reading", 4),
    Extra("stribeck", 3),
    Extra("power", 1),
    Extra("load", 6),
)


def test_the_robot_says_what_the_columns_say(model: irb.Model) -> None:
    """Bodies, tool, friction and every extra: the effects of the robot are the columns."""
    rng = np.random.default_rng(0)
    layout = ColumnLayout(6, EVERYTHING)
    theta = np.abs(rng.normal(size=layout.count)) + 0.1
    bodies = model.robot.inertial_parameters
    theta[: layout.inertial] = possible(1.3 * bodies).ravel()
    theta[layout.extra(Extra("load", 6))] = 0.05
    layout = replace(layout, pressing=tuple(theta[: layout.inertial].tolist()))
    q = rng.uniform(-1, 1, (20, 6))
    qd = rng.normal(size=(20, 6))
    qdd = rng.normal(size=(20, 6))
    robot, said = identified_robot(model.robot, layout, theta)
    assert said == ""
    # the file's own rise at low speed stays
    friction = model.robot.friction
    rise = (friction[:, 0] - friction[:, 1]) * np.sign(qd)
    expected = columns(model, layout, q, qd, qdd) @ theta
    expected += rise * np.exp(-((qd / friction[:, 3]) ** 2))
    # a measuring effect is not in the model's torque
    offsets = theta[layout.drive("offset")]
    reading = np.zeros((20, 6))
    reading[:, 3] = theta[layout.extra(Extra("reading", 4))] * qdd[:, 3]
    found = irb.Model(robot).inverse_dynamics(q, qd, qdd) + offsets - reading
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_a_tool_heavier_than_the_last_link_is_said(model: irb.Model) -> None:
    layout = ColumnLayout(6)
    theta = np.ones(layout.count)
    phi = possible(model.robot.inertial_parameters)
    phi[-1] *= 0.01
    theta[: layout.inertial] = phi.ravel()
    robot, said = identified_robot(model.robot, layout, theta)
    assert "weighs less than the file's tool" in said
    np.testing.assert_allclose(robot.inertial_parameters, phi, atol=1e-9)


def test_a_body_and_back() -> None:
    phi = irb.load_robot("irb2400").inertial_parameters[2]
    np.testing.assert_allclose(Body.of_parameters(phi).parameters(), phi, atol=1e-12)


def test_possible_bodies_are_strictly_inside() -> None:
    phi = irb.load_robot("irb2400").inertial_parameters
    assert np.linalg.eigvalsh(pseudo_inertias(phi)).min() < 0  # as printed
    inside = possible(phi)
    assert np.linalg.eigvalsh(pseudo_inertias(inside)).min() > 0


def test_names_and_places_agree() -> None:
    layout = ColumnLayout(6, EVERYTHING)
    names = layout.names()
    assert len(names) == layout.count == len(set(names))
    assert names[layout.drive("rotor").start] == "rotor_1"
    assert names[layout.extra(Extra("reading", 4)).start] == "reading_4 -qdd"
    smaller = ColumnLayout(6, EVERYTHING[2:])
    assert [names[k] for k in smaller.within(layout)] == smaller.names()


@pytest.mark.parametrize(("memory", "factor"), [(0.0, 1.0), (0.8, 9.0)])
def test_correlation_of_a_known_process(memory: float, factor: float) -> None:
    """x_k = a x_(k-1) + e: (1 + a) / (1 - a) samples say the same thing."""
    rng = np.random.default_rng(1)
    x = np.zeros((20000, 1))
    for k, noise in enumerate(rng.normal(size=20000)):
        x[k] = memory * x[k - 1] + noise
    found = correlation_factor(x, np.ones_like(x, dtype=bool))
    assert found[0] == pytest.approx(factor, rel=0.25)


def test_a_far_coupling_is_taken_on_only_beside_one_of_neighbours() -> None:
    far = Extra("far_coupling", 4)
    assert not _may_be(far, [Extra("power", 4), Extra("balancer", 2)])
    assert _may_be(far, [Extra("power", 4), Extra("coupling", 5)])
    assert _may_be(Extra("coupling", 5), [])
    assert _may_be(Extra("power", 1), [])
    assert {e for e in candidates(6) if len(e.touches) > 1} == {
        Extra("coupling", 4),
        Extra("coupling", 5),
        far,
    }
    assert far.touches == (3, 5)
    assert motion_for("far_coupling_4 qdd here").startswith("joint 4 and the next but one")
    assert motion_for("coupling_5 qdd here").startswith("joint 5 and the next, ")
    assert "link 3" in motion_for("mx_3")
    assert motion_for("load_2 load sgn qd").startswith("slow runs of joint 2 both ways")


def chosen(*motors: Extra, left_by_motors: float = 1.0, **worth: float) -> list[str]:
    """What a choice takes on of extras that are worth so much [nats]."""

    class Told(Choice):
        def _tried(self, extras: Any) -> Any:
            gained = sum(worth.get(f"{e.kind}_{e.joint}", -1.0) for e in extras)
            left = left_by_motors if set(motors) & set(extras) else 1.0
            layout = SimpleNamespace(extras=extras)
            return SimpleNamespace(
                evidence=gained, possible=True, layout=layout, left=np.array([left])
            )

        def _shown(self, extra: Any, trial: Any, now: Any) -> bool:
            return True

    nothing: Any = None
    base: Any = SimpleNamespace(layout=SimpleNamespace(n=6))
    told = Told(base, nothing, nothing, nothing, ColumnLayout(6, motors))
    return [f"{e.kind}_{e.joint}" for e in told.extras()]


@pytest.mark.parametrize(("left", "expected"), [(0.9, "motor_6"), (1.1, "coupling_5")])
def test_motors_are_chosen_where_they_leave_less_than_couplings(left: float, expected: str) -> None:
    motor = Extra("motor", 6, (0.5, 0.0))
    assert chosen(motor, left_by_motors=left, motor_6=30.0, coupling_5=20.0)[0] == expected


def test_the_choice_asks_what_may_be() -> None:
    assert chosen(far_coupling_4=50.0) == []
    assert chosen(far_coupling_4=50.0, coupling_5=20.0) == ["coupling_5", "far_coupling_4"]
    assert chosen(far_coupling_4=5.0, coupling_5=20.0) == ["coupling_5", "far_coupling_4"]


def test_the_widths_of_a_coupling_are_those_of_its_two_joints(model: irb.Model) -> None:
    far = Extra("far_coupling", 4)
    layout = ColumnLayout(6, (far,))

    def widths(faster: int) -> np.ndarray:
        speed = np.ones(6)
        speed[faster - 1] = 2.0
        prior = prior_of(model.robot, layout, (np.ones(6), speed, np.ones(6)))
        return np.sqrt(prior.drives[-far.size :])

    usual = widths(1)
    np.testing.assert_allclose(widths(5), usual)
    # friction here by the motion of joint 6, there by that of joint 4
    np.testing.assert_allclose(widths(6) / usual, [1, 1, 0.5, 1, 1, 1])
    np.testing.assert_allclose(widths(4) / usual, [1, 1, 1, 0.5, 1, 1])


def test_a_number_is_graded_by_its_error_over_the_size_that_matters() -> None:
    grades = [_grade(ratio, True, [])[0] for ratio in (0.19, 0.21, 0.99, 1.01)]
    assert grades == ["identifiable", "weak", "weak", "not identifiable"]
