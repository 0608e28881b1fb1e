"""Bodies of an arm of whose bodies its file says nothing: shaped as arms are, as heavy as its
torques ask for, and free to be another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.plausibility import unknown_bodies
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.robot.uncertainty import Uncertainty

GUESSED = (
    "the file says nothing of the bodies ({why}): they are guessed from the lengths of the links "
    "and the largest of the torques, each free to be another, and fitted; what no torque shows "
    "stays a guess"
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
    ends = [np.array(link.frame.matrix())[:3, 3] for link in robot.links[1:]]
    ends.append(np.array(robot.flange.matrix())[:3, 3])
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


def _with(robot: Robot, ends: Sequence[Array], mass: float) -> Robot:
    """With the first link of this mass [kg], `ends` of the links in their frames [m]."""
    links = []
    for k, (link, end) in enumerate(zip(robot.links, ends, strict=True)):
        m = mass * LIGHTER**k
        moment = m * (GYRATION * max(float(np.linalg.norm(end)), SHORTEST * robot.reach)) ** 2
        x, y, z = (0.5 * end).tolist()
        body = Body(mass_kg=m, com_m=(x, y, z), inertia_kgm2=(moment,) * 3 + (0.0,) * 3)
        links.append(link.model_copy(update={"body": body, "source": "guessed"}))
    wide = Uncertainty(mass_relative=MASS, com_m=CENTRE * robot.reach, inertia_relative=INERTIA)
    return robot.model_copy(update={"links": tuple(links), "uncertainty": wide})
