"""The validation motion: moves from point to point, three kinds of profile, a slow stretch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arm import NOMINAL, SPEEDS, TORQUES
from .sensors import DURATION, TIME
from .space import BOX, is_clear

ACCELERATIONS = np.array([4, 4, 5, 16, 16, 22.0])
NEAR = np.radians([8, 6, 6, 14, 12, 20])
SHARE = 0.8
"""of what the drives can give"""
_RAMP = 0.35
"""share of a move with cosine ramps"""


def profile(kind: int, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place, speed, acceleration of a unit move over u in [0, 1]: of order 5 (0), 7 (1), or cosine
    ramps with a constant speed between (2)."""
    if kind == 0:
        return (
            10 * u**3 - 15 * u**4 + 6 * u**5,
            30 * u**2 - 60 * u**3 + 30 * u**4,
            60 * u - 180 * u**2 + 120 * u**3,
        )
    if kind == 1:
        return (
            35 * u**4 - 84 * u**5 + 70 * u**6 - 20 * u**7,
            140 * u**3 - 420 * u**4 + 420 * u**5 - 140 * u**6,
            420 * u**2 - 1680 * u**3 + 2100 * u**4 - 840 * u**5,
        )
    top = 1 / (1 - _RAMP)
    up = u < _RAMP
    down = u > 1 - _RAMP
    place = top * _RAMP / 2 + top * (u - _RAMP)
    speed = np.full_like(u, top)
    acceleration = np.zeros_like(u)
    place[up], speed[up], acceleration[up] = _ramp(u[up], top)
    left, slower, braking = _ramp(1 - u[down], top)
    place[down] = 1 - left
    speed[down] = slower
    acceleration[down] = -braking
    return place, speed, acceleration


def _ramp(x: np.ndarray, top: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    w = np.pi / _RAMP
    return (
        top * (x / 2 - np.sin(w * x) / 2 / w),
        top * (1 - np.cos(w * x)) / 2,
        top * w * np.sin(w * x) / 2,
    )


@dataclass(frozen=True)
class Pace:
    """Of the moves: share of the speed limits, accelerations, when they are small and slow."""

    speed: float
    acceleration: np.ndarray
    slow_from: float
    slow_until: float

    def is_slow(self, time: float) -> bool:
        """Whether a move that begins then is."""
        return self.slow_from <= time < self.slow_until


def _anywhere(rng: np.random.Generator) -> np.ndarray:
    low, high = BOX.T
    while True:
        q = (low + high) / 2 + (high - low) / 2 * rng.uniform(-0.85, 0.85, 6)
        if is_clear(q[None]):
            return np.asarray(q)


def _nearby(rng: np.random.Generator, near: np.ndarray) -> np.ndarray:
    while True:
        q = np.clip(near + NEAR * rng.uniform(-1, 1, 6), *BOX.T)
        if is_clear(q[None]):
            return np.asarray(q)


def _goal(
    rng: np.random.Generator, q: np.ndarray, slow: bool, pace: Pace
) -> tuple[np.ndarray, float] | None:
    """Where to, and for how long; none where the way is blocked."""
    if slow:
        return _nearby(rng, q), rng.uniform(1.2, 3.2)
    goal = _anywhere(rng)
    goal = q + (goal - q) * rng.uniform(0.35, 1)
    if not is_clear(goal[None]):
        return None
    if rng.uniform() < 0.25:  # some joints rest
        goal = np.where(rng.uniform(size=6) < 0.5, goal, q)
    way = np.abs(goal - q)
    by_speed = (way / (pace.speed * SPEEDS)).max() * 1.9
    by_acceleration = np.sqrt(way * 6.0 / pace.acceleration).max()
    return goal, max(0.5, by_speed, by_acceleration) * rng.uniform(1, 1.3)


def _move(
    rng: np.random.Generator, q: np.ndarray, slow: bool, pace: Pace
) -> tuple[np.ndarray, float, int]:
    """Goal, duration and kind of profile of a move that the drives can make; of 300 draws at most,
    else a rest."""
    u = np.linspace(0, 1, 60)
    for _ in range(300):
        found = _goal(rng, q, slow, pace)
        if found is None:
            continue
        goal, duration = found
        kind = int(rng.integers(3))
        place, speed, acceleration = profile(kind, u)
        path = q + np.outer(place, goal - q)
        if not is_clear(path):
            continue
        qd = np.outer(speed, goal - q) / duration
        qdd = np.outer(acceleration, goal - q) / duration**2
        if (np.abs(NOMINAL.torque(path, qd, qdd, 0, duration / 59)) < SHARE * TORQUES).all():
            return goal, duration, kind
    return q, 0.5, 0


def moves(rng: np.random.Generator, scale: float) -> np.ndarray:
    """The motion at 4 kHz (m, 18: q, qd, qdd); scale: of speeds and accelerations."""
    out = np.zeros((len(TIME), 18))
    fast = rng.uniform(0.35, 0.8) * scale
    q = _anywhere(rng)
    time = 0.3
    out[:, :6] = q
    begins_slowly = rng.uniform(0, 1) < 0.4
    slow_from = 0.0 if begins_slowly else rng.uniform(21, 23)
    slow_until = rng.uniform(4, 6) if begins_slowly else np.inf
    pace = Pace(fast, ACCELERATIONS * scale, slow_from, slow_until)
    while time < DURATION:
        goal, duration, kind = _move(rng, q, pace.is_slow(time), pace)
        during = (time <= TIME) & (time + duration > TIME)
        place, speed, acceleration = profile(kind, (TIME[during] - time) / duration)
        out[during, :6] = q + np.outer(place, goal - q)
        out[during, 6:12] = np.outer(speed, goal - q) / duration
        out[during, 12:] = np.outer(acceleration, goal - q) / duration**2
        out[time + duration <= TIME, :6] = goal
        q = goal
        time += duration + (rng.uniform(0.05, 0.5) if rng.uniform() < 0.8 else 0)
    return out
