"""Whether all friction of a joint is larger or smaller than on another day, as one number.

What makes a gear stiffer multiplies its dry friction, its viscous friction and what grows with its
load alike: tau = (1 + a) f, with f the friction of the reference along today's motion. Held sample
by sample against what a model leaves of any motion, a change by two fifths may be little; along the
motion it is one number. With numbers as uncertain as the reference leaves them, Z, which holds what
its friction scattered by from log to log and what changes from day to day, y ~ N(0, 1 + Z Z^T)
without a change, so that, X the columns of f,

    T = X^T P y / (X^T P (k^2 + Z Z^T) P X)^(1/2),    P = (1 + Z Z^T)^-1

is a standard normal variable, k the `INFLATION` of what comes from the noise, as everywhere; and
a = X^T P y / X^T P X.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.numbers import LEAST_FRICTION, RATIO, Number
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Robot

TOLD = 3.0
"""standard deviations of T, as of a load"""
PARTS = ("load_friction", "viscous_power")
"""effects that are a part of the friction of their joint"""


def friction_along(robot: Robot, bases: Bases, motion: PreparedLog) -> Array:
    """Friction of each joint along a motion, shape (m, n) [Nm].

    Args:
        robot: with its effects; bases: of it without them; motion: the log, prepared.
    """
    tau = np.array(FrictionLaw.of(robot).torque(motion.qd, np.sign(motion.qd)))
    for effect in robot.effects:
        if effect.kind in PARTS:
            tau += effect_torque(bases, effect, motion)
    return tau


def moved_as_all_friction(fitter: Fitter, fit: Fit, change: bool) -> tuple[Number, ...]:
    """Joints whose friction as a whole is told from the reference's, by how much.

    Args:
        fitter: of the robot given; of one that was not identified nothing is said.
        fit: of all that was found; a law of the friction of a joint leaves nothing to tell there.
        change: whether the robot given is a reference of this very arm.
    """
    robot = fitter.robot
    motion = fitter.motion
    if robot.identified is None or not change:
        return ()
    along = motion.filtered(friction_along(robot, fitter.bases, motion)[:, :, None])
    Z = fit.Z.copy()
    Z[:, :, : fitter.own] *= fitter.widened
    problem = Problem(fit.y, Z, fit.noise)
    found = []
    for j in range(motion.n):
        if not along[:, j].any():
            continue
        columns = RegressorColumns((j,), along[:, j : j + 1])
        gram, right = problem.projected(columns)
        information = float(gram[0, 0])
        torque = columns.torque(np.ones(1), motion.n)
        left = torque - Z @ (problem.z - problem.base_beside(torque))
        by_noise = float(sum(np.sum(n.whiten(left[:, i]) ** 2) for i, n in enumerate(fit.noise)))
        spread = float(np.sqrt(information + (INFLATION**2 - 1.0) * by_noise))
        sigmas = float(right[0]) / max(spread, 1e-12)
        by = float(right[0]) / max(information, 1e-12)
        if abs(sigmas) > TOLD and abs(by) > LEAST_FRICTION:
            error = spread / information
            found.append(Number("changed", f"joint {j + 1}", RATIO, 1.0, 1.0 + by, error, sigmas))
    return tuple(found)
