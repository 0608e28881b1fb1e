"""What the model already has but does not know exactly: inertial parameters and friction, with
data-sheet uncertainty.

Each uncertain number p = p0 + sigma z has a standard normal z; its column is d tau / d z. One
standard deviation is what the robot file states under `[uncertainty]`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, rms
from irb2400_ctrl.diagnosis.preparation.turned_motors import TurnedMotors
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.base_parameters import with_masses
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Body, Robot, Uncertainty

USUAL_FRICTION = 0.15
"""dry friction of a joint over its rms torque: with three times as much for what turns over at its
reversals the search of a UR10 took 42 looks in place of 15, for the same names"""
UNKNOWN_FRICTION = 0.5
LEAST_MASS = 0.1
"""of a link over the file's, below which all links keep the file's masses [-]"""
BODY = ("mass_kg", "com_x_m", "com_y_m", "com_z_m", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""the numbers of a body, in the file's order"""


def named_bodies(robot: Robot) -> list[tuple[Body, str]]:
    """Bodies of the links, then the tool's, with the names that `[uncertainty]` gives them."""
    found = [(link.body, link.name) for link in robot.links]
    return found if robot.tool is None else [*found, (robot.tool.body, "tool")]


def body_numbers(body: Body) -> Array:
    """Mass [kg], centre [m] and inertia about it [kg m2], as BODY, shape (10,)."""
    return np.array([body.mass_kg, *body.com_m, *body.inertia_kgm2])


def body_spread(uncertainty: Uncertainty, body: Body, name: str) -> Array:
    """Standard deviations of the numbers of a body, as BODY, shape (10,).

    Args:
        uncertainty: of the robot file.
        body: mass, centre, inertia.
        name: of the link, or `tool`.
    """
    mass, shift, relative = uncertainty.of_body(name)
    inertia = np.array(body.inertia_kgm2)
    # an element printed as zero is not known to be zero: one per cent of the mean principal
    # moment at least
    least = 0.2 * relative * np.abs(inertia[:3]).mean()
    com = shift if body.mass_kg else 0.0
    return np.concatenate(
        [[mass * body.mass_kg], np.full(3, com), np.hypot(relative * inertia, least)]
    )


@dataclass(frozen=True)
class BasePrior:
    """Uncertain numbers of a robot file and how to write new ones back.

    Columns: 10 per link (mass, CoM, inertia), 10 for the tool, then n Coulomb, n viscous, n static.
    """

    robot: Robot
    uncertainty: Uncertainty
    torque_scale: Array
    """rms torque of each joint [Nm]: a friction that the file does not state, or gives as zero, is
    unknown, up to half of this"""
    speed_scale: Array
    """rms speed of each joint [rad/s]"""
    common_friction: float = 0.0
    """standard deviation of a factor on the dry friction of all joints, and of one on their viscous
    friction: a cold arm is stiffer everywhere"""

    @classmethod
    def of(cls, robot: Robot, uncertainty: Uncertainty, motion: PreparedLog) -> BasePrior:
        """For the log of a motion."""
        return cls(robot, uncertainty, rms(motion.tau), np.maximum(rms(motion.qd), 1e-3))

    @property
    def base(self) -> BasePrior:
        """Itself: what holds the columns and units of bodies and friction, as of any prior."""
        return self

    @property
    def bodies(self) -> list[Body]:
        """Of the links, then the tool's."""
        return [body for body, _ in named_bodies(self.robot)]

    def sigmas(self) -> Array:
        """Standard deviations in file units, shape (k,)."""
        return self._sigmas.copy()

    @cached_property
    def _sigmas(self) -> Array:
        u = self.uncertainty
        friction = np.where(self.robot.friction_known, self.robot.friction, 0.0)
        inertial = [
            body_spread(self.uncertainty, body, name) for body, name in named_bodies(self.robot)
        ]
        unknown = UNKNOWN_FRICTION * self.torque_scale
        dry = [
            np.where(friction[:, 1] > 0, u.friction_relative * friction[:, 1], unknown),
            np.where(
                friction[:, 2] > 0, u.friction_relative * friction[:, 2], unknown / self.speed_scale
            ),
            np.where(friction[:, 0] > 0, u.static_relative * friction[:, 0], unknown),
        ]
        return np.concatenate([*inertial, *dry])

    def dry_friction(self) -> Array:
        """Coulomb friction of each joint, as much as is usual where the file does not say it, shape
        (n,) [Nm]."""
        known = self.robot.friction_stated[:, 1]
        return np.where(known, self.robot.friction[:, 1], USUAL_FRICTION * self.torque_scale)

    @cached_property
    def root(self) -> Array:
        """F with F z the numbers in data-sheet standard deviations, shape (k, k): F F^T is their
        prior covariance."""
        F = np.eye(len(self._sigmas))
        for place, t in self._levels:
            covariance = np.eye(len(place)) + np.outer(t, t)
            F[np.ix_(place, place)] = np.linalg.cholesky(covariance)
        return F

    @cached_property
    def _levels(self) -> list[tuple[Integers, Array]]:
        """Places of the numbers that change with the friction of all joints, and by how many of
        their standard deviations: dry and static friction, viscous friction by a factor of its
        own."""
        sigmas = self._sigmas
        n = self.robot.n
        known = np.where(self.robot.friction_known, self.robot.friction, 0.0)
        found = []
        # as the base has them: Coulomb, viscous, static
        for kinds in ({0: 1, 2: 0}, {1: 2}):
            place = np.concatenate([len(sigmas) + np.arange(n) + n * (k - 3) for k in kinds])
            values = np.concatenate([known[:, column] for column in kinds.values()])
            found.append((place, self.common_friction * values / sigmas[place]))
        return found

    def deviations(self, z: Array) -> Array:
        """Fitted z in data-sheet standard deviations from the file's values, shape (k,)."""
        return np.asarray(self.root @ z)

    def together(self, deviations: Array) -> Array:
        """Part of each deviation that is a friction of all joints at another level, shape (k,).

        Of d = own + c t the level c is the weighted median, of the least sum |own|: a joint whose
        friction is another does not move it, where it would the mean.
        """
        found = np.zeros(len(deviations))
        for place, t in self._levels:
            known = t > 0.0
            if known.any():
                found[place] = t * _median(deviations[place][known] / t[known], t[known])
        return found

    def columns(self, model: Model, motion: PreparedLog) -> Array:
        """d tau / d z along the motion, shape (m, n, k) [Nm]."""
        columns = self.number_columns(model, motion)
        if self.common_friction:
            # of the numbers only those of friction change together
            friction = slice(-3 * self.robot.n, None)
            columns[:, :, friction] = columns[:, :, friction] @ self.root[friction, friction]
        return columns

    def number_columns(self, model: Model, motion: PreparedLog) -> Array:
        """d tau per data-sheet standard deviation of each number, shape (m, n, k) [Nm]."""
        n = self.robot.n
        Y: Any = model.regressor(motion.q, motion.qd, motion.qdd)
        slopes = self._body_slopes
        columns = np.zeros((*Y.shape[:2], 10 * len(slopes) + 3 * n))
        # all samples and joints below one another: one product for each body
        rows = Y.reshape(-1, 10 * n)
        flat = columns.reshape(-1, columns.shape[2])
        for i, slope in enumerate(slopes):
            link = 10 * min(i, n - 1)
            flat[:, 10 * i : 10 * i + 10] = rows[:, link : link + 10] @ slope
        joints = np.arange(n)
        for kind, (signal, size) in enumerate(
            zip(
                FrictionLaw.of(self.robot).regressor(motion.qd),
                self.sigmas()[-3 * n :].reshape(3, n),
                strict=True,
            )
        ):
            columns[:, joints, 10 * len(slopes) + kind * n + joints] = signal * size
        friction = columns[:, :, -3 * n :]
        for kind, j, torque in self._motors.columns(motion.qd):
            friction[:, :, kind * n + j] += torque * self.sigmas()[(kind - 3) * n + j]
        return columns

    @cached_property
    def _motors(self) -> TurnedMotors:
        return TurnedMotors.of(self.robot)

    @cached_property
    def _body_slopes(self) -> list[Array]:
        """d phi per data-sheet standard deviation of each number of a body, (10, 10) each."""
        n = self.robot.n
        flange = self.robot.flange.matrix()
        return [
            parameter_slope(body, None if i < n else flange)
            * body_spread(self.uncertainty, body, name)
            for i, (body, name) in enumerate(named_bodies(self.robot))
        ]

    def held(self, deviations: Array) -> Array:
        """Deviations that a robot's file can hold: no friction below nothing, and at rest no less
        than in motion."""
        n = self.robot.n
        sigmas = self.sigmas()[-3 * n :].reshape(3, n)
        change = sigmas * deviations[-3 * n :].reshape(3, n)
        F_s, F_c, F_v, _ = self.robot.friction.T
        coulomb = np.maximum(change[0], -F_c)
        viscous = np.maximum(change[1], -F_v)
        static = np.maximum(change[2], F_c + coulomb - F_s)
        found = deviations.copy()
        found[-3 * n :] = np.ravel([coulomb, viscous, static] / np.maximum(sigmas, 1e-12))
        return found

    def lifted(self, deviations: Array, qd: Array) -> Array:
        """Torque by which the numbers in a file differ from `columns` at speeds qd (rows, n), since
        it holds no friction below nothing [Nm]."""
        n = self.robot.n
        change = (self.sigmas() * (self.held(deviations) - deviations))[-3 * n :].reshape(3, n)
        signals = FrictionLaw.of(self.robot).regressor(qd)
        return np.asarray(sum(signal * by for signal, by in zip(signals, change, strict=True)))

    def _changed(self, change: Array) -> list[Body]:
        """The bodies whose torque is what the fit, linear in the changes (bodies, 10), found.

        Mass times centre and inertia about the frame's origin are taken over, not the numbers one
        by one: products of two changes would make another torque of a body that is far off. The
        torque hardly knows which link a mass belongs to: where one would fall to nothing, all links
        keep theirs and the same torque comes from their centres.
        """
        n = self.robot.n
        bodies = self.bodies
        phi = np.array([
            body.parameters() + parameter_slope(body, None) @ by
            for body, by in zip(bodies, change, strict=True)
        ])  # fmt: skip
        masses = np.array([body.mass_kg for body in bodies[:n]])
        if (phi[:n, 0] < LEAST_MASS * masses).any():
            phi[:n] = with_masses(self.robot, phi[:n], masses)
        return [_body_of(*each) for each in zip(phi, bodies, change, strict=True)]

    def updated(self, z: Array) -> Robot:
        """The robot with p0 + sigma z written into its links, tool and friction."""
        n = self.robot.n
        robot = self.robot
        change = self.sigmas() * self.held(z)
        bodies = self._changed(change[: -3 * n].reshape(-1, 10))
        coulomb, viscous, static = change[-3 * n :].reshape(3, n)
        joints = []
        for j, joint in enumerate(robot.joints):
            F_s, F_c, F_v, stribeck = robot.friction[j]
            # rounded sums of what cancels may end below nothing
            level = max(0.0, F_c + coulomb[j])
            new = joint.friction.model_copy(
                update={
                    "coulomb_Nm": float(level),
                    "viscous_Nms_rad": float(max(0.0, F_v + viscous[j])),
                    "static_Nm": float(max(level, F_s + static[j])),
                    "stribeck_rad_s": float(stribeck),
                }
            )
            joints.append(joint.model_copy(update={"friction": new}))
        links = [
            link.model_copy(update={"body": b})
            for link, b in zip(robot.links, bodies[:n], strict=True)
        ]
        tool = None if robot.tool is None else robot.tool.model_copy(update={"body": bodies[n]})
        found = robot.model_copy(
            update={"links": tuple(links), "joints": tuple(joints), "tool": tool}
        )
        return self._motors.updated(found, coulomb, viscous)


def _median(values: Array, weights: Array) -> float:
    """Weighted median of values (k,): half of the weight on either side."""
    order = np.argsort(values)
    before = np.cumsum(weights[order]) - 0.5 * weights[order]
    return float(np.interp(0.5 * weights.sum(), before, values[order]))


def _body_of(phi: Array, body: Body, change: Array) -> Body:
    """The body of parameters phi (10,). A mass that falls to nothing has no centre: there the
    numbers of `body` themselves move by `change` (10,)."""
    if phi[0] > 0.0:
        return Body.of_parameters(phi)
    return body.model_copy(
        update={
            "mass_kg": 0.0,
            "com_m": tuple(float(v) for v in np.array(body.com_m) + change[1:4]),
            "inertia_kgm2": tuple(float(v) for v in np.array(body.inertia_kgm2) + change[4:]),
        }
    )


def parameter_slope(body: Body, X: Array | None) -> Array:
    """d phi / d (mass, com, inertia about the centre of mass), shape (10, 10), by exact
    differences."""
    slope = np.empty((10, 10))
    for k in range(10):
        step = np.zeros(10)
        step[k] = 1e-3
        up = _shifted(body, step)
        down = _shifted(body, -step)
        slope[:, k] = (up.parameters(X) - down.parameters(X)) / 2e-3
    return slope


def _shifted(body: Body, change: Array) -> Body:
    fields = {
        "mass_kg": body.mass_kg + change[0],
        "com_m": tuple(np.array(body.com_m) + change[1:4]),
        "inertia_kgm2": tuple(np.array(body.inertia_kgm2) + change[4:]),
    }
    return Body.model_construct(**fields)
