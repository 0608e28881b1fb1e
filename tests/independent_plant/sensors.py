"""What a controller's data stream does to the truth: quantisation, noise, a grid of 4 ms, lost
samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEP = 4  # records at 1 kHz to the 250 Hz of the stream


@dataclass(frozen=True)
class Sensors:
    """Sizes as measured on the recorded arms.

    Args:
        angle_step, angle_noise: encoder resolution and noise [rad].
        speed_noise: [rad/s].
        torque_noise: rms of six axes [Nm]; a share of it white, the rest of first order.
        white_share: share of the noise's variance that is white.
        colour_time: correlation time of that rest [s].
        lost: share of samples that never arrive.
    """

    angle_step: float = 5e-6
    angle_noise: float = 2e-6
    speed_noise: float = 4e-4
    torque_noise: tuple[float, ...] = (1.2, 2.0, 1.2, 0.35, 0.3, 0.3)
    white_share: float = 0.7
    colour_time: float = 0.012
    lost: float = 0.002

    def torque_errors(self, rng: np.random.Generator, n: int) -> np.ndarray:
        """Coloured torque noise (n, 6) at 250 Hz."""
        from scipy.signal import lfilter

        pole = np.exp(-STEP / 1000 / self.colour_time)
        slow = lfilter(
            [np.sqrt(1 - pole**2)], [1, -pole], rng.standard_normal((n + 200, 6)), axis=0
        )[200:]
        white = rng.standard_normal((n, 6))
        mixed = np.sqrt(self.white_share) * white + np.sqrt(1 - self.white_share) * slow
        return np.asarray(np.asarray(self.torque_noise) * mixed)

    def read(
        self, rng: np.random.Generator, time: np.ndarray, record: np.ndarray, reference: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Time, q, qd, tau, q_ref as the stream gives them, from records at 1 kHz."""
        sample = slice(None, None, STEP)
        q = record[sample, :6]
        qd = record[sample, 6:12]
        tau = record[sample, 12:]
        n = len(q)
        q = (
            np.round((q + self.angle_noise * rng.standard_normal((n, 6))) / self.angle_step)
            * self.angle_step
        )
        qd = qd + self.speed_noise * rng.standard_normal((n, 6))
        tau = tau + self.torque_errors(rng, n)
        kept = rng.uniform(size=n) >= self.lost
        kept[[0, -1]] = True
        return (
            time[sample][kept],
            q[kept],
            qd[kept],
            tau[kept],
            reference[: len(record)][sample][kept],
        )
