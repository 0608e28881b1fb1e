"""The base of an arm that has been identified: its numbers are correlated, and known by covariance.

Where a robot file carries `[identified]`, its covariance C = L L^T takes the place of the spreads
of a data sheet. Offsets and rotors belong to that base too. What differs from day to day anyway
(friction with temperature, offsets with the drives' own) is added to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.base_prior import (
    BasePrior,
    body_spread,
    named_bodies,
    parameter_slope,
)
from irb2400_ctrl.diagnosis.preparation.open_shapes import OpenShapes
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.acceleration_reading import AccelerationReading
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.base_parameters import NAMES
from irb2400_ctrl.robot import Identified, Robot, Uncertainty

DAILY_FRICTION = 0.1
"""change of Coulomb and viscous friction from one day to another, one standard deviation [-]"""
DAILY_OFFSET = 0.003
"""change of a torque offset from one day to another over the joint's rms torque [-]"""
DRIVE_EFFECTS = {"torque_offset": "offset_Nm", "rotor_inertia": "inertia_kgm2"}
"""effects that hold the numbers beside bodies and friction, in the order of the columns"""


@dataclass(frozen=True)
class IdentifiedPrior:
    """Numbers of the base with the covariance of an identification.

    Args:
        base: columns and units of bodies and friction.
        root: numbers per unit normal, shape (k + 2 n + s, k + 2 n + s): the k of `base` in its
            standard deviations, then offsets [Nm] and rotors [kg m2], then s of `shapes`.
        known: the same without what changes from day to day.
        shapes: what is left open of the shapes of effects; None for nothing.
    """

    base: BasePrior
    root: Array
    known: Array
    shapes: OpenShapes | None = None

    @classmethod
    def of(cls, robot: Robot, uncertainty: Uncertainty, motion: PreparedLog) -> IdentifiedPrior:
        """For the log of a motion; the robot carries `[identified]`."""
        base = BasePrior.of(robot, uncertainty, motion)
        L = _identified_rows(base)
        sigmas = base.sigmas()
        n = robot.n
        daily = np.zeros(len(L))
        k = len(sigmas)
        coulomb = robot.friction[:, 1]
        viscous = robot.friction[:, 2]
        daily[k - 3 * n : k - 2 * n] = DAILY_FRICTION * coulomb / sigmas[k - 3 * n : k - 2 * n]
        daily[k - 2 * n : k - n] = DAILY_FRICTION * viscous / sigmas[k - 2 * n : k - n]
        daily[k : k + n] = DAILY_OFFSET * base.torque_scale
        return cls(base, _square(np.hstack([L, np.diag(daily)])), _square(L))

    def beside(self, shapes: OpenShapes) -> IdentifiedPrior:
        """The same with what is left open of the shapes of effects along the motion."""
        more = np.eye(shapes.count)
        root, known = (block_diag(one, more) for one in (self.root, self.known))
        return replace(self, root=root, known=known, shapes=shapes)

    @property
    def robot(self) -> Robot:
        """The robot as given."""
        return self.base.robot

    @property
    def drives(self) -> slice:
        """Places of offsets and rotors."""
        after = len(self.root) - (0 if self.shapes is None else self.shapes.count)
        return slice(after - 2 * self.robot.n, after)

    def dry_friction(self) -> Array:
        """As `BasePrior.dry_friction`."""
        return self.base.dry_friction()

    def columns(self, model: Model, motion: PreparedLog) -> Array:
        """d tau / d z along the motion, shape (m, n, k + 2 n + s) [Nm]."""
        n = self.robot.n
        parts = [self.base.number_columns(model, motion)]
        for signal in (np.ones_like(motion.qd), motion.qdd):
            placed = np.zeros((*signal.shape, n))
            placed[:, np.arange(n), np.arange(n)] = signal
            parts.append(placed)
        if self.shapes is not None:
            parts.append(self.shapes.columns)
        return np.asarray(np.concatenate(parts, axis=2) @ self.root)

    def deviations(self, z: Array) -> Array:
        """Numbers away from the file's for unit normals z, in the units of `root`."""
        return np.asarray(self.root @ z)

    def lifted(self, deviations: Array, qd: Array) -> Array:
        """As `BasePrior.lifted`."""
        return self.base.lifted(deviations[: self.drives.start], qd)

    def updated(self, deviations: Array) -> Robot:
        """The robot with these deviations in its links, friction, offsets, rotors and shapes."""
        n = self.robot.n
        place = self.drives
        offsets_and_rotors = deviations[place].reshape(2, n)
        updated = self.base.updated(deviations[: place.start])
        effects: list[Any] = list(updated.effects)
        if self.shapes is not None:
            effects = self.shapes.written(effects, deviations[place.stop :])
        for (kind, field), change in zip(DRIVE_EFFECTS.items(), offsets_and_rotors, strict=True):
            for j in range(n):
                effects = _shifted(effects, kind, field, j + 1, float(change[j]))
        return updated.model_copy(update={"effects": tuple(effects)})


AnyPrior = BasePrior | IdentifiedPrior
"""what is known of a robot's numbers, of a data sheet or by an identification"""


def _identified_rows(base: BasePrior) -> Array:
    """Rows of L for every number of the base in its units, then offsets and rotors, (k + 2 n, ·).

    Static friction is not identified and keeps the file's spread; the tool is in the last link.
    """
    robot = base.robot
    if robot.identified is None:
        raise ValueError("the robot has not been identified")
    n = robot.n
    blocks: list[Array] = []
    for i, (body, name) in enumerate(named_bodies(robot)):
        if i >= n:
            blocks.append(np.zeros((10, blocks[0].shape[1])))
            continue
        phi = robot.identified.rows([f"{what}_{i + 1}" for what in NAMES])
        spread = body_spread(base.uncertainty, body, name)
        own = np.linalg.solve(parameter_slope(body, None), phi)
        blocks.append(own / np.where(spread > 0, spread, np.inf)[:, None])
    coulomb, viscous, _ = base.sigmas()[-3 * n :].reshape(3, n)
    for term, size in (("coulomb", coulomb), ("viscous", viscous)):
        blocks.append(robot.identified.rows(_of_joints(term, n)) / size[:, None])
    static = np.zeros((n, blocks[0].shape[1]))
    offsets = robot.identified.rows(_of_joints("offset", n))
    L = np.vstack([*blocks, static, offsets, _rotors(robot.identified, n)])
    own_static = np.zeros((len(L), n))
    own_static[-3 * n : -2 * n] = np.eye(n)
    return np.hstack([L, own_static])


def _rotors(identified: Identified, n: int) -> Array:
    """Rows of L of the rotors; where a reading lacks what accelerates its drive, of the difference
    of the two: the file keeps what the reading lacks, and a log shows no more of them.
    """
    rows = identified.rows(_of_joints("rotor", n))
    for j in range(n):
        lacking = f"reading_{j + 1} -qdd"
        if lacking in identified.root:
            rows[j] -= identified.rows([lacking])[0]
    return rows


def _of_joints(term: str, n: int) -> list[str]:
    return [f"{term}_{j + 1}" for j in range(n)]


def _square(root: Array) -> Array:
    """A square root of the same covariance."""
    return np.asarray(np.linalg.qr(root.T)[1].T)


def _shifted(effects: list[Any], kind: str, field: str, joint: int, change: float) -> list[Any]:
    """The effects with one number changed; the effect is made where there is none.

    What a rotor, which has no negative inertia, cannot give, a reading lacks more, where it lacks
    what accelerates its drive.
    """
    found: list[Effect] = []
    there = False
    value = change
    for effect in effects:
        if effect.kind == kind and effect.joint == joint and not there:
            there = True
            value = getattr(effect, field) + change
            fields: Mapping[str, float] = {field: _allowed(kind, value)}
            effect = effect.model_copy(update=fields)
        found.append(effect)
    if not there:
        found.append(LIBRARY[kind].of(joint, **{field: _allowed(kind, value)}, source="identified"))
    if value == _allowed(kind, value):
        return found
    return [
        e.model_copy(update={"inertia_kgm2": e.inertia_kgm2 - value})
        if isinstance(e, AccelerationReading) and e.joint == joint
        else e
        for e in found
    ]


def _allowed(kind: str, value: float) -> float:
    """A rotor has no negative inertia."""
    return max(0.0, value) if kind == "rotor_inertia" else value
