"""Commanded motions like those of the recorded arms: a periodic multi-sine, and rest-to-rest
moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .native import RECORD_RATE
from .parameters import RANGES, SPEEDS

# of the speed limits, as recorded
IDENTIFICATION_SHARE = 0.55
VALIDATION_SHARE = 0.5
# what the recorded arms use of their ranges: about 0.6 of axes 1, 2, 3, 4, 0.8 of axis 5, 0.4 of
# axis 6
WORK = RANGES * np.array([0.6, 0.62, 0.68, 0.63, 0.8, 0.405])[:, None]


@dataclass(frozen=True)
class Motion:
    """Commanded angles (n, 6) [rad] at 1 kHz from `start` [s] on; a run-up of `lead` seconds comes
    before."""

    start: float
    lead: float
    q: np.ndarray

    def with_derivatives(self, every: int = 4) -> tuple[float, np.ndarray]:
        """Sample time [s] and q, qd, qdd (m, 18) of the recorded part, for prescribed-motion
        torques."""
        dt = every / RECORD_RATE
        q = self.q[::every]
        qd = np.gradient(q, dt, axis=0)
        skip = round(self.lead / dt)
        return dt, np.hstack([q, qd, np.gradient(qd, dt, axis=0)])[skip:]


def _fit(shape: np.ndarray, box: np.ndarray, speed: float, rng: np.random.Generator) -> np.ndarray:
    """Shape (n,) scaled as far as range and speed let it, and set at a random place in the box."""
    shape = shape - (shape.max() + shape.min()) / 2
    widest = np.abs(np.diff(shape)).max() * RECORD_RATE
    scale = min((box[1] - box[0]) / np.ptp(shape), speed / widest)
    room = (box[1] - box[0] - scale * np.ptp(shape)) / 2
    return np.asarray(scale * shape + box.mean() + rng.uniform(-0.9, 0.9) * room)


def identification(
    rng: np.random.Generator,
    duration: float = 40.0,
    idle: tuple[int, ...] = (),
    chirp: bool = False,
) -> Motion:
    """A multi-sine (up to 0.42 Hz) on all axes but `idle` ones (1-6); optionally a 0.6-7 Hz chirp
    on top.

    The motion is periodic, so that the record begins in full motion, as the recorded ones do.
    """
    lead = 1.0
    period = 40.0
    time = np.arange(round((lead + duration) * RECORD_RATE) + 1) / RECORD_RATE - lead
    q = np.empty((len(time), 6))
    for j in range(6):
        harmonics = np.arange(1, 18)
        weight = rng.uniform(0.0, 1.0, 17) * np.exp(
            -(((harmonics - rng.uniform(2, 14)) / rng.uniform(3, 8)) ** 2)
        )
        phase = rng.uniform(0, 2 * np.pi, 17)
        shape = sum(
            w * np.sin(2 * np.pi * h / period * time + p)
            for h, w, p in zip(harmonics, weight, phase, strict=True)
        )
        speed = IDENTIFICATION_SHARE * SPEEDS[j] * rng.uniform(0.45, 1.0)
        q[:, j] = _fit(np.asarray(shape), WORK[j], speed, rng)
        if chirp:
            low = 0.6
            high = 7.0
            sweep = 2 * np.pi * (
                low * time + (high - low) / (2 * duration) * time**2
            ) + rng.uniform(0, 6.28)
            frequency = np.maximum(low + (high - low) / duration * time, low)
            amplitude = np.minimum(
                0.05 * SPEEDS[j], rng.uniform(2.5, 4.0) / (2 * np.pi * frequency)
            )
            q[:, j] += amplitude / (2 * np.pi * frequency) * np.sin(sweep)
        if j + 1 in idle:
            q[:, j] = q[0, j]
    return Motion(0.0, lead, q)


def validation(rng: np.random.Generator, duration: float = 30.0, start: float = 900.0) -> Motion:
    """Rest-to-rest moves of all axes (fifth-order polynomials) with short dwells, 15 minutes
    later."""
    lead = 1.0
    n = round((duration + lead) * RECORD_RATE) + 1
    box = 0.8 * WORK
    here = rng.uniform(box[:, 0], box[:, 1])
    pieces = [np.tile(here, (round((lead + 0.2) * RECORD_RATE), 1))]
    while sum(map(len, pieces)) < n:
        there = rng.uniform(box[:, 0], box[:, 1])
        needed = (1.875 * np.abs(there - here) / (VALIDATION_SHARE * SPEEDS)).max()
        s = np.linspace(0.0, 1.0, round(max(needed, 0.8) * RECORD_RATE))[:, None]
        pieces.append(here + (there - here) * s**3 * (10 - 15 * s + 6 * s**2))
        pieces.append(np.tile(there, (round(rng.uniform(0.2, 0.8) * RECORD_RATE), 1)))
        here = there
    return Motion(start, lead, np.vstack(pieces)[:n])
