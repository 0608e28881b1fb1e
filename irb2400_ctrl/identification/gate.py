"""What a motion can tell of every number, before anything is fitted.

Of each base parameter and each number of a drive the logs alone, without the file, give a standard
error. It is held against the size that matters: what moves one joint's torque by a twentieth of its
rms. Less than a fifth of that is identifiable, less than that is weak, more is not identifiable.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.base_parameters import NAMES

Grade = Literal["identifiable", "weak", "not identifiable", "unknown"]

MATTERS = 0.05
"""of the rms torque of the joint that feels a number most [-]"""
SURE = 0.2
"""standard error over the size that matters, below which a number is identifiable [-]"""
ALIKE = 1e-10
"""eigenvalue of the information, over the largest, below which motions cannot part two numbers"""
STILL = 1e-6
"""column over the largest, below which a joint did not move for it"""


@dataclass(frozen=True)
class Verdict:
    """One number from these motions.

    Args:
        name: as `Ixx_3`, a base parameter; stands_for: the sum of numbers that it is, if any;
        ratio: standard error from the logs alone over the size that matters.
    """

    name: str
    grade: Grade
    ratio: float
    stands_for: str
    reason: str
    motion: str

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        return {
            "name": self.name,
            "verdict": self.grade,
            "error_over_size_that_matters": self.ratio if np.isfinite(self.ratio) else None,
            "stands_for": self.stands_for,
            "reason": self.reason,
            "motion_that_would_help": self.motion,
        }


def verdicts(
    model: Model, layout: ColumnLayout, sums: Moments, sigma: Array, correlation: Array
) -> list[Verdict]:
    """Every base parameter and drive number.

    Args:
        sigma: rms torque that is left [Nm], shape (n,); correlation: samples per independent one.
    """
    base = model.base_parameters
    places = np.concatenate([np.array(base.kept), np.arange(layout.inertial, layout.count)])
    names = [layout.names()[k] for k in places]
    stands_for = [base.explain(k) for k in range(base.count)]
    data = sums.part(places).summed()
    count = np.maximum(data.count[0], 1.0)
    weight = 1.0 / (sigma**2 * correlation)
    information = np.einsum("n,npq->pq", weight, data.H[0])
    shares = np.sqrt(np.einsum("npp->np", data.H[0]) / count[:, None])
    rms = np.sqrt(np.maximum(data.c[0] / count, 1e-12))
    # torque over the joint's rms, per unit of the number, on the joint that feels it most
    felt = (shares / rms[:, None]).max(axis=0)
    seen = felt > STILL * felt.max()
    ratios = np.full(len(places), np.inf)
    partners: list[list[str]] = [[] for _ in places]
    moving = np.flatnonzero(seen)
    errors, alike = _data_errors(information[np.ix_(moving, moving)])
    ratios[moving] = errors * felt[moving] / MATTERS
    for row, others in zip(moving, alike, strict=True):
        partners[row] = [names[moving[k]] for k in others]
    found = []
    for k, name in enumerate(names):
        grade, reason = _grade(ratios[k], bool(seen[k]), partners[k])
        said = stands_for[k] if k < base.count and stands_for[k] != name else ""
        motion = "" if grade == "identifiable" else motion_for(name)
        found.append(Verdict(name, grade, float(ratios[k]), said, reason, motion))
    return found


def _data_errors(information: Array) -> tuple[Array, list[Integers]]:
    """Standard errors without a prior (inf where two numbers look the same), and look-alikes."""
    size = np.sqrt(np.diag(information))
    values, vectors = np.linalg.eigh(information / size[:, None] / size)
    blind = values < ALIKE * values[-1]
    kept = ~blind
    variance = (vectors[:, kept] ** 2 / values[kept]).sum(axis=1) / size**2
    hidden = (vectors[:, blind] ** 2).sum(axis=1) > 1e-6
    errors = np.where(hidden, np.inf, np.sqrt(variance))
    alike = []
    directions = vectors[:, blind] @ vectors[:, blind].T
    for row in range(len(size)):
        others = (
            np.flatnonzero(np.abs(directions[row]) > 0.05) if hidden[row] else np.array([], int)
        )
        alike.append(others[others != row])
    return errors, alike


def _grade(ratio: float, seen: bool, partners: Sequence[str]) -> tuple[Grade, str]:
    """The grade and why."""
    if not seen:
        return "unknown", "its joint did not move, or too slowly: no torque depends on it"
    if not np.isfinite(ratio):
        return "not identifiable", f"looks the same as {', '.join(partners) or 'others'} here"
    if ratio < SURE:
        return "identifiable", ""
    size = f"the logs alone leave {ratio:.2g} times the size that matters open"
    return ("weak", size) if ratio < 1.0 else ("not identifiable", size)


def motion_for(name: str) -> str:
    """The motion that would show a number."""
    what, _, joint = name.split(" ")[0].rpartition("_")
    if what in ("m", "mx", "my", "mz"):
        return f"slow turns of the joints before link {joint} through all of their range"
    if what in NAMES:
        return f"fast reversals (0.5-2 Hz) of joint {joint} and the one before, in several postures"
    return {
        "coulomb": f"runs of joint {joint} at constant speed in both directions",
        "viscous": f"runs of joint {joint} at several speeds up to its limit",
        "offset": f"the same postures reached by joint {joint} from both sides",
        "rotor": f"fast reversals of joint {joint} with the arm folded and stretched",
        "stribeck": f"very slow runs of joint {joint}, below 0.02 rad/s",
        "power": f"runs of joint {joint} at several speeds up to its limit",
        "load": f"slow runs of joint {joint} both ways, with the arm folded and stretched",
        "coupling": f"joint {joint} and the next, first one at a time, then both",
        "far_coupling": f"joint {joint} and the next but one, first one at a time, then both",
        "motor": f"joint {joint} and those before it, first one at a time, then all",
        "balancer": f"slow turns of joint {joint} through all of its range",
        "spring": f"slow turns of joint {joint} through all of its range",
    }.get(what, f"fast reversals of joint {joint}")
