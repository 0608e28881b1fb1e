"""What the robot file says before a log is looked at, with the width that it states.

Bodies: phi of link i is N(phi_0, kappa_i^2 C_i) with C_i from the spreads of mass, centre of mass
and inertia; kappa_i is fitted (a Student-t with few degrees of freedom), so that a file whose body
is not this arm's is left, and one that is right is kept. What the file does not know is wide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.diagnosis.preparation.base_prior import (
    body_spread,
    named_bodies,
    parameter_slope,
)
from irb2400_ctrl.identification.fitting.columns import (
    COUPLED,
    DRIVE_TERMS,
    EXPONENT,
    ColumnLayout,
    Extra,
)
from irb2400_ctrl.robot import Robot

DEGREES_OF_FREEDOM = 4.0
"""of the Student-t on each body"""
RESTING = 0.02
"""speed and acceleration of a joint that counts as resting, over those of the fastest"""
WIDE = 1.0
"""torque of a number that nobody knows, as a share of the joint's rms torque"""
LIKE_DRY = 1.0
"""[rad/s] least speed at which viscous friction may be as large as dry friction: a slow log tells
only their sum, and what is all viscous there is many times a drive's torque at full speed"""
GEAR_LOSS = 0.05
"""dry friction over the torque that a gear carries [-]"""
FAR = 10.0
"""standard deviations of a mass, and"""
FACTOR = 5.0
"""factor, beyond both of which it is absurd even where the logs leave it open: what the fit takes
so far away has a cause, if not that body"""
ZERO_OFF = 0.5
"""[rad] a zero that is not the file's"""


@dataclass(frozen=True)
class Prior:
    """Mean and precision of every column's number.

    Args:
        mean: (p,); bodies: inverse covariance of each link's phi at kappa = 1, (n, 10, 10);
        drives: variance of the other numbers, (p - 10 n,).
    """

    mean: Array
    bodies: Array
    drives: Array

    def precision(self, kappa: Array) -> Array:
        """Inverse covariance of all numbers with the bodies' widths kappa (n,), shape (p, p)."""
        n = len(self.bodies)
        found = np.zeros((len(self.mean), len(self.mean)))
        for link in range(n):
            place = slice(10 * link, 10 * link + 10)
            found[place, place] = self.bodies[link] / kappa[link] ** 2
        rest = np.arange(10 * n, len(self.mean))
        found[rest, rest] = 1.0 / self.drives
        return found

    def absurd(self, theta: Array) -> Mask:
        """Links whose masses are more than `FAR` and `FACTOR` from the file's, shape (n,)."""
        n = len(self.bodies)
        before, after = (of[: 10 * n : 10] for of in (self.mean, theta))
        spread = np.sqrt(np.linalg.inv(self.bodies)[:, 0, 0])
        little, much = (end(before, after) for end in (np.minimum, np.maximum))
        return np.asarray((np.abs(after - before) > FAR * spread) & (much > FACTOR * little))

    def part(self, columns: Integers) -> Prior:
        """Of a layout that lacks some of the drives' columns."""
        inertial = 10 * len(self.bodies)
        drives = self.drives[columns[columns >= inertial] - inertial]
        return Prior(self.mean[columns], self.bodies, drives)

    def distance(self, theta: Array, covariance: Array | None = None) -> Array:
        """Squared distance of each body from the file's in its own spreads, shape (n,).

        With a covariance, its expectation over that uncertainty.
        """
        n = len(self.bodies)
        off = (theta - self.mean)[: 10 * n].reshape(n, 10)
        squared = np.einsum("ka,kab,kb->k", off, self.bodies, off)
        if covariance is not None:
            for link in range(n):
                place = slice(10 * link, 10 * link + 10)
                squared[link] += np.trace(self.bodies[link] @ covariance[place, place])
        return np.asarray(squared)


def prior_of(robot: Robot, layout: ColumnLayout, scale: tuple[Array, Array, Array]) -> Prior:
    """The prior of a robot file.

    Args:
        robot: the file; layout: which columns there are.
        scale: rms torque [Nm], speed [rad/s] and acceleration [rad/s2] of each joint on the logs.
    """
    n = robot.n
    torque = scale[0]
    # of a joint that rests only noise is left, which is no scale of anything
    moves = scale[1] > RESTING * scale[1].max()
    speed, acceleration = (np.maximum(size, RESTING * size.max()) for size in scale[1:])
    covariances = np.zeros((n, 10, 10))
    for i, (body, name) in enumerate(named_bodies(robot)):
        link, X = (i, None) if i < n else (n - 1, robot.flange.matrix())
        half = parameter_slope(body, X) * body_spread(robot.uncertainty, body, name)
        covariances[link] += half @ half.T
    # a body without mass has no spread of its own: a gram and a gram at 10 cm are nothing
    covariances += np.diag([1e-3, *[1e-4] * 3, *[1e-5] * 6]) ** 2
    mean = np.zeros(layout.count)
    mean[: layout.inertial] = robot.inertial_parameters.ravel()
    drives = np.zeros(layout.count)
    friction = robot.friction
    wide = WIDE * torque
    known = {"coulomb": friction[:, 1], "viscous": friction[:, 2]}
    size = {
        "coulomb": wide,
        "viscous": wide / np.maximum(speed, LIKE_DRY),
        "offset": wide,
        "rotor": wide / acceleration,
    }
    for term in DRIVE_TERMS:
        place = layout.drive(term)
        value = known.get(term, np.zeros(n))
        mean[place] = value
        # friction of a file is that of another day: half of it, at least a few per cent wide
        spread = np.where(value > 0, np.hypot(0.5 * value, 0.1 * size[term] * moves), size[term])
        drives[place] = spread**2
    for extra in layout.extras:
        drives[layout.extra(extra)] = _extra_widths(extra, wide, speed, acceleration) ** 2
    bodies = np.asarray(np.linalg.inv(covariances), dtype=float)
    return Prior(mean, bodies, drives[layout.inertial :])


def _extra_widths(extra: Extra, wide: Array, speed: Array, acceleration: Array) -> Array:
    """Spread of each number of an extra: what makes the joint's rms torque."""
    j = extra.joint - 1
    if extra.kind in COUPLED:
        k = extra.touches[1]
        pairs = ((j, k), (k, j))
        sizes = (acceleration, speed, np.ones_like(speed))
        return np.array([wide[on] / size[by] for size in sizes for on, by in pairs])
    if extra.kind == "motor":
        fast = max(speed[k] for k in extra.touches)
        quick = max(acceleration[k] for k in extra.touches)
        return np.asarray(wide[j] / np.array([quick, fast, 1.0]))
    if extra.kind == "reading":
        return np.array([wide[j] / acceleration[j]])
    if extra.kind == "load":
        return np.array([GEAR_LOSS])
    if extra.kind == "zero":
        return np.array([ZERO_OFF])
    if extra.kind == "power":
        return np.array([wide[j] / speed[j] ** EXPONENT])
    return np.full(extra.size, wide[j])
