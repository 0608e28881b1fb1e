"""What the drive's reading makes of the torque of a base that moves: a gain multiplies that too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.effect_parameters import Parameter, value_of, with_value
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog


def shown_of(effects: Sequence[Effect], motion: PreparedLog) -> Array:
    """By how much the reading of each joint grows with its torque, shape (rows, n).

    Args:
        effects: without discrepancy, so that the reading is linear in the torque.
        motion: whose rows are asked.
    """
    time = motion.row_time
    shown = np.ones((len(time), motion.n))
    for effect in effects:
        if effect.chain == "reading":
            readings = (effect.reported(time, np.full(shown.shape, tau)) for tau in (1.0, 0.0))
            shown *= np.subtract(*readings)
    return shown


def slope_of_shown(effect: Effect, parameter: Parameter, motion: PreparedLog) -> Array:
    """d shown / d parameter by central differences, shape (rows, n).

    Args:
        effect: without discrepancy; parameter: of it.
        motion: whose rows are asked.
    """
    if effect.chain != "reading":
        return np.zeros((motion.rows, motion.n))
    value = value_of(effect, parameter)
    step = 1e-4 * max(abs(value), 1e-2)
    there = (with_value(effect, parameter, value + sign * step) for sign in (1.0, -1.0))
    up, down = (shown_of([one], motion) for one in there)
    return np.asarray((up - down) / (2.0 * step))
