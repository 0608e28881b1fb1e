"""Numbers of an identified arm that a log moves, held to what bodies can be.

A covariance knows no bound: on a short log a fit moves bodies that were identified to where none
exist, with torques that turn against the acceleration. Bodies that were possible then stay.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior, IdentifiedPrior
from irb2400_ctrl.model.realisable import realise
from irb2400_ctrl.robot import Robot

IMPOSSIBLE = (
    "the log asks for numbers that no bodies can have, where the file's could exist: they stand "
    "for something else, and robot.toml is a record of this log, not a robot to simulate "
    "(irb2400 robot check)"
)


def turns_impossible(given: Robot, after: Robot) -> bool:
    """Whether bodies that could exist became ones that could not."""
    if after.links == given.links and after.tool == given.tool:
        return False
    return not realise(after).exists and realise(given).exists


def with_possible_bodies(prior: AnyPrior, fit: Fit) -> Fit:
    """The fit, with the bodies of an identified robot as they were where its own are impossible:
    friction, offsets and rotors are then those that belong to these bodies.

    With A the rows of the bodies in the root of the prior, C the covariance of z:
    z becomes P z, C becomes P C P^T, P = 1 - C A^T (A C A^T)^+ A.
    """
    if not isinstance(prior, IdentifiedPrior):
        return fit
    if realise(prior.updated(prior.deviations(fit.z))).exists or not realise(prior.robot).exists:
        return fit
    A = prior.root[: 10 * len(prior.base.bodies)]
    C = fit.z_covariance
    kept = np.eye(len(C)) - C @ A.T @ np.linalg.pinv(A @ C @ A.T, rcond=1e-9, hermitian=True) @ A
    return replace(fit, z=kept @ fit.z, z_covariance=kept @ C @ kept.T)
