"""The identification motion: each joint a sum of slow and a few quick harmonics of one period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arm import NOMINAL, SPEEDS, TORQUES
from .sensors import BEFORE, DT, FIRST, TIME
from .space import BOX, is_clear

SHARE = 0.78
"""of what the drives can give"""
RISE = 1.8
"""s, within which the motion comes up from rest"""


@dataclass(frozen=True)
class Waves:
    """Of one joint: centre [rad], frequencies [Hz], amplitudes [rad], phases [rad]."""

    centre: float
    frequencies: np.ndarray
    amplitudes: np.ndarray
    phases: np.ndarray


def _slow_waves(
    rng: np.random.Generator, joint: int, period: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float, float]:
    """Frequencies, relative amplitudes and phases of the large motion; what makes them angles; the
    middle and the width of what they sweep then."""
    orders = np.arange(1, int(0.8 * period) + 1)
    orders = orders[orders / period >= 0.05]
    time = np.arange(0, period, 0.01)[:, None]
    half = (BOX[joint, 1] - BOX[joint, 0]) / 2
    for _ in range(25):  # some draws sweep too little
        count = int(rng.integers(3, 7))
        chosen = rng.choice(orders, min(count, len(orders)), replace=False)
        chosen[0] = orders[int(rng.integers(0, max(1, len(orders) // 5)))]
        chosen = np.unique(chosen)
        f = chosen / period
        amplitudes = rng.uniform(0.3, 1, len(chosen)) / f**1.3
        phases = rng.uniform(0, 6.28, len(chosen))
        angle = (amplitudes * np.sin(2 * np.pi * time * f + phases)).sum(1)
        speed = (amplitudes * 2 * np.pi * f * np.cos(2 * np.pi * time * f + phases)).sum(1)
        middle = (angle.max() + angle.min()) / 2
        width = (angle.max() - angle.min()) / 2
        by_range = rng.uniform(0.6, 0.93) * half / width
        by_speed = rng.uniform(0.45, 0.8) * SPEEDS[joint] / np.abs(speed).max()
        scale = min(by_range, by_speed)
        if 2 * scale * width > (0.42 if joint == 0 else 0.5) * 2 * half:
            break
    return f, amplitudes, phases, scale, middle, width


def _drawn(rng: np.random.Generator, shrink: np.ndarray) -> tuple[float, list[Waves]]:
    period = float(rng.choice([10.0, 15.0, 20.0, 30.0]))
    waves = []
    for j in range(6):
        f, amplitudes, phases, scale, middle, width = _slow_waves(rng, j, period)
        scale *= shrink[j]
        count = int(rng.integers(2, 5))
        highest = int(rng.uniform(2.2, 4.0) * period)
        orders = rng.choice(np.arange(int(period), highest + 1), count, replace=False)
        quick = orders / period
        acceleration = (1.8 if j < 3 else 5.0) * rng.uniform(0.5, 1.2) * min(1, shrink[j])
        small = acceleration / np.sqrt(count) / (2 * np.pi * quick) ** 2
        slack = (BOX[j, 1] - BOX[j, 0]) / 2 - scale * width - small.sum()
        centre = BOX[j].mean() - middle * scale + slack * rng.uniform(-0.8, 0.8)
        waves.append(
            Waves(
                centre,
                np.concatenate([f, quick]),
                np.concatenate([amplitudes * scale, small]),
                np.concatenate([phases, rng.uniform(0, 6.28, count)]),
            )
        )
    return period, waves


def _evaluated(waves: list[Waves], time: np.ndarray) -> np.ndarray:
    """q, qd, qdd (n, 18)."""
    out = np.empty((len(time), 18))
    for j, wave in enumerate(waves):
        w = 2 * np.pi * wave.frequencies
        angle = np.outer(time, w) + wave.phases
        sine = np.sin(angle)
        out[:, j] = wave.centre + sine @ wave.amplitudes
        out[:, 6 + j] = np.cos(angle) @ (wave.amplitudes * w)
        out[:, 12 + j] = -sine @ (wave.amplitudes * w * w)
    return out


def _from_rest(waves: list[Waves]) -> np.ndarray:
    """Before the log the motion's clock comes up smoothly."""
    x = np.clip((TIME + BEFORE) / RISE, 0, 1)
    rate = x * x * (3 - 2 * x)
    rise = np.where(x < 1, 6 * x * (1 - x) / RISE, 0)
    clock = np.cumsum(rate) * DT
    out = _evaluated(waves, clock - clock[FIRST])
    out[:, 12:] = rate[:, None] ** 2 * out[:, 12:] + rise[:, None] * out[:, 6:12]
    out[:, 6:12] *= rate[:, None]
    return out


def excitation(rng: np.random.Generator, scale: float) -> np.ndarray:
    """The motion at 4 kHz (m, 18: q, qd, qdd), within box, speeds and torques; scale: of the
    amplitudes."""
    shrink = np.full(6, scale)
    for _ in range(400):
        period, waves = _drawn(rng, shrink)
        q, qd, qdd = np.split(_evaluated(waves, np.arange(0, period, 0.02)), 3, axis=1)
        if not is_clear(q):
            shrink[1:3] = np.maximum(0.45, shrink[1:3] * 0.97)
            continue
        load = np.abs(NOMINAL.torque(q, qd, qdd, 0, 0.02)).max(0) / TORQUES
        over = (load > SHARE) | (np.abs(qd).max(0) > 0.9 * SPEEDS)
        if over.any():
            shrink = np.where(over, shrink * 0.93, shrink)
            continue
        return _from_rest(waves)
    raise RuntimeError("no motion within the limits in 400 draws")
