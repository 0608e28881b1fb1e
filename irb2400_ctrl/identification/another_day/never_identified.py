"""What is to be said of the errors that a file leaves which was never identified: a maker's numbers
are of no single arm, so that they are the file's as much as the arm's."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.metrics import beyond_noise, errors, noise_floor
from irb2400_ctrl.identification.another_day.otherwise import BEYOND
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import numbered

LITTLE = 0.1
"""share of a joint's mean torque that is left beyond noise at least: a file may be as good"""


def never_identified(robot: Robot, motion: PreparedLog, modelled: Array) -> tuple[str, ...]:
    """A sentence where a file that was never identified leaves more than noise.

    Args:
        robot: as its file has it; motion: of the log; modelled: torque (m, n) [Nm].
    """
    if robot.identified is not None:
        return ()
    found = errors(motion.tau, modelled, motion.known)
    floor = noise_floor(motion.tau - modelled, motion.known, motion.step)
    share = beyond_noise(found.rmse, floor) / np.maximum(found.rmse, 1e-12)
    beyond = found.rmse_over_mean_percent * share
    far = np.flatnonzero((beyond > 100.0 * LITTLE) & (found.rmse > BEYOND * floor))
    if not len(far):
        return ()
    worst = int(far[np.argmax(beyond[far])])
    unstated = [j + 1 for j in range(robot.n) if not robot.friction_stated[j, 1:3].any()]
    friction = f" It states no friction of {numbered('joint', unstated)}." if unstated else ""
    return (
        f"this file was never identified: what it leaves beyond noise, {beyond[worst]:.0f} % of "
        f"the mean torque of joint {worst + 1}, is the file's as much as the arm's.{friction} "
        "`irb2400 identify LOG... --robot FILE` makes one that is true of this arm, of logs of it "
        "sound",
    )
