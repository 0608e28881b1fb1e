"""How far the robot's numbers moved together as one law of torque moves them, as one number.

With the numbers as uncertain as they are taken, torques y ~ N(0, 1 + Z Z^T) where all is as stated
and N(X a, 1 + Z Z^T) where it moved by an amount a along the law's torque X, so that

    T = X^T P y / (X^T P X)^(1/2),    P = (1 + Z Z^T)^-1

is a standard normal variable where it did not, and a = X^T P y / X^T P X. As everywhere, errors
that come from the noise are taken `INFLATION` times as large, k: the variance of X^T P y is
X^T P (k^2 + Z Z^T) P X then, and k^2 X^T P X where the numbers themselves come from the noise of a
reference's logs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns

TOLD = 3.0
"""standard deviations of T: beyond them are 0.27 % of the arms whose numbers are as stated"""
NOTHING = 1e-12
"""information of a law that no row shows"""


@dataclass(frozen=True)
class Moved:
    """Along one law.

    Args:
        amount: a, in the law's unit; standard_error: of it.
        sigmas: T.
        information: X^T P X, in standard deviations of the noise, squared.
    """

    amount: float
    standard_error: float
    sigmas: float
    information: float


class OneNumber:
    """Asks it of one law after another, each beside nothing but the numbers of the robot."""

    def __init__(self, fitter: Fitter, fit: Fit) -> None:
        """Args: fitter: of the robot given; fit: of all that was found."""
        self._n = fitter.motion.n
        self._noise = fit.noise
        self._y = fit.y
        self._Z = fit.Z.copy()
        self._Z[:, :, : fitter.own] *= fitter.widened
        self._problem = Problem(fit.y, self._Z, fit.noise)

    def along(self, columns: RegressorColumns, *, all_noise: bool = False) -> Moved:
        """How far they moved along a law.

        Args:
            columns: one.
            all_noise: whether the numbers are no more sure than the noise of a reference's logs.
        """
        gram, right = self._problem.projected(columns)
        information = max(float(gram[0, 0]), NOTHING)
        by_noise = information if all_noise else self._by_noise(columns)
        spread = float(np.sqrt(information + (INFLATION**2 - 1.0) * by_noise))
        shift = float(right[0])
        return Moved(shift / information, spread / information, shift / spread, information)

    def as_given(self, columns: RegressorColumns) -> float:
        """X^T y / X^T X over the noise: the amount with all numbers as they are given.

        Args:
            columns: one.
        """
        blocks = [(j, x[:, 0]) for j, x in self._problem.whitened(columns)]
        along = sum(float(x @ self._noise[j].whiten(self._y[:, j])) for j, x in blocks)
        return along / max(sum(float(x @ x) for _, x in blocks), NOTHING)

    def _by_noise(self, columns: RegressorColumns) -> float:
        """X^T P P X."""
        torque = columns.torque(np.ones(1), self._n)
        left = torque - self._Z @ (self._problem.z - self._problem.base_beside(torque))
        return float(sum(np.sum(n.whiten(left[:, j]) ** 2) for j, n in enumerate(self._noise)))
