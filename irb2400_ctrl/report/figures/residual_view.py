"""A recorded motion replayed: the tool's way coloured by what a model leaves, before and after."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.elements.arm_view import ArmView, Colouring
from irb2400_ctrl.robot import Robot

WINDOW_S = 0.25
"""over which what is left is averaged [s]"""


def residual_view(
    robot: Robot, log: Log, time: Array, residuals: Mapping[str, Array], joint: int
) -> ArmView:
    """The arm as recorded.

    Args:
        robot: the arm.
        log: the motion.
        time: of the residuals [s], shape (m,).
        residuals: name -> measured less modelled torque of one joint [Nm], shape (m,), gaps as NaN.
        joint: which, for the names.
    """
    smooth = {name: _rms(time, values) for name, values in residuals.items()}
    # one scale, so that before and after can be compared
    high = max(float(values.max()) for values in smooth.values())
    fields = [
        Colouring(f"joint {joint}, left {name}", "Nm", np.interp(log.time, time, values), 2, high)
        for name, values in smooth.items()
    ]
    return ArmView(robot, log.time, log.q, tuple(fields))


def _rms(time: Array, values: Array) -> Array:
    """Root of the mean square over a short window; gaps count as nothing left."""
    count = max(1, round(WINDOW_S / float(np.median(np.diff(time)))))
    squared = np.convolve(np.nan_to_num(values) ** 2, np.ones(count) / count, mode="same")
    return np.asarray(np.sqrt(np.maximum(squared, 0.0)))
