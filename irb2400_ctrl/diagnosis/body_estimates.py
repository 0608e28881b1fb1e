"""Mass, centre and inertia of a body that was found: beside an uncertain base, and the file's.

An effect is a point mass, which is what a model of the arm needs; what somebody weighs has an
inertia of its own, and a point mass would take it for a centre further out. Here it is free:

    phi(m, c, J) = (m, m c, m (|c|^2 1 - c c^T) + J),    tau = Y phi

*Robust*: the bodies of the arm are as uncertain as the file, or a reference, leaves them.
*Given the bodies*: they are taken as true; sharper, and wrong where they are. That the two differ
by more than their errors says that the file's bodies are not this arm's.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.posterior import Posterior
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior, IdentifiedPrior

GYRATION = 0.06
"""[m] radius of gyration of a usual load: its inertia is m GYRATION^2, give or take as much"""
WIDE = np.array([10.0, 0.25, 0.25, 0.25])
"""spread of mass [kg] and centre [m] before the log"""
ROUNDS = 4
DIAGONAL = np.array([1.0, 0.0, 0.0, 1.0, 0.0, 1.0])
"""which of Jxx, Jxy, Jxz, Jyy, Jyz, Jzz stand on the diagonal"""


@dataclass(frozen=True)
class BodyEstimate:
    """A body in the frame that carries it.

    Args:
        mass: [kg]; com: centre [m], (3,); gyration: radius of gyration [m]; errors: standard errors
            of mass and centre, (4,).
    """

    mass: float
    com: Array
    gyration: float
    errors: Array

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {
            "mass_kg": self.mass,
            "com_m": self.com.tolist(),
            "radius_of_gyration_m": self.gyration,
            "standard_errors": {
                "mass_kg": float(self.errors[0]),
                "com_m": self.errors[1:].tolist(),
            },
        }


@dataclass(frozen=True)
class BodyEstimates:
    """The two estimates side by side."""

    robust: BodyEstimate
    given_bodies: BodyEstimate

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {"robust": self.robust.to_json(), "given_bodies": self.given_bodies.to_json()}


def body_estimates(prior: AnyPrior, fitter: Fitter, fit: Fit, place: int) -> BodyEstimates | None:
    """Of the effect at a place of the fit; None if it is no body."""
    effect: Any = fit.effects[place]
    if effect.acts != "parameters" or not hasattr(effect, "com_m"):
        return None
    motion = fitter.motion
    law = fitter.bases.of(effect, motion)
    Y = np.zeros((motion.rows, motion.n, 10))
    Y[:, list(law.joints)] = law.values
    own = len(fit.z)
    k = int(np.sum(fit.owner < 0))
    others = [k + i for i, p in enumerate(fit.parameters) if p.effect != place]
    others += [*range(own, k), *range(k + len(fit.parameters), fit.Z.shape[2])]
    beside = fit.Z[:, :, others]
    start = np.array([effect.mass_kg, *effect.com_m])
    bases = (fit.Z[:, :, :own], motion.filtered(_without_bodies(prior, fitter)))
    robust, given = (
        _estimate(fit, Y, np.concatenate([base, beside], axis=2), start) for base in bases
    )
    return BodyEstimates(robust, given)


def _estimate(fit: Fit, Y: Array, Z: Array, start: Array) -> BodyEstimate:
    """Gauss-Newton on mass and centre, the inertia and everything else (unit priors) with them."""
    usual = abs(start[0]) * GYRATION**2
    J = usual * DIAGONAL
    spread = usual * np.where(DIAGONAL > 0, 1.0, 0.5)
    numbers = start
    point = _point(start)
    found: Posterior
    for _ in range(ROUNDS):
        phi = _point(numbers)
        phi[4:] += usual * DIAGONAL
        y = fit.y - Y @ (phi - point)
        columns = np.concatenate([Y @ _slope(numbers) * WIDE, Y[:, :, 4:] * spread, Z], axis=2)
        found = Posterior(y, columns, fit.noise)
        b = found.mean
        numbers = numbers + b[:4] * WIDE
        J = usual * DIAGONAL + b[4:10] * spread
    errors = INFLATION * np.sqrt(np.diag(found.covariance)[:4]) * WIDE
    trace = max(float(J @ DIAGONAL), 0.0)
    gyration = float(np.sqrt(trace / 3.0 / max(abs(numbers[0]), 1e-9)))
    return BodyEstimate(float(numbers[0]), numbers[1:], gyration, errors)


def _point(numbers: Array) -> Array:
    """phi of a point mass, (10,)."""
    m = numbers[0]
    c = numbers[1:]
    inertia = m * (c @ c * np.eye(3) - np.outer(c, c))
    return np.array([m, *(m * c), *inertia[np.triu_indices(3)]])


def _slope(numbers: Array) -> Array:
    """d phi / d (m, c), shape (10, 4), by central differences."""
    step = 1e-5 * np.eye(4)
    columns = [(_point(numbers + d) - _point(numbers - d)) / 2e-5 for d in step]
    return np.column_stack(columns)


def _without_bodies(prior: AnyPrior, fitter: Fitter) -> Array:
    """Columns of the base with nothing open about the bodies, (m, n, ·)."""
    n = prior.robot.n
    if isinstance(prior, IdentifiedPrior):
        root = np.array(prior.root)
        root[: prior.drives.start - 3 * n] = 0.0
        return replace(prior, root=root).columns(fitter.bases.model, fitter.motion)
    return prior.columns(fitter.bases.model, fitter.motion)[:, :, -3 * n :]
