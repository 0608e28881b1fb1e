"""Bodies of an arm of whose bodies its file says nothing: shaped as arms are, as heavy as its
torques ask for, and free to be another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.plausibility import is_a_point, unknown_bodies
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.robot.uncertainty import BodyUncertainty, Uncertainty

GUESSED = (
    "the file says nothing of the bodies ({why}): they are guessed from the lengths of the links "
    "and the largest of the torques, each free to be another, and fitted; what no torque shows "
    "stays a guess"
)
NO_INERTIA = (
    "the file says nothing of the inertia of {links} (as a point has it): guessed from the lengths "
    "of the links, each free to be another, and fitted"
)
LIGHTER = 0.65
"""mass of a link over that of the one before it"""
GYRATION = 0.35
"""radius about its centre, over its length"""
SHORTEST = 0.1
"""length of a link over that of the arm, at least"""
ROWS = 2000
"""of a log that the weight is taken from"""
MASS = 0.7
"""how little is known of the guess: relative; of the centre over the arm's length; relative"""
CENTRE = 0.1
INERTIA = 1.0


def with_guessed_bodies(robot: Robot, logs: Sequence[Log]) -> Robot:
    """The robot with bodies guessed where its file has none, else itself.

    Each lies half way to the next joint, m_k = m_0 LIGHTER^k; m_0 is such that gravity on the joint
    that bears most is as large as its torque, rms.
    """
    if not unknown_bodies(robot):
        return robot
    ends = _ends(robot)
    unit = _with(robot, ends, 1.0)
    model = Model(unit)
    held = 0.0
    measured = 0.0
    for log in logs:
        step = max(1, len(log.time) // ROWS)
        q = log.q[::step]
        weight = model.inverse_dynamics(q, 0.0 * q, 0.0 * q, friction=False)
        power = np.mean(log.tau[::step] ** 2, axis=0)
        joint = int(np.argmax(power))
        held += float(np.mean(np.asarray(weight)[:, joint] ** 2))
        measured += float(power[joint])
    return _with(robot, ends, float(np.sqrt(measured / max(held, 1e-12))))


def without_inertia(robot: Robot) -> list[str]:
    """Links whose mass the file states, and no inertia that a body of it has.

    None where most links have one: a single point stands for what others hold (link 5 of a KR300).
    """
    heavy = [link for link in robot.links if link.body.mass_kg > 0.0]
    points = [link.name for link in heavy if is_a_point(link.body)]
    return points if 2 * len(points) > len(heavy) else []


def with_guessed_inertias(robot: Robot) -> Robot:
    """The robot with inertias guessed where its file states none, else itself.

    What is stated as zero would be known as zero: no mass nor centre makes up for it.
    """
    missing = without_inertia(robot)
    if not missing:
        return robot
    links = []
    wide = dict(robot.uncertainty.links)
    for link, end in zip(robot.links, _ends(robot), strict=True):
        body = link.body
        if link.name in missing:
            guess = _inertia(robot, end, body.mass_kg)
            body = body.model_copy(update={"inertia_kgm2": guess})
            own = wide.get(link.name, BodyUncertainty())
            wide[link.name] = own.model_copy(update={"inertia_relative": INERTIA})
        links.append(link.model_copy(update={"body": body}))
    uncertainty = robot.uncertainty.model_copy(update={"links": wide})
    return robot.model_copy(update={"links": tuple(links), "uncertainty": uncertainty})


def said_of_inertias(robot: Robot) -> list[str]:
    """Of a file whose inertias were guessed."""
    missing = without_inertia(robot)
    return [NO_INERTIA.format(links=", ".join(missing))] if missing else []


def _ends(robot: Robot) -> list[Array]:
    """Where each link's next joint, or the flange, is in its frame [m]."""
    ends = [np.array(link.frame.matrix())[:3, 3] for link in robot.links[1:]]
    return [*ends, np.array(robot.flange.matrix())[:3, 3]]


def _inertia(
    robot: Robot, end: Array, mass: float
) -> tuple[float, float, float, float, float, float]:
    """Of a link as long as to its end, as `Body` has it [kg m2]."""
    length = max(float(np.linalg.norm(end)), SHORTEST * robot.reach)
    moment = mass * (GYRATION * length) ** 2
    return (moment, moment, moment, 0.0, 0.0, 0.0)


def _with(robot: Robot, ends: Sequence[Array], mass: float) -> Robot:
    """With the first link of this mass [kg], `ends` of the links in their frames [m]."""
    links = []
    for k, (link, end) in enumerate(zip(robot.links, ends, strict=True)):
        m = mass * LIGHTER**k
        x, y, z = (0.5 * end).tolist()
        body = Body(mass_kg=m, com_m=(x, y, z), inertia_kgm2=_inertia(robot, end, m))
        links.append(link.model_copy(update={"body": body, "source": "guessed"}))
    wide = Uncertainty(mass_relative=MASS, com_m=CENTRE * robot.reach, inertia_relative=INERTIA)
    return robot.model_copy(update={"links": tuple(links), "uncertainty": wide})
