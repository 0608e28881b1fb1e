"""What a controller's data stream makes of the truth: rate, digits, jitter, losses, noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from independent_plant import Log

from .machine import RATE

TORQUE_NOISE = (1.2, 2.0, 1.2, 0.35, 0.3, 0.3)


@dataclass(frozen=True)
class Reading:
    """Conditions of one log.

    Args:
        rate: of the stream [Hz]; 1000 is a multiple of it, as near as that goes.
        jitter: rms of what the printed stamps are off the even instants [s].
        angle_step, angle_noise, speed_noise: [rad], [rad], [rad/s].
        torque_noise: rms of six axes [Nm]; torque_step: of their digits [Nm].
        white_share: of the torque noise's variance; the rest is of first order, `colour_time` [s].
        lost: share of samples that never arrive; burst: how many in a row on average.
        with_reference: whether the commanded motion is in the log.
    """

    rate: float = 250.0
    jitter: float = 0.0
    angle_step: float = 5e-6
    angle_noise: float = 2e-6
    speed_noise: float = 4e-4
    torque_noise: tuple[float, ...] = TORQUE_NOISE
    torque_step: tuple[float, ...] = (0.0,) * 6
    white_share: float = 0.7
    colour_time: float = 0.012
    lost: float = 0.002
    burst: float = 1.0
    with_reference: bool = True

    @property
    def every(self) -> int:
        """Records of 1 kHz to a sample."""
        return round(RATE / self.rate)

    def torque_errors(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Coloured torque noise (n, 6)."""
        from scipy.signal import lfilter

        pole = np.exp(-self.every / RATE / self.colour_time)
        white = rng.standard_normal((2, n + 200, 6))
        slow = lfilter([np.sqrt(1 - pole**2)], [1, -pole], white[0], axis=0)
        mixed = np.sqrt(self.white_share) * white[1] + np.sqrt(1 - self.white_share) * slow
        return np.asarray(np.asarray(self.torque_noise) * mixed[200:])

    def arrived(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Which samples are in the log (n,): losses begin at random and last for a while."""
        begins = rng.uniform(size=n) < self.lost / self.burst
        kept = np.ones(n, dtype=bool)
        for k in np.flatnonzero(begins):
            kept[k : k + rng.geometric(1.0 / self.burst)] = False
        kept[[0, -1]] = True
        return kept

    def read(
        self, rng: np.random.Generator, time: np.ndarray, record: np.ndarray, reference: np.ndarray
    ) -> Log:
        """Of records (m, 18) and commands (m, 6) at 1 kHz; stamps rise whatever the jitter."""
        record = record[:: self.every]
        n = len(record)
        q = record[:, :6] + self.angle_noise * rng.standard_normal((n, 6))
        q = self.angle_step * np.round(q / self.angle_step)
        qd = record[:, 6:12] + self.speed_noise * rng.standard_normal((n, 6))
        tau = record[:, 12:] + self.torque_errors(rng, n)
        step = np.asarray(self.torque_step)
        digits = np.where(step > 0.0, step, 1.0)
        tau = np.where(step > 0.0, digits * np.round(tau / digits), tau)
        width = np.sqrt(3.0) * self.jitter
        stamps = np.sort(time[:: self.every] + rng.uniform(-width, width, n))
        kept = self.arrived(rng, n)
        q_ref = reference[:: self.every]
        return Log(stamps[kept], q[kept], qd[kept], tau[kept], q_ref[kept])
