"""The inertia that scales joint-wise gains, how fast these may be and how stiff they have to be
over all postures.

An arm whose joints all have the law u = K c(s) e, K diagonal and c the same for all, falls apart
into loops of one inertia: those of the eigenvalues of K^-1 M(q). Over the postures these run from
`light` to `heavy`; a loop with margins at both ends has them in between.

Where an arm stands above its axes, its weight pulls an error further away: dG/dq has negative
eigenvalues there, and a position loop of the stiffness D holds only as long as D + dG/dq is
positive. The share that the weight takes away is the largest eigenvalue of -D^-1 dG/dq. Past the
integral the sensitivity stands at share / (1 - share).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.elasticity import rigid
from irb2400_ctrl.model.numeric import evaluate
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import joined

TURNED = 0.9
"""[rad] that the delay may turn the lightest speed loop at its crossover: sensitivity peak 2.5"""
RINGING = 0.22
"""least damping ratio of the heaviest direction: sensitivity peak 2.5"""
FADING = 4 * RINGING**2
"""least Ti of a joint that its viscous friction holds back more than its inertia, in units of what
brakes it (friction and speed gain) over what pulls it back (position gain)"""
POSTURES = 2048
GRID = 24
"""angles of each joint that are tried about the extreme posture of them"""

ALONE = 0.7
"""1: joints do not move each other, 0: all move as one; with 1 the sensitivity peaks of two
seven- and six-axis cobots are half as high again"""
ROUNDS = 20
"""in which joints are slowed, or stiffened"""

CARRIED = 0.5
"""largest share of its stiffness that a position loop loses to a weight it does not cancel"""
CANCELLED = 1.0
"""the same where the weight is cancelled. Of one inertia m with the speed gain kv above its axis,
weight -g, the sensitivity peaks least with these: by 2 sqrt(m g) / kv, of which only kv is left to
be raised"""


def _arm(robot: Robot) -> Model:
    """As a controller takes it."""
    return Model(rigid(robot))


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
    M = _arm(robot).mass_matrix(q)
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
    model = _arm(robot)
    root = np.sqrt(scale)
    some = drawn(robot)

    def least(q: Array) -> Array:
        scaled = model.mass_matrix(q) / root / root[:, None]
        return np.asarray(np.linalg.eigvalsh(scaled)[:, 0])

    def most(q: Array) -> Array:
        scaled = model.mass_matrix(q) / root / root[:, None]
        return np.asarray(-np.linalg.eigvalsh(scaled)[:, -1])

    lightest = refined(robot, least, some)
    heaviest = refined(robot, most, some)
    return InertiaSpan(
        float(least(lightest[None])[0]), -float(most(heaviest[None])[0]), lightest, heaviest
    )


def drawn(robot: Robot) -> Array:
    """Postures all over the joint box [rad], shape (k, n)."""
    return np.random.default_rng(0).uniform(robot.q_min, robot.q_max, (POSTURES, robot.n))


def refined(robot: Robot, value: Callable[[Array], Array], some: Array) -> Array:
    """The posture [rad] of the least value, searched joint by joint from the best of some.

    Args:
        robot: the arm.
        value: of each posture (k, n) [rad], shape (k,).
        some: postures [rad], shape (k, n).
    """
    best = some[value(some).argmin()]
    for j in (*range(robot.n), *range(robot.n)):
        tried = np.tile(best, (GRID + 1, 1))
        tried[1:, j] = np.linspace(robot.q_min[j], robot.q_max[j], GRID)
        best = tried[value(tried).argmin()]
    return np.asarray(best)


def slowed(robot: Robot, scale: Array, most: float) -> Array:
    """K no larger than `scale` with which no eigenvalue of M^-1 K exceeds `most` in any posture,
    shape (n,): a joint is slowed as much as it takes part in the motions that would.

    Args:
        robot: the arm.
        scale: K that is wanted, above zero, shape (n,).
        most: largest eigenvalue [unit of K / M].
    """
    scale = np.array(scale)
    model = _arm(robot)
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
    return np.asarray(np.einsum("kjj->kj", _arm(robot).mass_matrix(drawn(robot))).max(axis=0))


def fastest_crossover(sample_time: float) -> float:
    """Crossover of a speed loop [rad/s] at which the drive of `Timing` leaves margins: its delay,
    half a sample each of hold and difference, and the lag of its speed filter turn it by `TURNED`.
    """
    timing = Timing(sample_time)
    share = timing.filter_share
    return TURNED / (sample_time * (timing.delay_samples + 1 + (1 - share) / share))


def weight_slope(robot: Robot, q: Array) -> Array:
    """dG/dq at each posture, effects at rest included, shape (k, n, n) [Nm/rad].

    Args:
        robot: the arm, as it is mounted.
        q: postures [rad], shape (k, n).
    """
    found: Array = evaluate(_weight_slope(robot), q, matrix=True)
    return (found + found.transpose(0, 2, 1)) / 2


@lru_cache(maxsize=16)
def _weight_slope(robot: Robot) -> ca.Function:
    """q -> dG/dq; the search for a posture asks for it hundreds of times."""
    angles = ca.SX.sym("q", robot.n)
    weight = _arm(robot).function("gravity")(angles)
    return ca.Function("slope", [angles], [ca.densify(ca.jacobian(weight, angles))])


def weight_share(robot: Robot, stiffness: Array) -> tuple[float, Array]:
    """What the weight takes away of a stiffness at most, below zero where it only adds, and the
    posture of that [rad].

    Args:
        robot: the arm, as it is mounted.
        stiffness: D of each joint, above zero, shape (n,) [Nm/rad].
    """
    root = np.sqrt(stiffness)

    def left(q: Array) -> Array:
        return np.asarray(np.linalg.eigvalsh(weight_slope(robot, q) / root / root[:, None])[:, 0])

    worst = refined(robot, left, drawn(robot))
    return -float(left(worst[None])[0]), worst


def stiffened(robot: Robot, stiffness: Array, most: float) -> Array:
    """D no smaller than `stiffness` of which the weight takes at most a share in any posture,
    shape (n,) [Nm/rad]: a joint gets more as much as it takes part in the motions that lose most.

    Args:
        robot: the arm, as it is mounted.
        stiffness: D that is wanted, above zero, shape (n,) [Nm/rad].
        most: that share.
    """
    stiffness = np.array(stiffness)
    for _ in range(ROUNDS):
        share, worst = weight_share(robot, stiffness)
        if share <= most:
            return stiffness
        root = np.sqrt(stiffness)
        slope = weight_slope(robot, worst[None])[0] / root / root[:, None]
        part = np.linalg.eigh(slope)[1][:, 0] ** 2
        stiffness *= (1.01 * share / most) ** (part / part.max())
    return stiffness * max(1.0, weight_share(robot, stiffness)[0] / most)
