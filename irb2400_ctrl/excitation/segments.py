"""Smooth pieces of motion from rest to rest, drawn at random: finite Fourier series under a smooth
window.

    q_j(t) = c_j + w(t) sum_k a_jk sin(2 pi (f_jk t + r_jk t^2 / 2) + p_jk)

w rises from 0 to 1 and falls back as a polynomial of degree 7, so that speed and acceleration begin
and end at zero, at the centre c. r is zero but for chirps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.excitation.feasible import SHARE
from irb2400_ctrl.robot import Robot

RISE = 0.8
"""[s] from rest to the full series"""
INSET = 0.05
"""share of each joint's range kept free at either end"""


CARRIER = 0.15
"""[Hz] of a swing that carries fast pieces"""


@dataclass(frozen=True)
class Flavour:
    """A kind of piece.

    Args:
        low, high: band of the base frequencies [Hz], drawn evenly over its logarithm; terms: per
            joint.
        top: end of a chirp [Hz], 0 for none.
        moving: share of the axes that move (the others rest), at least one.
        size: range of the amplitude over what the limits allow.
        carried: ride on a wide, slow swing, so that the joint seldom turns (rows about a reversal
            tell little).
    """

    name: str
    low: float
    high: float
    terms: int
    top: float = 0.0
    moving: float = 1.0
    size: tuple[float, float] = (0.5, 1.0)
    carried: bool = False


FLAVOURS: dict[str, Flavour] = {
    f.name: f
    for f in (
        Flavour("swing", 0.1, 0.5, 3),
        Flavour("lively", 0.4, 1.5, 3),
        Flavour("fast", 1.0, 3.0, 2, carried=True),
        Flavour("chirp", 0.4, 1.0, 1, top=6.0, carried=True),
        Flavour("slow", 0.03, 0.12, 1, size=(0.1, 1.0)),
        # neighbouring frequencies beat: reversals at many amplitudes
        Flavour("reversals", 0.3, 0.6, 2, size=(0.02, 0.5)),
        Flavour("alone", 0.2, 1.5, 3, moving=0.3),
    )
}


@dataclass(frozen=True)
class Piece:
    """One piece; amplitude, frequency, chirp rate, phase have shape (terms, n) [rad, Hz, Hz/s,
    rad]."""

    flavour: str
    centre: Array
    amplitude: Array
    frequency: Array
    chirp: Array
    phase: Array

    def scaled(self, factor: Array | float) -> Piece:
        """With amplitudes times a factor, shape (n,) or ()."""
        return replace(self, amplitude=self.amplitude * factor)

    def states(self, duration: float, time: Array) -> tuple[Array, Array, Array]:
        """q, qd, qdd at the times [s], (m, n) each."""
        t = time[:, None, None]
        angle = 2 * np.pi * (self.frequency * t + 0.5 * self.chirp * t**2) + self.phase
        rate = 2 * np.pi * (self.frequency + self.chirp * t)
        sine = np.sin(angle)
        cosine = np.cos(angle)
        bend = 2 * np.pi * self.chirp * cosine - rate**2 * sine
        a = self.amplitude
        s = (a * sine).sum(axis=1)
        sd = (a * rate * cosine).sum(axis=1)
        sdd = (a * bend).sum(axis=1)
        w, wd, wdd = (v[:, None] for v in _window(time, duration))
        q = self.centre + w * s
        qd = wd * s + w * sd
        qdd = wdd * s + 2 * wd * sd + w * sdd
        return q, qd, qdd


def _window(time: Array, duration: float) -> tuple[Array, Array, Array]:
    """Window and its two derivatives."""
    rise = min(RISE, duration / 3)
    up = np.clip(time / rise, 0.0, 1.0)
    down = np.clip((duration - time) / rise, 0.0, 1.0)
    (a, ad, add) = _step(up)
    (b, bd, bdd) = _step(down)
    bd = -bd
    return a * b, (ad * b + a * bd) / rise, (add * b + 2 * ad * bd + a * bdd) / rise**2


def _step(x: Array) -> tuple[Array, Array, Array]:
    """Polynomial from 0 to 1 with three vanishing derivatives at both ends, and its first two."""
    value = x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)
    return value, 140 * x**3 * (1 - x) ** 3, 420 * x**2 * (1 - x) ** 2 * (1 - 2 * x)


def allowed(
    robot: Robot, piece: Piece, duration: float, room: Array, share: float, instants: int = 400
) -> Array:
    """What the amplitudes of each joint may be multiplied by, shape (n,).

    Args:
        robot: whose limits of speed and acceleration are kept.
        piece: as it is.
        duration: [s].
        room: about its centre [rad], shape (n,).
        share: of the limits that is used.
        instants: that are looked at.
    """
    q, qd, qdd = piece.states(duration, np.linspace(0.0, duration, instants))
    bends = AccelerationLimits.of(robot).values
    least = np.full((3, robot.n), np.inf)
    for factor, values, most in zip(
        least, (q - piece.centre, qd, qdd), (room, share * robot.qd_max, share * bends), strict=True
    ):
        factor[:] = most / np.maximum(np.abs(values).max(axis=0), 1e-12)
    return np.asarray(least.min(axis=0))


def drawn(
    rng: np.random.Generator,
    robot: Robot,
    flavour: Flavour,
    duration: float,
    joint: int | None = None,
) -> Piece:
    """A random piece that keeps the joint box and the limits of speed and acceleration; `joint`
    (from 1) always moves.

    Args:
        rng: of the draw.
        robot: whose box and limits it keeps.
        flavour: what kind of piece.
        duration: [s].
        joint: from 1; None: whichever.
    """
    n = robot.n
    low = robot.q_min
    high = robot.q_max
    span = high - low
    centre = low + span * rng.uniform(0.15, 0.85, n)
    # turns of an axis beyond a half one add nothing to the torque
    room = np.minimum(np.minimum(centre - low, high - centre) - INSET * span, np.pi)
    frequency = np.exp(rng.uniform(np.log(flavour.low), np.log(flavour.high), (flavour.terms, n)))
    chirp = np.full_like(frequency, (flavour.top - flavour.low) / duration if flavour.top else 0.0)
    amplitude = rng.dirichlet(np.full(flavour.terms, 2.0), n).T
    if flavour.carried:
        # shares of the speed, not of the way: the swing is the faster one most of the time
        amplitude *= (
            rng.uniform(0.2, 0.8, n) * CARRIER / frequency / (1 + flavour.top / flavour.low / 3)
        )
        frequency = np.vstack([rng.uniform(0.7, 1.3, n) * CARRIER, frequency])
        amplitude = np.vstack([np.ones(n), amplitude])
        chirp = np.vstack([np.zeros(n), chirp])
    phase = rng.uniform(0, 2 * np.pi, frequency.shape)
    piece = Piece(flavour.name, centre, amplitude, frequency, chirp, phase)
    factor = rng.uniform(*flavour.size, n) * allowed(robot, piece, duration, room, SHARE)
    moving = rng.uniform(size=n) < flavour.moving
    moving[rng.integers(n) if joint is None else joint - 1] = True
    return piece.scaled(factor * moving)


def mutated(
    rng: np.random.Generator, robot: Robot, piece: Piece, duration: float, share: float = 0.25
) -> Piece:
    """A neighbour of a piece: everything moved a little; keeps box and limits like `drawn`.

    Args:
        rng: of the draw.
        robot: whose box and limits it keeps.
        piece: to begin with.
        duration: [s].
        share: by which all is moved [-].
    """
    span = robot.q_max - robot.q_min
    shape = piece.amplitude.shape
    centre = piece.centre + 0.15 * share * span * rng.standard_normal(robot.n)
    centre = np.clip(centre, robot.q_min + 0.15 * span, robot.q_max - 0.15 * span)
    new = replace(
        piece,
        centre=centre,
        amplitude=piece.amplitude * np.exp(share * rng.standard_normal(shape)),
        frequency=piece.frequency * np.exp(share * rng.standard_normal(shape)),
        phase=piece.phase + share * rng.standard_normal(shape),
    )
    room = np.minimum(centre - robot.q_min, robot.q_max - centre) - INSET * span
    return new.scaled(np.minimum(1.0, allowed(robot, new, duration, room, SHARE)))
