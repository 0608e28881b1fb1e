"""The model about some effects as they are: what a step of Gauss-Newton is taken from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.effect_parameters import Parameter
from irb2400_ctrl.diagnosis.estimation.posterior import Posterior
from irb2400_ctrl.diagnosis.preparation.noise import Noise


@dataclass
class Linearised:
    """y = X b + e about some effects.

    Args:
        y: residual of the exact prediction, shape (rows, n) [Nm].
        columns: X with unit priors, (rows, n, k): of the base, the parameters, the rest.
        base: number of columns of the base.
        parameters: natural ones of the effects; sizes: of their columns, in their units.
        shapes: units of each effect's discrepancy.
    """

    y: Array
    columns: Array
    base: int
    parameters: list[Parameter]
    sizes: Array
    shapes: list[Array]
    _last: tuple[tuple[Noise, ...], Posterior] | None = None

    @property
    def own(self) -> slice:
        """Columns of the parameters."""
        return slice(self.base, self.base + len(self.parameters))

    def under(self, noise: tuple[Noise, ...]) -> Posterior:
        """Of all columns; the last one is kept."""
        if self._last is None or self._last[0] is not noise:
            self._last = noise, Posterior(self.y, self.columns, noise)
        return self._last[1]

    def left(self, noise: tuple[Noise, ...]) -> Array:
        """What everything together leaves, shape (rows, n) [Nm]."""
        return np.asarray(self.y - self.columns @ self.under(noise).mean)

    def misfit(self, noise: tuple[Noise, ...]) -> float:
        """Whitened sum of squares left where all but the parameters is fitted."""
        free = np.ones(self.columns.shape[2], dtype=bool)
        free[self.own] = False
        return self.under(noise).misfit(free)
