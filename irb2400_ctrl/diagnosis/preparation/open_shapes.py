"""What an identification leaves open of the shape of an effect that it has found.

`identify` fits how strong a balancer or a hose is, along a law whose other numbers are usual ones.
The arm's own departs from that by the columns of its discrepancy, as one that is found here may,
and another motion shows it: that is no second effect beside the first, and none has changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

IDENTIFIED = "identified"
"""the source of what an identification has found"""


@dataclass(frozen=True)
class OpenShapes:
    """Discrepancies of effects, one number a column.

    Args:
        columns: d tau / d z along a motion, z a unit normal, shape (m, n, k) [Nm].
        places: of these among the robot's effects; units: of the discrepancy of each, per unit of
            z.
    """

    columns: Array
    places: tuple[int, ...] = ()
    units: tuple[Array, ...] = ()

    @classmethod
    def of(cls, bases: Bases, robot: Robot, motion: PreparedLog) -> OpenShapes:
        """Those of a robot's effects along a motion.

        Args:
            bases: of its bare arm; robot: with its effects.
            motion: of the log.
        """
        places = [
            place
            for place, effect in enumerate(robot.effects)
            if effect.source == IDENTIFIED and effect.nonlinear and not effect.states
        ]
        columns = [np.zeros((len(motion.time), motion.n, 0))]
        units = []
        for effect in (robot.effects[place] for place in places):
            law, off = (
                bases.of(effect, motion, discrepancy=which, filtered=False)
                for which in (False, True)
            )
            size = rms((law.values @ np.array(effect.coefficients())).ravel())
            kept = off.values[:, :, : effect.prior.kept(off.values.shape[2])]
            sizes = np.sqrt(np.mean(kept**2, axis=(0, 1)))
            units.append(effect.prior.departure * size / np.maximum(sizes, 1e-12))
            placed = np.zeros((*columns[0].shape[:2], len(units[-1])))
            placed[:, list(off.joints)] = kept * units[-1]
            columns.append(placed)
        return cls(np.concatenate(columns, axis=2), tuple(places), tuple(units))

    @property
    def count(self) -> int:
        """How many numbers."""
        return int(self.columns.shape[2])

    def written(self, effects: Sequence[Effect], z: Array) -> list[Effect]:
        """A robot's effects with these numbers, shape (k,), in the place of those of the file."""
        firsts = np.cumsum([0, *map(len, self.units)])[:-1]
        found = list(effects)
        for place, unit, first in zip(self.places, self.units, firsts, strict=True):
            effect = found[place]
            shape = unit * z[first : first + len(unit)]
            shape[: len(effect.discrepancy)] += effect.discrepancy
            found[place] = effect.model_copy(update={"discrepancy": tuple(shape.tolist())})
        return found
