"""Gains of the torque channels (torque constants) from a known load.

A log alone cannot tell a drive that reads 10 % too much from an arm that is 10 % heavier. A load
that was weighed can: the same arm is recorded without it and with it, and what the load adds,

    tau_loaded - tau_model(unloaded) = gain_j tau_load,j + b0 + b1 sgn qd + b2 qd,

is known in true Nm. b are what friction and offset of that day changed. Without a load the logs
tell what the channels have apart (`fitting/relative_gains.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.torque_gain import TorqueGain
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.fitting.columns import columns
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fit import ASIDE, fit
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.given import given_torque
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.fitting.relative_gains import relative_gains
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.identification.late_torques import delays, prepared
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.wording import joined, numbered

SURE = 0.05
"""standard error up to which a gain is known [-]"""
POSSIBLE = (0.3, 3.0)
"""gains of a channel that reads torque at the joint at all [-]"""
FELT = 0.03
"""scatter of the load's torque over that of the joint's, below which its inertia counts as much"""
FEWEST = 100
"""samples of a joint that moves"""
SHARED = 1.3
"""factor beyond which gains of all joints come from one mistake"""
FEWEST_ALIKE = 2
"""joints that share it"""
ROUNDS = 3
EVERY = 10
"""of so many samples one carries the uncertainty of the unloaded arm"""

CONTRADICTED = (
    "over these gains the torque channels do not agree on the bodies that all joints feel: the "
    "logs are not read as the file says. Take torque_gain out of the robot file, and identify again"
)

Source = Literal["known load", "other joints", "robot file"]
"""what gains were found from"""


@dataclass(frozen=True)
class Gains:
    """Measured over true torque of each joint.

    Args:
        values, errors: gain and its standard error, (n,) [-]; a joint on which the load asks too
            little for an error of `SURE` keeps the gain 1.
        source: "known load"; "other joints": over the middle one of them; "robot file": as stated.
    """

    values: Array
    errors: Array
    source: Source = "known load"

    @property
    def known(self) -> Mask:
        """Joints whose gain the load shows, (n,)."""
        return np.asarray(self.errors <= SURE)

    def applied(self, log: Log) -> Log:
        """The log in true torque."""
        tau = log.tau / np.where(self.known, self.values, 1.0)
        return Log(log.time, log.q, tau, log.qd, log.q_ref, log.extra, log.name)

    def in_robot(self, robot: Robot) -> Robot:
        """The robot whose measuring chain has these gains: it predicts the logs as recorded."""
        joints = np.flatnonzero(self.known)
        effects = [
            LIBRARY["torque_gain"].of(int(j) + 1, gain=float(self.values[j]), source=self.source)
            for j in joints
        ]
        return robot.with_effects(*effects)

    def doubted_by(self, fitted: Fit) -> list[str]:
        """A line where a fit over the file's gains has channels that do not agree."""
        kept = self.source == "robot file"
        return [CONTRADICTED] if kept and gains_of_others(fitted) is not None else []

    def says(self) -> list[str]:
        """A line for each joint; one for all where other joints tell, or the file."""
        if self.source == "other joints":
            return [self._apart()]
        if self.source == "robot file":
            joints = [int(j) + 1 for j in np.flatnonzero(self.known)]
            values = joined([f"{self.values[j - 1]:.3g}" for j in joints])
            return [
                f"the torque of {numbered('joint', joints)} is read {values} times as large, "
                "as the file has it (torque_gain): its gains are kept, none are looked for"
            ]
        found = []
        for j, (value, error) in enumerate(zip(self.values, self.errors, strict=True)):
            if self.known[j]:
                said = f"reads {value:.3f} ± {1.96 * error:.3f} times its torque (known load)"
            else:
                said = (
                    f"gain not shown by the known load (standard error {error:.2g}); taken as 1: "
                    "move it where the load asks more of it"
                )
            found.append(f"joint {j + 1} {said}")
        some = np.abs(np.log(self.values[self.known]))
        same = len(set(np.sign(np.log(self.values[self.known])))) == 1
        if len(some) >= FEWEST_ALIKE and same and some.min() > np.log(SHARED):
            middle = float(np.exp(np.median(np.log(self.values[self.known]))))
            found.append(
                f"all known gains are about {middle:.2g}: the torque channels are of another unit, "
                "or the load that was stated is not the one on the arm (mass in kg, centre in mm)"
            )
        return found

    def _apart(self) -> str:
        read = ", ".join(
            f"{value:.2f} ± {1.96 * error:.2f}" if known else "1"
            for value, error, known in zip(self.values, self.errors, self.known, strict=True)
        )
        return (
            "the torque channels do not agree on the bodies that all joints feel: they read "
            f"{read} times their torque (from joint 1 on; 1 stands for the middle one and for what "
            "is not clear); the robot has them as torque_gain. Are torque constants, gear ratios "
            "and units what the columns say? A factor that all share is not told by this "
            "but by a known load (--loaded, --load)"
        )

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        return {
            "source": self.source,
            "gain": [float(v) for v in self.values],
            "standard_error": [float(v) for v in self.errors],
            "known": [bool(v) for v in self.known],
        }


def known_load_gains(robot: Robot, logs: Sequence[Log], loaded: Sequence[Log], load: Body) -> Gains:
    """Gains from logs without and with a load that was weighed.

    Args:
        load: mass, centre and inertia in the axes of the flange.

    Raises:
        InputError: a log is missing, or a gain is far from that of any torque channel.
    """
    if not logs or not loaded:
        raise InputError(
            f"known load: found {len(logs)} logs without and {len(loaded)} with it, expected at "
            "least one of each"
        )
    base, kept = fit_base(robot)
    model = Model(base)

    def recorded(some: Sequence[Log]) -> list[Recording]:
        return given_torque(kept, prepared(some, "angle", delays(model, kept, some)))

    found = fit(model, recorded(logs))
    phi = np.zeros((robot.n, 10))
    phi[-1] = load.parameters(robot.flange.matrix())
    values = np.ones(robot.n)
    errors = np.full(robot.n, np.inf)
    others = recorded(loaded)
    torque = [model.body_torque(p.motion.q, p.motion.qd, p.motion.qdd, phi.ravel()) for p in others]
    for j in range(robot.n):
        X = np.concatenate([_design(p, t, j) for p, t in zip(others, torque, strict=True)])
        theta, covariance = _alone(found, j)
        rest = [p.motion.tau - predicted(model, found.layout, p, theta) for p in others]
        y = np.concatenate([r[p.motion.known[:, j], j] for p, r in zip(others, rest, strict=True)])
        measured = np.concatenate([p.motion.tau[p.motion.known[:, j], j] for p in others])
        if len(y) < FEWEST or np.std(X[:, 0]) < FELT * np.std(measured):
            continue
        rows = [
            columns(model, found.layout, m.q[mask], m.qd[mask], m.qdd[mask])[:, j]
            for m, mask in ((p.motion, _thinned(p, j)) for p in others)
        ]
        some = np.concatenate([_design(p, t, j, True) for p, t in zip(others, torque, strict=True)])
        carried = np.linalg.pinv(some) @ np.concatenate(rows)
        coefficients = np.linalg.lstsq(X, y, rcond=None)[0]
        values[j] = coefficients[0]
        variance = _blockwise(X, y - X @ coefficients)
        errors[j] = np.sqrt(variance + carried[0] @ covariance @ carried[0])
    gains = Gains(values, errors)
    wrong = gains.known & ((values < POSSIBLE[0]) | (values > POSSIBLE[1]))
    if wrong.any():
        j = int(np.argmax(wrong))
        raise InputError(
            f"known load: found joint {j + 1} to read {values[j]:.2g} times the load's torque, "
            f"expected {POSSIBLE[0]:g} to {POSSIBLE[1]:g}: is the load's mass in kg, its centre in "
            "the axes of the flange, and is it on the arm in these logs?"
        )
    return gains


def gains_of_others(found: Fit) -> Gains | None:
    """What the channels have apart, of a fit to torques as they were read; None where it is not
    clear."""
    values, errors = relative_gains(found)
    return Gains(values, errors, "other joints") if (errors <= SURE).any() else None


def without_gains(robot: Robot) -> Robot:
    """The robot as torques over the gains are read."""
    effects = tuple(e for e in robot.effects if not isinstance(e, TorqueGain))
    return robot.model_copy(update={"effects": effects})


def gains_of_file(robot: Robot) -> Gains | None:
    """Those that a robot file states; None where it states none.

    Raises:
        InputError: a reading is no constant factor.
    """
    stated = [e for e in robot.lasting().effects if isinstance(e, TorqueGain)]
    if not stated:
        return None
    values = np.ones(robot.n)
    errors = np.full(robot.n, np.inf)
    for effect in stated:
        if any(effect.discrepancy):
            raise InputError(
                f"identify: found a reading of joint {effect.joint} that bends with its torque "
                "(torque_gain with a discrepancy), expected a constant factor; take it out of the "
                "robot file, identify, and diagnose it then"
            )
        values[effect.index] *= effect.gain
        errors[effect.index] = 0.0
    return Gains(values, errors, "robot file")


def open_by_gain(found: Fit, gains: Gains | None) -> Array:
    """Covariance of the numbers by that of the gains, sum_j s_j^2 J_j J_j^T, shape (p, p):

        J_j = d theta / d gain_j = -A^-1 sum a_j^T tau_j / (gain_j sigma_j^2 f_j).

    Args:
        found: the fit to torques over the gains; gains: none leave nothing open.
    """
    layout = found.layout
    if gains is None:
        return np.zeros((layout.count, layout.count))
    data = found.sums.summed()
    weight = 1.0 / (found.numbers.sigma**2 * found.samples)
    precision = found.prior.precision(found.numbers.kappa)
    inverse = scaled_inverse(np.einsum("n,npq->pq", weight, data.H[0]) + precision)
    spread = np.where(gains.known, gains.errors, 0.0) / gains.values
    slopes = inverse @ (spread * weight * data.g[0].T)
    return np.asarray(slopes @ slopes.T)


def _alone(found: Fit, j: int) -> tuple[Array, Array]:
    """Numbers of the unloaded arm as one joint alone reads them, and their covariance: channels
    with gains of their own agree on no bodies, so the file hardly counts."""
    data = found.sums.summed()
    H = data.H[0, j]
    g = data.g[0, j]
    precision = found.prior.precision(np.full(found.layout.n, ASIDE))
    variance = found.numbers.sigma[j] ** 2
    for _ in range(ROUNDS):
        weight = 1.0 / (variance * found.correlation[j])
        covariance = scaled_inverse(weight * H + precision)
        theta = covariance @ (weight * g + precision @ found.prior.mean)
        left = float(data.squared_error(theta)[0, j])
        variance = max(left / max(float(data.count[0, j]), 1.0), 1e-12)
    return theta, covariance


def _thinned(part: Recording, j: int) -> Mask:
    known = part.motion.known[:, j].copy()
    known[np.arange(len(known)) % EVERY != 0] = False
    return known


def _design(part: Recording, torque: Array, j: int, thinned: bool = False) -> Array:
    """Load's torque, 1, sgn qd, qd of one joint at known samples, (k, 4)."""
    mask = _thinned(part, j) if thinned else part.motion.known[:, j]
    qd = part.motion.qd[mask, j]
    return np.column_stack([torque[mask, j], np.ones_like(qd), np.sign(qd), qd])


def _blockwise(X: Array, left: Array, blocks: int = 30) -> float:
    """Variance of the first coefficient from how blocks of time disagree."""
    inverse = np.linalg.pinv(X.T @ X)
    scores = np.array(
        [X[part].T @ left[part] for part in np.array_split(np.arange(len(X)), blocks)]
    )
    return float((inverse @ (scores.T @ scores) @ inverse)[0, 0] * blocks / (blocks - 1))
