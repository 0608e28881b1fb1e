"""How far the numbers went from what the file says, in the file's own standard deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.base_prior import body_spread
from irb2400_ctrl.identification.fitting.consistent_fit import (
    consistent_minimum,
    possible,
    pseudo_inertias,
)
from irb2400_ctrl.identification.fitting.prior import Prior
from irb2400_ctrl.identification.identified_robot import body_of
from irb2400_ctrl.robot import Body, Robot

ALARM = 4.0
"""standard deviations beyond which a body is not the file's"""
ROUNDING = 1e-9
"""of the trace of a pseudo-inertia"""
LEAST = np.array([1e-3, *[1e-3] * 3, *[1e-5] * 6])
"""a gram, a millimetre, a gram at 10 cm: nobody states a body better"""
NAMES = ("mass_kg", "com_x_m", "com_y_m", "com_z_m", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")


@dataclass(frozen=True)
class Moved:
    """One body; the last one with the tool in it.

    Args:
        link: from 1; before, after: mass [kg], centre [m], inertia about it [kg m2], shape (10,);
        sigmas: the change over the file's standard deviations, shape (10,); width: of the body in
            those, as the fit found it; could_be: whether the file's body can exist at all.
    """

    link: int
    before: Array
    after: Array
    sigmas: Array
    width: float
    could_be: bool

    @property
    def most(self) -> tuple[str, float]:
        """The number that went furthest, and how far."""
        place = int(np.argmax(np.abs(self.sigmas)))
        return NAMES[place], float(self.sigmas[place])

    @property
    def alarms(self) -> bool:
        """Whether the body is not the file's; one that cannot exist has to move."""
        return self.could_be and abs(self.most[1]) > ALARM


def moved_bodies(robot: Robot, prior: Prior, theta: Array, kappa: Array) -> list[Moved]:
    """Every link, tool folded in on both sides.

    A file whose bodies cannot exist is first moved to the nearest ones that can, in its own
    standard deviations: that much is no news of this arm.

    Args:
        robot: the file.
        prior: spreads of its numbers.
        theta: the fitted numbers, shape (p,).
        kappa: width of each body's prior over the stated one, shape (n,) [-].
    """
    found = []
    nearest = _nearest_possible(prior)
    for link in range(robot.n):
        before = nearest[link]
        after = _numbers(body_of(theta[10 * link : 10 * link + 10]))
        body = body_of(np.array([max(before[0], 1e-9), *before[1:]]))
        spread = np.maximum(body_spread(robot.uncertainty, body, robot.links[link].name), LEAST)
        change = after - _numbers(body)
        file = pseudo_inertias(robot.inertial_parameters[link : link + 1])[0]
        could_be = bool(np.linalg.eigvalsh(file)[0] > -ROUNDING * abs(np.trace(file)))
        sigmas = change / spread
        width = float(kappa[link])
        found.append(Moved(link + 1, _numbers(body), after, sigmas, width, could_be))
    return found


def _nearest_possible(prior: Prior) -> Array:
    """Bodies that the file alone makes most probable among those that can exist, (n, 10)."""
    n = len(prior.bodies)
    middle = prior.mean[: 10 * n]
    precision = prior.precision(np.ones(n))[: 10 * n, : 10 * n]
    start = possible(middle.reshape(n, 10)).ravel()
    none = np.array([], dtype=np.int64)
    return consistent_minimum(precision, precision @ middle, n, none, start).reshape(n, 10)


def _numbers(body: Body) -> Array:
    return np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])
