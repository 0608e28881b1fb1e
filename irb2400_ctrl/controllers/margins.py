"""Stability margins read off a frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.arrays import Array

Response = NDArray[np.complex128]


def times(down: float, up: float) -> str:
    """Gain margins in words; either side may be open."""
    if down < 0.005:
        return "any" if np.isinf(up) else f"up to {up:.3g} times"
    return f"{down:.2f} times or more" if np.isinf(up) else f"{down:.2f} to {up:.3g} times"


@dataclass(frozen=True)
class Margins:
    """Margins of one loop L, negative feedback.

    Attributes:
        gain_up: factor by which the gain may grow (inf: any).
        gain_down: factor to which it may fall (0: any).
        phase: [rad], smallest over all crossovers.
        delay: further dead time the loop survives [s].
        crossover: highest angular frequency with |L| = 1 [rad/s].
        sensitivity: peak of |1 / (1 + L)| [-].
    """

    gain_up: float
    gain_down: float
    phase: float
    delay: float
    crossover: float
    sensitivity: float

    def __str__(self) -> str:
        return (
            f"gain {times(self.gain_down, self.gain_up)}, phase "
            f"{np.degrees(self.phase):.0f} deg, "
            f"delay {1e3 * self.delay:.1f} ms, crossover {self.crossover:.0f} rad/s, Ms "
            f"{self.sensitivity:.2f}"
        )


def margins(omega: Array, L: Response) -> Margins:
    """Margins of the loop whose response at the angular frequencies `omega` [rad/s] is L, both
    shape (k,)."""
    magnitude = np.abs(L)
    # a controller without gains has none of its own
    level = np.log(np.maximum(magnitude, np.finfo(float).tiny))
    cross = np.flatnonzero(np.diff(np.sign(level)) != 0)
    share = level[cross] / (level[cross] - level[cross + 1])
    w = omega[cross] * (omega[cross + 1] / omega[cross]) ** share
    # angle of -L: zero at the critical point; interpolated on the unwrapped phase
    turned = np.unwrap(np.angle(-L))
    angle = turned[cross] + share * (turned[cross + 1] - turned[cross])
    angle = np.angle(np.exp(1j * angle))
    real = L.real
    imag = L.imag
    flips = np.flatnonzero((np.diff(np.sign(imag)) != 0) & (real[:-1] < 0) & (real[1:] < 0))
    part = imag[flips] / (imag[flips] - imag[flips + 1])
    gains = 1.0 / np.abs(real[flips] + part * (real[flips + 1] - real[flips]))
    return Margins(
        gain_up=float(gains[gains > 1].min(initial=np.inf)),
        gain_down=float(gains[gains < 1].max(initial=0.0)),
        phase=float(np.abs(angle).min(initial=np.pi)),
        delay=float((np.mod(angle, 2 * np.pi) / w).min(initial=np.inf)),
        crossover=float(w.max(initial=0.0)),
        sensitivity=float(np.abs(1.0 / (1.0 + L)).max()),
    )


def frequencies(sample_time: float, count: int = 4000) -> Array:
    """Angular frequencies [rad/s] from 0.1 rad/s to just below half the sampling rate."""
    return np.geomspace(0.1, 0.999 * np.pi / sample_time, count)


def response_of(system: Any, z: Response) -> Response:
    """C (z - A)^-1 B + D of a `control.StateSpace` at z (k,), shape (k, outputs, inputs)."""
    inside = z[:, None, None] * np.eye(len(system.A)) - system.A
    return np.asarray(system.C @ np.linalg.solve(inside, system.B) + system.D)
