"""The inertia that scales joint-wise gains, and how fast these may be over all postures.

An arm whose joints all have the law u = K c(s) e, K diagonal and c the same for all, falls apart
into loops of one inertia: those of the eigenvalues of K^-1 M(q). Over the postures these run from
`light` to `heavy`; a loop with margins at both ends has them in between.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import joined

TURNED = 0.9
"""[rad] that the delay may turn the lightest speed loop at its crossover: sensitivity peak 2.5"""
RINGING = 0.22
"""least damping ratio of the heaviest direction: sensitivity peak 2.5"""
POSTURES = 2048
GRID = 24
"""angles of each joint that are tried about the lightest and the heaviest posture of them"""

ALONE = 0.7
"""1: joints do not move each other, 0: all move as one; with 1 the sensitivity peaks of two
seven- and six-axis cobots are half as high again"""
ROUNDS = 20
"""in which joints are slowed"""


def typical_inertia(robot: Robot) -> NDArray[np.float64]:
    """Geometric mean between the extremes of 1 / (M^-1)_jj over the joint box, shape (n,) [kg m2].

    This is what a torque on one axis has to move while the others are free: with the wrist
    stretched, axes 4 and 6 turn against each other and each is a third as heavy as M_jj says. The
    gain error of an axis is then the same factor, up and down, at both ends of its range.

    Raises:
        InputError: in some posture an axis has no inertia, or less than none.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.q_min, robot.q_max, (256, robot.n))
    if robot.n > 4:
        q[0, 4] = 0.0  # the lightest pose of the wrist, which chance may miss
    M = Model(robot).mass_matrix(q)
    least = float(np.linalg.eigvalsh(M).min())
    felt = 1.0 / np.einsum("kjj->kj", np.linalg.inv(M))
    if not felt.min() > 0:
        kinds = list(dict.fromkeys(effect.kind for effect in robot.effects))
        raise InputError(
            f"{robot.name}: found a posture in which some motion has no kinetic energy (least "
            f"eigenvalue of the mass matrix {least:.3g} kg m2), expected some in every posture; "
            "correct the bodies of the links"
            + (f", or the inertias of its effects ({joined(kinds)})" if kinds else "")
        )
    return np.asarray(np.sqrt(felt.min(axis=0) * felt.max(axis=0)))


@dataclass(frozen=True)
class InertiaSpan:
    """What the arm weighs in its lightest and its heaviest direction of all postures.

    Args:
        light: least eigenvalue of K^-1 M [unit of M / K].
        heavy: largest.
        lightest: posture of `light` [rad], shape (n,).
        heaviest: posture of `heavy` [rad], shape (n,).
    """

    light: float
    heavy: float
    lightest: Array
    heaviest: Array


def inertia_span(robot: Robot, scale: Array) -> InertiaSpan:
    """The extreme eigenvalues of K^-1 M(q), K = diag(scale), over the joint box.

    Args:
        robot: the arm.
        scale: K, above zero, shape (n,).
    """
    model = Model(robot)
    root = np.sqrt(scale)
    some = np.random.default_rng(0).uniform(robot.q_min, robot.q_max, (POSTURES, robot.n))

    def ends(q: Array) -> tuple[Array, Array]:
        eigenvalues = np.linalg.eigvalsh(model.mass_matrix(q) / root / root[:, None])
        return np.asarray(eigenvalues[:, 0]), np.asarray(-eigenvalues[:, -1])

    def least(end: int) -> tuple[float, Array]:
        best = some[ends(some)[end].argmin()]
        for j in (*range(robot.n), *range(robot.n)):
            tried = np.tile(best, (GRID + 1, 1))
            tried[1:, j] = np.linspace(robot.q_min[j], robot.q_max[j], GRID)
            best = tried[ends(tried)[end].argmin()]
        return float(ends(best[None])[end][0]), best

    light, lightest = least(0)
    heavy, heaviest = least(1)
    return InertiaSpan(light, -heavy, lightest, heaviest)


def slowed(robot: Robot, scale: Array, most: float) -> Array:
    """K no larger than `scale` with which no eigenvalue of M^-1 K exceeds `most` in any posture,
    shape (n,): a joint is slowed as much as it takes part in the motions that would.

    Args:
        robot: the arm.
        scale: K that is wanted, above zero, shape (n,).
        most: largest eigenvalue [unit of K / M].
    """
    scale = np.array(scale)
    model = Model(robot)
    for _ in range(ROUNDS):
        span = inertia_span(robot, scale)
        excess = span.light * most
        if excess >= 1:
            return scale
        root = np.sqrt(scale)
        mass = model.mass_matrix(span.lightest[None])[0] / root / root[:, None]
        share = np.linalg.eigh(mass)[1][:, 0] ** 2
        scale *= (0.99 * excess) ** (share / share.max())
    return scale * min(1.0, inertia_span(robot, scale).light * most)


def heaviest(robot: Robot, scale: Array) -> Array:
    """What each joint has to carry in the heaviest posture, in units of its scale, shape (n,).

    The joint whose own inertia spans most bears the heaviest direction of all; the others less, by
    how much less theirs spans, to the power `ALONE`.

    Args:
        robot: the arm.
        scale: K of `inertia_span`, shape (n,).
    """
    own = largest_inertia(robot) / scale
    return np.asarray(inertia_span(robot, scale).heavy * (own / own.max()) ** ALONE)


def largest_inertia(robot: Robot) -> Array:
    """M_jj of each joint, largest over postures [kg m2], shape (n,)."""
    q = np.random.default_rng(0).uniform(robot.q_min, robot.q_max, (POSTURES, robot.n))
    return np.asarray(np.einsum("kjj->kj", Model(robot).mass_matrix(q)).max(axis=0))


def fastest_crossover(sample_time: float) -> float:
    """Crossover of a speed loop [rad/s] at which the drive of `Timing` leaves margins: its delay,
    half a sample each of hold and difference, and the lag of its speed filter turn it by `TURNED`.
    """
    timing = Timing(sample_time)
    share = timing.filter_share
    return TURNED / (sample_time * (timing.delay_samples + 1 + (1 - share) / share))
