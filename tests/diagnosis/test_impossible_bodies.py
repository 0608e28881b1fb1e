"""A log that asks for bodies that could not exist, of a robot whose own could."""

from __future__ import annotations

from typing import Any

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.possible_bodies import turns_impossible
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
