"""Numbers that this arm could not have, bodies, springs, forces, delays."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.possible import (
    can_be_put_on,
    can_be_taken_off,
    relaxes_within_reach,
    small_enough,
)
from irb2400_ctrl.diagnosis.possible_bodies import turns_impossible
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.robot import Robot


def with_inertia(robot: Robot, moments: tuple[float, ...]) -> Robot:
    last = robot.links[-1]
    body = last.body.model_copy(update={"inertia_kgm2": moments})
    links: Any = (*robot.links[:-1], last.model_copy(update={"body": body}))
    return robot.model_copy(update={"links": links})


def test_bodies_that_turn_impossible_are_noted() -> None:
    robot = irb.load_robot("ur10e")
    assert not turns_impossible(robot, robot)
    assert not turns_impossible(robot, with_inertia(robot, (0.01, 0.01, 0.01, 0.0, 0.0, 0.0)))
    negative = with_inertia(robot, (-2.0, -2.0, -2.0, 0.0, 0.0, 0.0))
    assert turns_impossible(robot, negative)
    # what was so already is no news
    assert not turns_impossible(negative, with_inertia(robot, (-3.0, -3.0, -3.0, 0.0, 0.0, 0.0)))


@pytest.mark.parametrize(("taken", "there"), [(4.0, True), (6.0, False), (-50.0, True)])
def test_a_link_is_no_lighter_than_nothing(taken: float, there: bool) -> None:
    """Of an arm of ten kilograms a log of late torques took 39 off a link of two, "explained"."""
    robot = irb.load_robot("irb2400").model_copy(update={"tool": None})
    last = robot.links[-1].body.mass_kg
    before = robot.links[-2].body.mass_kg
    payload = LIBRARY["payload"].of(None, mass_kg=-taken * last / 5.0)
    assert can_be_taken_off(robot, payload) == there
    # what the link carries is its as well: the torque hardly knows which mass is whose
    together = (last + before) / 5.0
    link = LIBRARY["link_inertia"].of(5, mass_kg=-taken * together)
    assert can_be_taken_off(robot, link) == there
    assert can_be_taken_off(robot, LIBRARY["torque_offset"].of(1, offset_Nm=-5.0))
    # what the file says besides that it carries
    loaded = robot.with_effects(LIBRARY["payload"].of(None, mass_kg=2.0 * last))
    assert can_be_taken_off(loaded, payload)


@pytest.mark.parametrize(
    ("kind", "joint", "numbers"),
    [
        ("link_inertia", 4, {"mass_kg": -500.0}),
        ("payload", None, {"mass_kg": 2.0, "com_m": (0.0, 0.0, 2.0)}),
        ("cable_spring", 2, {"stiffness_Nm_rad": 5.0, "neutral_rad": 6.0}),
        ("process_force", None, {"force_x_N": 1.0, "moment_y_Nm": 2.0}),
        ("time_delay", 3, {"delay_s": -0.03}),
        ("link_inertia", 5, {"mass_kg": 50.0}),
        ("encoder_zero", 6, {"zero_rad": -1614.0}),
    ],
)
def test_what_this_arm_cannot_have_is_not_borne_out(
    kind: str, joint: int | None, numbers: dict[str, Any]
) -> None:
    robot = irb.load_robot("irb2400")
    effect = LIBRARY[kind].of(joint, **numbers)
    acceptance = Acceptance(SimpleNamespace(robot=robot), Criteria())  # type: ignore[arg-type]
    step: Any = SimpleNamespace(candidate=SimpleNamespace(effects=(effect,)))
    fit: Any = SimpleNamespace(effects=(effect,))
    assert not acceptance.bears_out([step], fit, 0)


@pytest.mark.parametrize(("times", "there"), [(1.9, True), (2.1, False), (-0.5, True)])
def test_a_link_is_not_three_times_as_heavy_as_stated(times: float, there: bool) -> None:
    """A wrist of 8 kg was 82 kg too heavy (0.95): the load at the tool."""
    robot = irb.load_robot("irb2400")
    mass = times * robot.links[4].body.mass_kg
    assert can_be_put_on(robot, LIBRARY["link_inertia"].of(5, mass_kg=mass)) == there
    assert can_be_put_on(robot, LIBRARY["payload"].of(None, mass_kg=mass))


def test_a_link_of_unstated_mass_may_have_any() -> None:
    robot = irb.load_robot("irb2400")
    last = robot.links[4]
    nothing = last.model_copy(update={"body": last.body.model_copy(update={"mass_kg": 0.0})})
    links: Any = (*robot.links[:4], nothing, *robot.links[5:])
    unstated = robot.model_copy(update={"links": links})
    assert can_be_put_on(unstated, LIBRARY["link_inertia"].of(5, mass_kg=50.0))


@pytest.mark.parametrize(("angle", "there"), [(0.45, True), (-0.45, True), (0.55, False)])
def test_an_angle_error_is_as_small_as_its_law_has_it(angle: float, there: bool) -> None:
    """An encoder was "1614 rad off" (0.90) on an axis whose torque hardly knows its angle."""
    assert small_enough(LIBRARY["encoder_zero"].of(6, zero_rad=angle)) == there
    both = {"tilt_x_rad": 0.6 * angle, "tilt_y_rad": 0.8 * angle}
    assert small_enough(LIBRARY["base_tilt"].of(None, **both)) == there


@pytest.mark.parametrize(
    ("neutral", "there"), [(-3.3, True), (-3.4, False), (3.4, True), (3.5, False), (0.0, True)]
)
def test_a_spring_pulls_towards_an_angle_near_its_joints_range(neutral: float, there: bool) -> None:
    """Joint 5 of a small arm had a spring that pulls to -250 degrees, which was the asymmetry of
    its friction; axis 2 of the IRB 2400 turns from -100 to 110 degrees."""
    spring = LIBRARY["cable_spring"].of(2, stiffness_Nm_rad=5.0, neutral_rad=neutral)
    assert relaxes_within_reach(irb.load_robot("irb2400"), spring) == there


def test_a_spring_is_held_against_the_one_that_the_file_states() -> None:
    """Of a spring of 30 Nm/rad at 0.3 rad that is one of 33 at 0.6 the difference pulls to 3.6."""
    robot = irb.load_robot("irb2400")
    spring = LIBRARY["cable_spring"]
    change = spring.of(3, stiffness_Nm_rad=3.0, neutral_rad=3.6)
    assert not relaxes_within_reach(robot, change)
    stated = robot.with_effects(spring.of(3, stiffness_Nm_rad=30.0, neutral_rad=0.3))
    assert relaxes_within_reach(stated, change)
    elsewhere = robot.with_effects(spring.of(2, stiffness_Nm_rad=30.0, neutral_rad=0.3))
    assert not relaxes_within_reach(elsewhere, change)


@pytest.mark.parametrize(
    ("gain", "told"),
    [
        *((0.975, False), (1.025, False), (0.96, True), (1.04, True)),
        *((1.6, True), (2.4, True), (2.6, False), (0.45, True), (0.39, False)),
    ],
)
def test_a_gain_within_what_torque_constants_are_known_to_is_none(gain: float, told: bool) -> None:
    """A gain of 0.975 of joint 4 was told (0.94) of an arm that reads joint 5 a fifth too low. A
    log of 0.4 or less is refused for its unit; 0.45 was nobody's, and two on axis 6 was a friction
    that grows with the load (0.98)."""
    assert LIBRARY["torque_gain"].of(4, gain=gain).unlikely is not told
