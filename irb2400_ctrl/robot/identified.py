"""What is known of the numbers of a robot file once they have been identified: their covariance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np
from pydantic import Field, NonNegativeFloat, model_validator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.table import Table

DIGITS = 7
"""significant ones of the root: sums of numbers are known far better than each"""


class Identified(Table):
    """The covariance C = L L^T of the identified numbers, L lower triangular.

    The root keeps C positive however its digits are cut. `root` gives each number its row of L, as
    text: `m_1` [kg], `mx_1` [kg m], `Ixx_1` [kg m2] of the links about their frames' origins (the
    tool in the last one), `coulomb_1`, `offset_1` [Nm], `viscous_1` [Nm s/rad], `rotor_1` [kg m2].
    `left_Nm` is what the fit left of each joint on stretches which it had not seen, noise and the
    joint's turns apart; empty in files that do not say.
    """

    logs: tuple[str, ...] = ()
    left_Nm: tuple[NonNegativeFloat, ...] = ()
    root: dict[str, str] = Field(min_length=1)

    @model_validator(mode="after")
    def _triangular(self) -> Self:
        for place, (name, row) in enumerate(self.root.items()):
            try:
                values = [float(value) for value in row.split()]
            except ValueError:
                values = []
            if len(values) != place + 1 or not np.isfinite(values).all():
                raise ValueError(
                    f"root.{name}: expected the {place + 1} finite numbers of a triangular row"
                )
        return self

    @classmethod
    def of(
        cls,
        names: Sequence[str],
        covariance: Array,
        logs: Sequence[str] = (),
        left_Nm: Sequence[float] | Array = (),
    ) -> Identified:
        """Of a covariance (p, p) of numbers with these names.

        Args:
            names: of the numbers, as `root` has them.
            covariance: in their units squared, shape (p, p).
            logs: that they were identified from; left_Nm: of each joint, unseen.
        """
        size = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
        value, vector = np.linalg.eigh(covariance / np.outer(size, size))
        # what rounding has made negative is nothing
        root = vector * np.sqrt(np.maximum(value, 0.0))
        lower = np.transpose(np.linalg.qr(root.T)[1])
        lower = lower * np.where(np.diag(lower) < 0.0, -1.0, 1.0) * size[:, None]
        rows = {
            name: " ".join(f"{value:.{DIGITS - 1}e}" for value in lower[k, : k + 1])
            for k, name in enumerate(names)
        }
        left = tuple(float(f"{value:.3g}") for value in left_Nm)
        return cls(logs=tuple(logs), left_Nm=left, root=rows)

    def rows(self, names: Sequence[str]) -> Array:
        """Rows of L of some numbers, shape (len(names), p).

        Raises:
            InputError: one of them is not there.
        """
        found = np.zeros((len(names), len(self.root)))
        for place, name in enumerate(names):
            if name not in self.root:
                raise InputError(
                    f"[identified.root]: found no {name}; expected every body, friction, offset "
                    "and rotor, as `irb2400 identify` writes them; take the table out or identify "
                    "again"
                )
            values = [float(value) for value in self.root[name].split()]
            found[place, : len(values)] = values
        return found

    @property
    def standard_errors(self) -> dict[str, float]:
        """Of every number."""
        rows = self.rows(list(self.root))
        return dict(zip(self.root, np.linalg.norm(rows, axis=1).tolist(), strict=True))
