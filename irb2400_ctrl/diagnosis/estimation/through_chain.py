"""What the measuring chain makes of the torque of a base that moves: a gain multiplies that too, a
clock that is late tells it later."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.effect_parameters import (
    Parameter,
    slope_of,
    small_step,
    value_of,
)
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog


@dataclass(frozen=True)
class MovedBase:
    """A base where it has moved to.

    Args:
        motion: the log, prepared.
        rows: its torque, filtered, shape (rows, n) [Nm]; samples: that of the robot's numbers at
            every sample, (m, n) [Nm]; None where nothing is known of it.
    """

    motion: PreparedLog
    rows: Array
    samples: Array | None

    def later(self, effects: Sequence[Effect]) -> Array:
        """What clocks change of it, filtered, shape (rows, n) [Nm]; `effects`: of the arm."""
        if self.samples is None or all(e.chain != "clock" for e in effects):
            return np.zeros((self.motion.rows, self.motion.n))
        return self.motion.filtered(delayed(effects, self.samples, self.motion))

    def slope(self, effect: Effect, parameter: Parameter) -> Array:
        """d of what the chain shows of it / d parameter of an effect, filtered, (rows, n)."""
        if effect.chain == "clock" and self.samples is not None:
            return slope_of_delayed(effect, parameter, self.samples, self.motion)
        return np.asarray(self.rows * slope_of_shown(effect, parameter, self.motion))


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
    step = small_step(value_of(effect, parameter))
    return slope_of(effect, parameter, step, lambda one: shown_of([one], motion))


def delayed(effects: Sequence[Effect], torque: Array, motion: PreparedLog) -> Array:
    """By how much what the clocks show of a torque differs from it, shape (m, n) [Nm].

    Args:
        effects: of which those of the clock count.
        torque: at the samples, shape (m, n) [Nm].
        motion: the log, prepared.
    """
    shown = torque
    for effect in effects:
        if effect.chain == "clock":
            shown = effect.reported(motion.time, shown)
    return np.asarray(shown - torque)


def slope_of_delayed(
    effect: Effect, parameter: Parameter, torque: Array, motion: PreparedLog
) -> Array:
    """d delayed / d parameter by central differences, filtered, shape (rows, n).

    Args:
        effect: of the clock; parameter: of it.
        torque: at the samples, shape (m, n) [Nm].
        motion: the log, prepared.
    """
    step = 0.1 * motion.step
    rate = slope_of(effect, parameter, step, lambda one: delayed([one], torque, motion))
    return motion.filtered(rate)
