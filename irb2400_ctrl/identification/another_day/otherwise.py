"""What a log says of an arm that was identified on another day, beside its errors: that it is not
as it was then, and what one simple thing would say most of that.

S_j^2 = RMSE_j^2 - floor_j^2 is what the model leaves on joint j beyond noise, and `left_Nm` of the
file what it left so of motions that it had not seen.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.comparison.possible import within_reach
from irb2400_ctrl.diagnosis.diagnosis import NEVER_NOISE
from irb2400_ctrl.diagnosis.friction_test import friction_along
from irb2400_ctrl.diagnosis.preparation.metrics import beyond_noise, errors, noise_floor
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.added_body import AddedBody
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import numbered

BEYOND = 1.2
"""times the noise of the log that are left at least: its floor may be wrong by less"""
MOSTLY = 0.75
"""share of what is left beyond noise, squared, that a simple thing says at least to be told"""
FRICTION_OF_A_DAY = 0.1
"""share of its friction by which a joint differs from one day to another"""
AS_IT_IS = 0.05
"""difference from 1, below which a factor of all torques is none"""
ASK = "`irb2400 diagnose LOG --robot FILE` looks for what is otherwise"


def otherwise(robot: Robot, motion: PreparedLog, modelled: Array) -> tuple[str, ...]:
    """A sentence where a log shows an arm, or torques, that are not as they were when the robot was
    identified; none of a robot that was not.

    Args:
        robot: with its file's identification; motion: of the log; modelled: torque (m, n) [Nm].
    """
    if robot.identified is None:
        return ()
    rmse = errors(motion.tau, modelled, motion.known).rmse
    floor = noise_floor(motion.tau - modelled, motion.known, motion.step)
    bases = Bases(robot.bare())
    friction = rms(friction_along(robot, bases, motion))
    usual = np.hypot(robot.usually_left, FRICTION_OF_A_DAY * friction)
    beyond = beyond_noise(rmse, floor)
    far = np.flatnonzero((beyond > NEVER_NOISE * usual) & (rmse > BEYOND * floor))
    if not len(far):
        return ()
    scale = np.hypot(floor, usual)
    worst = int(far[np.argmax(beyond[far] / scale[far])])
    simple = _simple(robot, bases, motion, modelled, (floor, scale))
    return (
        f"{numbered('joint', [int(j) + 1 for j in far])}: not as when this arm was identified. "
        f"Beyond noise {beyond[worst]:.2g} Nm are left on joint {worst + 1}, where friction of "
        f"another day and what the identification left of unseen motions are {usual[worst]:.2g} "
        f"Nm{simple}; {ASK}",
    )


def _simple(
    robot: Robot, bases: Bases, motion: PreparedLog, modelled: Array, sizes: tuple[Array, Array]
) -> str:
    """What one simple thing says of the difference, in words; nothing where none says most.

    Args:
        robot: as of `otherwise`; bases: of it; motion: of the log.
        modelled: torque, shape (m, n) [Nm].
        sizes: noise of each joint, and what is usual with it, (n,) [Nm].
    """
    floor, scale = sizes
    weight = motion.known / scale
    left = (motion.tau - modelled) * weight
    noise = float(np.sum(motion.known * (floor / scale) ** 2))
    beyond = float(np.sum(left**2)) - noise

    def told(columns: Array) -> Array:
        A = (columns * weight[:, :, None]).reshape(-1, columns.shape[2])
        return np.asarray(np.linalg.lstsq(A, left.ravel(), rcond=None)[0])

    def share(torque: Array) -> float:
        rest = float(np.sum((left - torque * weight) ** 2))
        return 1.0 - max(rest - noise, 0.0) / beyond

    (more,) = told(modelled[:, :, None])
    said = share(more * modelled)
    if said > MOSTLY and abs(more) > AS_IT_IS:
        return f". All torques times {1.0 + more:.2f} would say {100 * said:.0f} % of it"
    law = bases.columns("payload", None, motion, filtered=False)[0]
    columns = np.zeros((*motion.tau.shape, law.values.shape[2]))
    columns[:, list(law.joints)] = law.values
    load = LIBRARY["payload"].from_coefficients(None, told(columns).tolist(), {})
    # its inertia is not told: without it a body that cannot be says nothing
    said = share(columns @ load.coefficients())
    if said < MOSTLY or not isinstance(load, AddedBody) or not within_reach(robot, load):
        return ""
    place = ", ".join(f"{1e3 * value:.0f}" for value in load.com_m)
    what = "load" if load.mass_kg > 0.0 else "load less"
    return (
        f". A {what} of {abs(load.mass_kg):.2g} kg at ({place}) mm in the axes of the flange would "
        f"say {100 * said:.0f} % of it"
    )
