"""Gains of the torque channels (torque constants) from a known load.

A log alone cannot tell a drive that reads 10 % too much from an arm that is 10 % heavier. A load
that was weighed can: the same arm is recorded without it and with it, and what the load adds,
is known in true Nm (`known_load/`). Without a load the logs tell what the channels have apart
(`fitting/relative_gains.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.torque_gain import TorqueGain
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.relative_gains import relative_gains
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import joined, numbered

SURE = 0.05
"""standard error up to which a gain is known [-]"""
SHARED = 1.3
"""factor beyond which gains of all joints come from one mistake"""
FEWEST_ALIKE = 2
"""joints that share it"""
EQUAL = 1.05
"""factor between gains that come from one mistake, where they are not beyond `SHARED`"""
CLEAR = 3.5
"""standard errors from which something is sure enough to be said, or refused"""
THREE = 3
"""joints that are so equal by no chance"""

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
        return [*found, *self._alike()]

    def _alike(self) -> list[str]:
        """A line where all gains come from one mistake."""
        known = self.values[self.known]
        if len(known) < FEWEST_ALIKE or not (known > 0.0).all():
            return []
        size = np.log(known)
        if len(set(np.sign(size))) > 1:
            return []
        middle = float(np.exp(np.median(size)))
        if np.abs(size).min() > np.log(SHARED):
            return [
                f"all known gains are about {middle:.2g}: the torque channels are of another unit, "
                "or the load that was stated is not the one on the arm (mass in kg, centre in mm)"
            ]
        off = np.abs(known - 1.0)
        equal = len(known) >= THREE and known.max() < EQUAL * known.min()
        if equal and abs(middle - 1.0) > SURE and (off > CLEAR * self.errors[self.known]).all():
            return [
                f"all known gains are about {middle:.2f}: a load of {middle:.2f} times the stated "
                "mass looks the same, and the arm would then be read as it is. Weigh it again"
            ]
        return []

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
