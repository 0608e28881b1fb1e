"""How well a robot's nominal model explains rows of a log, once all that may differ is let differ.

    tau_j = tau_nominal_j + Y_j delta + Fc_j turn_j + Fv_j qd_j + J_j qdd_j + o_j + e_j

delta are inertial numbers off by what files are off by, and a payload that the arm may carry;
friction and rotors are never negative. e_j has a fifth of the torque's own size, or what an
identification of the arm has left: effects, drives and crude models are not to look like a wrong
column. A reading of the log is judged by its evidence.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.bounded import bounded_minimum
from irb2400_ctrl.effects.balancer import Balancer
from irb2400_ctrl.effects.rotor_inertia import RotorInertia
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility.rows import Rows
from irb2400_ctrl.robot import Robot

MASS = 0.15
"""relative standard deviation of a link's mass, and of its first moment over the lever"""
INERTIA = 0.3
"""relative standard deviation of a link's inertia"""
LEVER = 0.15
"""lever of first moments over the arm's reach"""
PAYLOAD = 0.12
"""standard deviation of the payload over the mass that the arm moves"""
FRICTION = 0.7
"""relative standard deviation of a file's friction"""
UNKNOWN_FRICTION = 0.3
"""standard deviation over the torque's size where the file gives no friction"""
ROTOR = 0.3
"""relative standard deviation of a file's rotor inertia"""
UNKNOWN_ROTOR = 0.15
"""standard deviation over the torque's size where the file gives no rotor: of a quick wrist it is
most of the torque, and no URDF has it"""
NO_ROTOR = 1e-9
"""the same where it has none"""
OFFSET = 0.05
"""standard deviation of a constant offset over the torque's size"""
MISFIT = 0.2
"""standard deviation of what the model does not know over the torque's size"""
PER_SECOND = 1.0
"""independent rows per second of motion"""
MOST_ROWS = 30.0
"""independent rows at most: more of the same motion tells nothing new"""
ANYTHING = 1e6
"""the same of a joint that is not asked"""
MISFITS = (MISFIT, 0.1, 0.05, 0.025)
"""misfits among which `sharp_cost` takes the one that a log supports"""
ABSURD = 1e4
"""a model's torque over the recorded one above which a reading is not worth a solution"""
STILL = 0.1
"""largest weight of an instant at which the direction of a joint's dry friction is not known"""


@dataclass(frozen=True)
class Fit:
    """How well one reading of a log is explained.

    Args:
        cost: minus twice the logarithm of the evidence, up to a constant.
        price: what is left and what had to be changed for it, in the same units, without the
            price of what could have been changed.
        left: rms of what is left over rms of the torque (and of what dry friction may hold at
            rest), per joint, shape (n,).
    """

    cost: float
    price: float
    left: Array


@dataclass(frozen=True)
class Account:
    """A fit and what came of columns that were fitted beside the robot's numbers.

    Args:
        fit: of all rows.
        rest: what is left, weighted, shape (m, n).
        weight: of each torque, shape (m, n) [1/Nm].
        numbers: that the columns are multiplied by, shape (k,).
    """

    fit: Fit
    rest: Array
    weight: Array
    numbers: Array


@dataclass(eq=False)
class Nominal:
    """A robot's model as a yardstick for logs.

    Args:
        robot: as its file has it.
        built: model of the same arm with whatever friction, where there is one already.
        free_rotors: whether joints may have some that the file does not state.
        unbalanced: model of the same arm without its balancers, where these may have any strength.
    """

    robot: Robot
    built: Model | None = None
    free_rotors: bool = False
    unbalanced: Model | None = None

    @cached_property
    def model(self) -> Model:
        """Of the robot, built once."""
        return Model(self.robot) if self.built is None else self.built

    def with_unknown_friction(self, of: Collection[int]) -> Nominal:
        """The same of an arm of which nothing is known of the friction of these joints (from 1)."""
        return replace(self, robot=self.robot.with_unknown_friction(of), built=self.model)

    def with_unknown_rotors(self) -> Nominal:
        """The same of an arm whose rotors nobody has stated."""
        return replace(self, built=self.model, free_rotors=True)

    def with_free_balancers(self) -> Nominal:
        """The same of an arm whose balancers may have lost strength, or have more than stated."""
        others = tuple(e for e in self.robot.effects if not isinstance(e, Balancer))
        without = Model(self.robot.model_copy(update={"effects": others}))
        return replace(self, built=self.model, unbalanced=without)

    @property
    def balanced(self) -> list[int]:
        """Joints (from 0) with a balancer."""
        return sorted({e.index for e in self.robot.effects if isinstance(e, Balancer)})

    @cached_property
    def spreads(self) -> Array:
        """Standard deviations of phi of all links, payload in the last, shape (10 n,)."""
        masses = [link.body.mass_kg for link in self.robot.links]
        tool = 0.0 if self.robot.tool is None else self.robot.tool.body.mass_kg
        lever = LEVER * self.robot.reach
        found = np.zeros((len(masses), 10))
        for row, (mass, link) in enumerate(zip(masses, self.robot.links, strict=True)):
            com = np.array(link.body.com_m)
            about = abs(np.trace(link.body.tensor()) / 3.0 + mass * (com @ com))
            found[row] = _spread(MASS * mass, lever, INERTIA * about)
        load = PAYLOAD * (sum(masses[1:]) + tool)
        found[-1] = np.hypot(found[-1], _spread(load, lever, load * lever**2))
        return found.ravel()

    @cached_property
    def least(self) -> Array:
        """Lower bounds of delta in its spreads: no mass below zero, shape (10 n,); and of the
        balancers' strength, where that is free: none turns over."""
        bounds = np.full((self.robot.n, 10), -np.inf)
        masses = np.maximum(self.robot.inertial_parameters[:, 0], 1e-3)
        spreads = self.spreads.reshape(-1, 10)[:, 0]
        np.divide(-masses, spreads, out=bounds[:, 0], where=spreads > 0.0)
        free = 0 if self.unbalanced is None else len(self.balanced)
        return np.append(bounds.ravel(), np.full(free, -1.0))

    def columns(self, rows: Rows) -> tuple[Array, Array]:
        """Nominal torque without friction (m, n) and its slopes per standard deviation of delta
        (m, n, 10 n), and per stated strength of each joint's balancers, where that is free."""
        motion = (rows.q, rows.qd, rows.qdd)
        tau = np.asarray(self.model.inverse_dynamics(*motion, friction=False))
        Y = np.asarray(self.model.regressor(*motion)) * self.spreads
        if self.unbalanced is None:
            return tau, Y
        held = tau - np.asarray(self.unbalanced.inverse_dynamics(*motion, friction=False))
        each = held[:, :, None] * np.eye(self.robot.n)[:, self.balanced]
        return tau, np.concatenate([Y, each], axis=2)

    def explained(self, rows: Rows, columns: tuple[Array, Array], misfit: float = MISFIT) -> Fit:
        """The best account of the rows, and its evidence.

        Args:
            columns: of the rows' motion (`columns`).
            misfit: standard deviation of what the model does not know over the torque's size.
        """
        size = rows.size
        if not np.abs(columns[0]).max() < ABSURD * size.max():
            return Fit(np.inf, np.inf, np.ones(len(size)))
        most = self._misfits(rows, misfit)
        found = self._fitted(rows, columns, misfit, most)
        if (most > misfit).any():
            # what was left of the worst log need not be left of this one
            found = self._fitted(rows, columns, misfit, np.clip(found.left, misfit, most))
        return found

    def beside(self, rows: Rows, columns: tuple[Array, Array], joint: int) -> Fit:
        """The account of all joints but one, whose torque may be anything.

        Args:
            rows, columns: as of `explained`.
            joint: that one, from 0.
        """
        most = self._misfits(rows)
        most[joint] = ANYTHING
        return self._fitted(rows, columns, MISFIT, most)

    def account(self, rows: Rows, columns: tuple[Array, Array], beside: Array) -> Account:
        """The best account with further columns.

        Args:
            rows, columns: as of `explained`.
            beside: torque per standard deviation of what they stand for, shape (m, n, k) [Nm].
        """
        most = self._misfits(rows)
        return self._accounted(rows, columns, MISFIT, most, beside)

    def _misfits(self, rows: Rows, misfit: float = MISFIT) -> Array:
        """Standard deviations of what the model does not know of each joint, over its torque's
        size, or of what an identification has left, (n,)."""
        return np.maximum(misfit, self.robot.usually_left / rows.size)

    def _fitted(self, rows: Rows, columns: tuple[Array, Array], misfit: float, own: Array) -> Fit:
        """The account beside a misfit of each joint, as of `_accounted`."""
        none = np.zeros((*rows.tau.shape, 0))
        return self._accounted(rows, columns, misfit, own, none).fit

    def _accounted(
        self,
        rows: Rows,
        columns: tuple[Array, Array],
        misfit: float,
        own: Array,
        beside: Array,
    ) -> Account:
        """The account beside a misfit of each joint."""
        m, n = rows.tau.shape
        k = columns[1].shape[2]
        known = k + 4 * n
        X, y, weight = self.weighted(rows, columns, own)
        if beside.shape[2]:
            X = np.concatenate([X, beside * weight[:, :, None]], axis=2)
        X = X.reshape(m * n, -1)
        A = X.T @ X + np.eye(X.shape[1])
        dry, viscous = self.robot.friction[:, 1:3].T
        none_negative = -np.concatenate([dry, viscous, self.rotors]) / (
            self._drive_spreads(rows)[:3].ravel()
        )
        least = np.concatenate(
            [self.least, none_negative, np.full(X.shape[1] - k - 3 * n, -np.inf)]
        )
        z = bounded_minimum(A, X.T @ y.ravel(), least)
        rest = (y.ravel() - X @ z).reshape(m, n)
        price = float(np.sum(rest**2) + z @ z)
        carried = rows.tau**2 + np.where(rows.still, dry**2, 0.0)
        whole = np.sum(carried * weight**2, axis=0)
        # of a joint without torque nothing can be left
        left = np.sqrt(np.sum(rest**2, axis=0) / np.where(whole > 0, whole, np.inf))
        vague = 2.0 * independent(rows) * float(np.sum(np.log(own / misfit)))
        fit = Fit(price + float(np.linalg.slogdet(A)[1]) + vague, price, left)
        return Account(fit, rest, weight, z[known:])

    def weighted(
        self, rows: Rows, columns: tuple[Array, Array], own: Array
    ) -> tuple[Array, Array, Array]:
        """Slopes of all that may differ, per standard deviation (m, n, 10 n + 4 n), what the
        nominal numbers leave (m, n), both weighted, and the weight (m, n) [1/Nm].

        The weight is one over the misfit where each row tells something of its own.

        Args:
            rows, columns, own: as of `_accounted`.
        """
        nominal, Y = columns
        m, n = rows.tau.shape
        size = rows.size
        weight = np.sqrt(independent(rows) / m) / (own * size)
        dry, viscous = self.robot.friction[:, 1:3].T
        # a joint at rest is held by its dry friction: its torque may be off by so much
        held = np.minimum(STILL, own * size / np.hypot(own * size, dry))
        weight = weight * np.where(rows.still, held, 1.0) * ~rows.silent
        k = Y.shape[2]
        X = np.empty((m, n, k + 4 * n))
        X[:, :, k:] = 0.0
        np.multiply(Y, weight[:, :, None], out=X[:, :, :k])
        # a drive acts on its own joint alone
        joints = np.arange(n)
        signals = (rows.turn, rows.qd, rows.qdd, np.ones_like(rows.qd))
        for part, spreads in enumerate(self._drive_spreads(rows)):
            X[:, joints, k + part * n + joints] = signals[part] * spreads * weight
        y = (rows.tau - nominal - dry * rows.turn - viscous * rows.qd) * weight
        return X, y, weight

    def sharp_cost(
        self, rows: Rows, columns: tuple[Array, Array], misfits: tuple[float, ...] = MISFITS
    ) -> float:
        """The cost with the misfit that the rows support best: minus twice the log evidence.

        min over s of  cost(s) + 2 N n ln(s / MISFIT),  N independent rows of n joints. What is left
        may be far below a fifth of the torque; then a reading that leaves several times more is
        not this log's, though a crude model would allow it.
        """
        count = rows.tau.shape[1] * independent(rows)
        costs = [
            self.explained(rows, columns, s).cost + 2.0 * count * np.log(s / MISFIT)
            for s in misfits
        ]
        return float(min(costs))

    @cached_property
    def rotors(self) -> Array:
        """Rotor inertia that the file states, shape (n,) [kg m2]."""
        found = np.zeros(self.robot.n)
        for effect in self.robot.effects:
            if isinstance(effect, RotorInertia):
                found[effect.index] += effect.inertia_kgm2
        return found

    def _drive_spreads(self, rows: Rows) -> Array:
        """Standard deviations of Coulomb, viscous friction, rotor and offset, shape (4, n)."""
        dry, viscous = self.robot.friction[:, 1:3].T
        rotors = self.rotors
        size = rows.size
        speed = np.sqrt(np.mean(rows.qd**2, axis=0)) + 1e-6
        push = np.sqrt(np.mean(rows.qdd**2, axis=0)) + 1e-6
        unknown = UNKNOWN_FRICTION * size
        inertia = (UNKNOWN_ROTOR if self.free_rotors else NO_ROTOR) * size / push
        return np.vstack(
            [
                np.where(dry > 0, FRICTION * dry, unknown),
                np.where(viscous > 0, FRICTION * viscous, unknown / speed),
                np.where(rotors > 0, ROTOR * rotors, inertia),
                OFFSET * size,
            ]
        )


def independent(rows: Rows) -> float:
    """Rows that each tell something."""
    return min(PER_SECOND * rows.seconds, MOST_ROWS)


def _spread(mass: float, lever: float, inertia: float) -> Array:
    """Standard deviations of (m, mc, I) of a body."""
    return np.array([mass, *[mass * lever] * 3, *[inertia + 1e-6] * 6])
