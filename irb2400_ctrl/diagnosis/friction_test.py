"""Whether all friction of a joint is larger or smaller than on another day, as one number.

What makes a gear stiffer multiplies its dry friction, its viscous friction and what grows with its
load alike: tau = (1 + a) f, with f the friction of the reference along today's motion. Held sample
by sample against what a model leaves of any motion, a change by two fifths may be little; along the
motion it is one number (`one_number.py`), against what the reference's friction scattered by from
log to log and what changes from day to day. What changes as a whole is there with all numbers as
given, too: a law that bends otherwise than the reference's moves one part of it against the others.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.numbers import LEAST_FRICTION, RATIO, Number
from irb2400_ctrl.diagnosis.one_number import TOLD, OneNumber
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Robot

PARTS = ("load_friction", "viscous_power")
"""effects that are a part of the friction of their joint"""
WHOLE = 0.5
"""share of a change that the torque shows with all numbers as given"""


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
    asked = OneNumber(fitter, fit)
    found = []
    for j in range(motion.n):
        if not along[:, j].any():
            continue
        law = RegressorColumns((j,), along[:, j : j + 1])
        more = asked.along(law)
        if abs(more.sigmas) <= TOLD or abs(more.amount) <= LEAST_FRICTION:
            continue
        if asked.as_given(law) / more.amount > WHOLE:
            told = 1.0, 1.0 + more.amount, more.standard_error, more.sigmas
            found.append(Number("changed", f"joint {j + 1}", RATIO, *told))
    return tuple(found)
