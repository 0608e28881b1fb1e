"""What the drive's reading makes of the torque of a base that moves: a gain multiplies that too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.effect_parameters import Parameter, value_of, with_value
from irb2400_ctrl.effects import Effect


def shown_of(effects: Sequence[Effect], time: Array, n: int) -> Array:
    """By how much the reading of each joint grows with its torque, shape (rows, n).

    Args:
        effects: without discrepancy, so that the reading is linear in the torque.
        time: of the rows [s].
        n: joints.
    """
    shown = np.ones((len(time), n))
    for effect in effects:
        if effect.chain == "reading":
            readings = (effect.reported(time, np.full((len(time), n), tau)) for tau in (1.0, 0.0))
            shown *= np.subtract(*readings)
    return shown


def slope_of_shown(effect: Effect, parameter: Parameter, time: Array, n: int) -> Array:
    """d shown / d parameter by central differences, shape (rows, n); arguments as of `shown_of`,
    `parameter`: of the effect."""
    if effect.chain != "reading":
        return np.zeros((len(time), n))
    value = value_of(effect, parameter)
    step = 1e-4 * max(abs(value), 1e-2)
    there = (with_value(effect, parameter, value + sign * step) for sign in (1.0, -1.0))
    up, down = (shown_of([one], time, n) for one in there)
    return np.asarray((up - down) / (2.0 * step))
