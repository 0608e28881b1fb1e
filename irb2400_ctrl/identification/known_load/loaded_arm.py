"""What a load that was weighed adds to the torques of an arm that is known without it.

With y the torque of loaded logs less that of the unloaded arm, Y the regressor of a body on the
last link and phi the load's parameters, on joint j

    y_j = gain_j Y_j phi(m, c, J) + b0 + b1 sgn qd + b2 qd + day_j tau_without,j.

b are what friction and offset of that day changed, `day` what the channel reads more than on the
unloaded day. The mass is as weighed. The inertia J about the load's centre is as stated; one that
is not is about that of a body as wide as its centre is far from the flange, give or take as much.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.fitting.noise import correlation_factor
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body

GYRATION = 0.06
"""[m] radius of gyration of a load whose centre is at the flange"""
WEIGHED = 0.001
"""[m] to which the centre of a load is known that somebody weighed"""
HELD = 1e-9
"""spread of what is not let go"""
OPEN = 10.0
"""spread of a gain, and of friction over the torque, before the logs"""
ROUNDS = 5
BLOCKS = 30
"""of time, from whose disagreement errors are told"""
SAMPLES = 4000
"""of a log that are looked at"""
DIAGONAL = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 1.0])
"""which of Jxx, Jxy, Jxz, Jyy, Jyz, Jzz stand on the diagonal"""


@dataclass(frozen=True)
class LoadFit:
    """Numbers of a loaded arm.

    Args:
        gains, gain_errors: of the channels, (n,); day, day_errors: what they read more than on the
            unloaded day, (n,).
        shift: of the load's centre from the stated one, (3,) [m]; shift_covariance: (3, 3) [m2].
        left: of the measured torque, rms of each joint, (n,) [Nm].
    """

    gains: Array
    gain_errors: Array
    day: Array
    day_errors: Array
    shift: Array
    shift_covariance: Array
    left: Array


@dataclass(frozen=True)
class LoadedArm:
    """Loaded logs beside the arm without the load; m rows of all logs.

    What the unloaded logs leave open of a joint's own numbers is a column of it, too, integrated
    out: a joint that they tell little of tells little of the load.

    Args:
        Y: regressor of a body on the last link, (m, n, 10); drives: 1, sgn qd, qd, (m, n, 3);
        without: torque of the unloaded arm, (m, n) [Nm]; y: what is measured beyond it;
        known: rows that count, (m, n); load: as stated; flange: its pose on the last link, (4, 4);
        opened: torque of a joint per standard deviation of what is open of its numbers, of each
            joint (m, ·).
    """

    Y: Array
    drives: Array
    without: Array
    y: Array
    known: Mask
    load: Body
    flange: Array
    opened: Sequence[Array]

    @property
    def usual(self) -> float:
        """Inertia of a load that states none, about any axis through its centre [kg m2]:
        m (0.06^2 + c^2 / 3), as of a rod from the flange through its centre and as far beyond."""
        body = self.load
        if any(body.inertia_kgm2):
            return 0.0
        centre = np.array(body.com_m)
        return float(body.mass_kg * (GYRATION**2 + centre @ centre / 3.0))

    def fitted(self, centre: float = WEIGHED, day: float = HELD) -> LoadFit:
        """Gauss-Newton, each joint weighed by what is left of it.

        Args:
            centre: spread of the load's centre from the stated one, before the logs [m].
            day: spread of what a channel reads otherwise on the loaded day [-].
        """
        n = self.y.shape[1]
        mean = np.zeros(5 * n + 9)
        mean[:n] = 1.0
        precision = self._spread(centre, day) ** -2.0
        x = mean
        weight = np.zeros(n)
        for _ in range(ROUNDS):
            X, left = self._linear(x)
            weight = self._weights(self._beside(left, weight))
            told = self._beside(X, weight)
            A = np.einsum("n,mnp,mnq->pq", weight, X, told, optimize=True) + np.diag(precision)
            inverse = scaled_inverse(A)
            b = np.einsum("n,mnp,mn->p", weight, told, left, optimize=True)
            x = x + inverse @ (b - precision * (x - mean))
        X, left = self._linear(x)
        rest = self._beside(left, weight)
        middle = np.diag(precision) + self._disagreement(self._beside(X, weight), rest, weight)
        covariance = inverse @ middle @ inverse
        errors = np.sqrt(np.diag(covariance))
        moved = slice(4 * n + 6, 4 * n + 9)
        count = np.maximum(self.known.sum(axis=0), 1)
        return LoadFit(
            gains=x[:n],
            gain_errors=errors[:n],
            day=x[moved.stop :],
            day_errors=errors[moved.stop :],
            shift=x[moved],
            shift_covariance=covariance[moved, moved],
            left=np.sqrt((rest**2).sum(axis=0) / count),
        )

    def torque(self, shift: Array, inertia: Array) -> Array:
        """Of the load, (m, n) [Nm], its centre moved by `shift` (3,) [m], with an inertia beyond
        the stated one, (6,) [kg m2], in the flange's axes."""
        body = self.load
        centre = np.array(body.com_m) + shift
        xx, xy, xz, yy, yz, zz = inertia
        more = np.array(body.inertia_kgm2) + np.array([xx, yy, zz, xy, xz, yz])
        changed = {"com_m": tuple(centre), "inertia_kgm2": tuple(more)}
        return np.asarray(self.Y @ body.model_copy(update=changed).parameters(self.flange))

    def _spread(self, centre: float, day: float) -> Array:
        """Standard deviations of the unknowns before the logs: gains, friction and offsets, inertia
        over the usual one, centre, readings of the day.

        Args:
            centre, day: as of `fitted`.
        """
        n = self.y.shape[1]
        size = np.maximum(np.abs(self.y).max(axis=0), 1e-6)
        inertia = np.where(DIAGONAL > 0.0, 1.0, 0.5) if self.usual else np.full(6, HELD)
        parts = (
            np.full(n, OPEN),
            np.repeat(OPEN * size, 3),
            inertia,
            np.full(3, centre),
            np.full(n, day),
        )
        return np.concatenate(parts)

    def _linear(self, x: Array) -> tuple[Array, Array]:
        """(d y / d x, (m, n, p); what is left at x, (m, n)), zero where nothing is known."""
        n = self.y.shape[1]
        gains, drives, inertia, shift, day = np.split(x, [n, 4 * n, 4 * n + 6, 4 * n + 9])
        size = max(self.usual, HELD)
        own = self.usual * DIAGONAL + size * inertia
        torque = self.torque(shift, own)
        X = np.zeros((*self.y.shape, len(x)))
        for j in range(n):
            X[:, j, j] = torque[:, j]
            X[:, j, n + 3 * j : n + 3 * j + 3] = self.drives[:, j]
            X[:, j, 4 * n + 9 + j] = self.without[:, j]
        for k, step in enumerate(size * np.eye(6)):
            X[:, :, 4 * n + k] = gains * (self.torque(shift, own + step) - torque)
        for k, step in enumerate(1e-3 * np.eye(3)):
            sides = [self.torque(shift + way * step, own) for way in (1.0, -1.0)]
            X[:, :, 4 * n + 6 + k] = gains * (sides[0] - sides[1]) / 2e-3
        modelled = gains * torque + day * self.without
        modelled += np.einsum("mnk,nk->mn", self.drives, drives.reshape(n, 3))
        left = np.where(self.known, self.y - modelled, 0.0)
        return np.where(self.known[:, :, None], X, 0.0), left

    def _weights(self, left: Array) -> Array:
        """Of each joint, 1 / (sigma^2 samples per independent one), (n,)."""
        count = self.known.sum(axis=0)
        variance = np.maximum((left**2).sum(axis=0) / np.maximum(count, 1), 1e-12)
        like = correlation_factor(left, self.known)
        return np.where(count > 0, 1.0 / (variance * like), 0.0)

    def _beside(self, signal: Array, weight: Array) -> Array:
        """What is left of signals of the joints beside their own numbers, as far as these are open,
        shape (m, n, ...).

        Args:
            signal: zero where nothing is known; weight: of the joints, (n,).
        """
        found = signal.copy()
        for j, opened in enumerate(self.opened):
            inner = np.eye(opened.shape[1]) + weight[j] * opened.T @ opened
            found[:, j] -= opened @ np.linalg.solve(inner, weight[j] * opened.T @ signal[:, j])
        return found

    def _disagreement(self, told: Array, rest: Array, weight: Array) -> Array:
        """Covariance of the slopes of the sum of squares: how blocks of time disagree, and what the
        unloaded arm leaves open.

        Args:
            told, rest: columns and residual beside the joints' own numbers, (m, n, p), (m, n);
            weight: of the joints, (n,).
        """
        blocks = np.array_split(np.arange(len(rest)), BLOCKS)
        scores = np.array([np.einsum("mnp,mn,n->p", told[b], rest[b], weight) for b in blocks])
        found = scores.T @ scores * BLOCKS / (BLOCKS - 1)
        for j, opened in enumerate(self.opened):
            slope = weight[j] * told[:, j].T @ opened
            found += slope @ slope.T
        return np.asarray(found)


def loaded_arm(
    model: Model,
    layout: ColumnLayout,
    parts: Sequence[Recording],
    alone: Sequence[tuple[Array, Array]],
    load: Body,
) -> LoadedArm:
    """Loaded logs held against the unloaded arm.

    Args:
        model: of the arm; layout: of its numbers; parts: the loaded logs.
        alone: of each joint, the numbers of the unloaded arm as it reads them, their covariance.
        load: mass, centre and inertia in the axes of the flange.
    """
    pieces = [_piece(model, layout, part, alone, load) for part in parts]
    opened = [np.concatenate(some) for some in zip(*(p.opened for p in pieces), strict=True)]
    return LoadedArm(
        Y=np.concatenate([piece.Y for piece in pieces]),
        drives=np.concatenate([piece.drives for piece in pieces]),
        without=np.concatenate([piece.without for piece in pieces]),
        y=np.concatenate([piece.y for piece in pieces]),
        known=np.concatenate([piece.known for piece in pieces]),
        load=load,
        flange=pieces[0].flange,
        opened=opened,
    )


def _piece(
    model: Model,
    layout: ColumnLayout,
    part: Recording,
    alone: Sequence[tuple[Array, Array]],
    load: Body,
) -> LoadedArm:
    """One log, thinned.

    Args:
        model, layout, alone, load: as of `loaded_arm`; part: the log.
    """
    m = part.motion
    every = slice(None, None, -(-len(m.time) // SAMPLES))
    joints = range(model.robot.n)
    known = m.known[every]
    predictions = [predicted(model, layout, part, alone[j][0])[every, j] for j in joints]
    without = np.column_stack(predictions)
    rows = columns(model, layout, m.q[every], m.qd[every], m.qdd[every])
    drives = np.stack([np.ones_like(m.qd), np.sign(m.qd), m.qd], axis=2)
    return LoadedArm(
        Y=m.as_recorded(model.regressor(m.q, m.qd, m.qdd)[:, :, -10:])[every],
        drives=m.as_recorded(drives)[every],
        without=without,
        y=m.tau[every] - without,
        known=known,
        load=load,
        flange=model.robot.flange.matrix(),
        opened=[np.where(known[:, [j]], rows[:, j] @ _root(alone[j][1]), 0.0) for j in joints],
    )


def _root(covariance: Array) -> Array:
    """R with R R^T = covariance, (p, p)."""
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    values, vectors = np.linalg.eigh(covariance / size[:, None] / size)
    return np.asarray(size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
