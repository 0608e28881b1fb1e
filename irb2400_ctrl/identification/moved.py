"""How far the numbers went from what the file says, in the file's own standard deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.identified_robot import body_of
from irb2400_ctrl.identification.prior import body_spreads
from irb2400_ctrl.robot import Body, Robot

ALARM = 4.0
"""standard deviations beyond which a body is not the file's"""
LEAST = np.array([1e-3, *[1e-3] * 3, *[1e-5] * 6])
"""a gram, a millimetre, a gram at 10 cm: nobody states a body better"""
NAMES = ("mass_kg", "com_x_m", "com_y_m", "com_z_m", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")


@dataclass(frozen=True)
class Moved:
    """One body; the last one with the tool in it.

    Args:
        link: from 1; before, after: mass [kg], centre [m], inertia about it [kg m2], shape (10,);
        sigmas: the change over the file's standard deviations, shape (10,); width: of the body in
            those, as the fit found it.
    """

    link: int
    before: Array
    after: Array
    sigmas: Array
    width: float

    @property
    def most(self) -> tuple[str, float]:
        """The number that went furthest, and how far."""
        place = int(np.argmax(np.abs(self.sigmas)))
        return NAMES[place], float(self.sigmas[place])

    @property
    def alarms(self) -> bool:
        """Whether the body is not the file's."""
        return abs(self.most[1]) > ALARM


def moved_bodies(robot: Robot, theta: Array, kappa: Array) -> list[Moved]:
    """Every link, tool folded in on both sides."""
    found = []
    for link in range(robot.n):
        before = robot.inertial_parameters[link]
        after = _numbers(body_of(theta[10 * link : 10 * link + 10]))
        body = body_of(np.array([max(before[0], 1e-9), *before[1:]]))
        spread = np.maximum(body_spreads(robot, body, robot.links[link].name), LEAST)
        change = after - _numbers(body)
        found.append(Moved(link + 1, _numbers(body), after, change / spread, float(kappa[link])))
    return found


def _numbers(body: Body) -> Array:
    return np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])
