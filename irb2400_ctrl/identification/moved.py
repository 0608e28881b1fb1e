"""How far the numbers went from what the file says, in the file's own standard deviations."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.base_prior import BODY, body_numbers, body_spread
from irb2400_ctrl.identification.fitting.consistent_fit import (
    ELEMENTS,
    consistent_minimum,
    possible,
    pseudo_inertias,
)
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.prior import FACTOR, FAR, Prior
from irb2400_ctrl.robot import Body, Robot

ALARM = 4.0
"""standard deviations beyond which a body is not the file's"""
SHOWN = 2.0
"""of its own standard errors, that a number must be from the file's for the logs to show it: what
they leave open may end anywhere, because all numbers of a body have to be possible together"""
ROUNDING = 1e-9
"""of the trace of a pseudo-inertia"""
LEAST = np.array([1e-3, *[1e-3] * 3, *[1e-5] * 6])
"""a gram, a millimetre, a gram at 10 cm: nobody states a body better"""
OF_THE_FILE = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""elements of an inertia, in the order of `Body.inertia_kgm2`"""


@dataclass(frozen=True)
class Moved:
    """One body; the last one with the tool in it.

    Args:
        link: from 1; before, after: mass [kg], centre [m], inertia about it [kg m2], shape (10,);
        sigmas: the change over the file's standard deviations, shape (10,); errors: standard errors
            of the numbers after it, over the same; could_be: whether the file's body can exist at
            all.
    """

    link: int
    before: Array
    after: Array
    sigmas: Array
    errors: Array
    could_be: bool

    @property
    def most(self) -> tuple[str, float]:
        """The number that went furthest, and how far."""
        place = int(np.argmax(np.abs(self.sigmas)))
        return BODY[place], float(self.sigmas[place])

    @property
    def shown(self) -> tuple[str, float]:
        """The number that went furthest of those of which the logs say that it went; a nameless
        one that stayed where there is none."""
        clear = np.where(np.abs(self.sigmas) > SHOWN * self.errors, self.sigmas, 0.0)
        place = int(np.argmax(np.abs(clear)))
        return (BODY[place], float(clear[place])) if clear[place] else ("", 0.0)

    @property
    def far(self) -> bool:
        """Whether the mass went absurdly far, however well it is known."""
        little, much = sorted((float(self.before[0]), float(self.after[0])))
        return abs(float(self.sigmas[0])) > FAR and much > FACTOR * little

    @property
    def alarms(self) -> bool:
        """Whether the body is not the file's; one that cannot exist has to move."""
        return self.could_be and (self.far or abs(self.shown[1]) > ALARM)


def moved_bodies(
    robot: Robot, fit: Fit, covariance: Array, guessed: Collection[str] = ()
) -> list[Moved]:
    """Every link, tool folded in on both sides.

    A file whose bodies cannot exist is first moved to the nearest ones that can, in its own
    standard deviations: that much is no news of this arm.

    Args:
        robot: the file; fit: its numbers; covariance: of those, shape (p, p).
        guessed: names of links whose inertia is not the file's, which cannot be far from it.
    """
    found = []
    theta = fit.theta
    nearest = _nearest_possible(fit.prior)
    for link in range(robot.n):
        before = nearest[link]
        own = slice(10 * link, 10 * link + 10)
        after = body_numbers(Body.of_parameters(theta[own]))
        body = Body.of_parameters(np.array([max(before[0], 1e-9), *before[1:]]))
        spread = np.maximum(body_spread(robot.uncertainty, body, robot.links[link].name), LEAST)
        if robot.links[link].name in guessed:
            spread[4:] = np.inf
        change = after - body_numbers(body)
        file = pseudo_inertias(robot.inertial_parameters[link : link + 1])[0]
        could_be = bool(np.linalg.eigvalsh(file)[0] > -ROUNDING * abs(np.trace(file)))
        sigmas = change / spread
        errors = _errors(theta[own], covariance[own, own]) / spread
        found.append(Moved(link + 1, body_numbers(body), after, sigmas, errors, could_be))
    return found


def _nearest_possible(prior: Prior) -> Array:
    """Bodies that the file alone makes most probable among those that can exist, (n, 10)."""
    n = len(prior.bodies)
    middle = prior.mean[: 10 * n]
    precision = prior.precision(np.ones(n))[: 10 * n, : 10 * n]
    start = possible(middle.reshape(n, 10)).ravel()
    none = np.array([], dtype=np.int64)
    return consistent_minimum(precision, precision @ middle, n, none, start).reshape(n, 10)


def _errors(phi: Array, covariance: Array) -> Array:
    """Standard errors of mass, centre and inertia about it, to first order, shape (10,).

    c = h / m and I_c = I_O - (|h|^2 1 - h h') / m, so dc = (dh - c dm) / m and
    dI_c = dI_O - d(|h|^2 1 - h h') / m + (|h|^2 1 - h h') dm / m^2.
    """
    m = max(float(phi[0]), 1e-9)
    c = phi[1:4] / m
    slope = np.eye(10)
    slope[1:4] = np.hstack([-c[:, None], np.eye(3), np.zeros((3, 6))]) / m
    for row, (i, k) in zip(slope[4:], OF_THE_FILE, strict=True):
        same = float(i == k)
        row[0] = same * (c @ c) - c[i] * c[k]
        row[1:4] = -2.0 * same * c
        row[1 + i] += c[k]
        row[1 + k] += c[i]
    # the file's order of the elements is not that of phi
    slope[4:, 4:] = np.array([[float(e == f) for f in ELEMENTS] for e in OF_THE_FILE])
    return np.asarray(np.sqrt(np.maximum(np.diag(slope @ covariance @ slope.T), 0.0)))
