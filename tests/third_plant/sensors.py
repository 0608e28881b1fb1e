"""What the drives and encoders make of the truth: laws of the measuring chain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FINE = 4000
"""Hz, of the simulation"""
RATE = 250
"""Hz, of the log"""
DT = 1 / FINE
EVERY = FINE // RATE
BEFORE = 3.0
AFTER = 0.05
DURATION = 30.0
"""s, of the log, and of what is simulated before and after it"""
TIME = np.arange(-int(BEFORE / DT), int((DURATION + AFTER) / DT) + 1) * DT
FIRST = int(BEFORE / DT)
SAMPLES = int(DURATION * RATE) + 1
SHOWN = FIRST + EVERY * np.arange(SAMPLES)
"""records of the simulation that are in the log"""


def later(x: np.ndarray, n: int) -> np.ndarray:
    """By n records; earlier where n is negative."""
    if n == 0:
        return x
    if n > 0:
        return np.concatenate([np.repeat(x[:1], n, 0), x[:-n]])
    return np.concatenate([x[-n:], np.repeat(x[-1:], -n, 0)])


@dataclass(frozen=True)
class Channel:
    """A law of the measuring chain on a joint (from 0); this one does nothing."""

    joint: int

    def at_drive(self, tau: np.ndarray) -> np.ndarray:
        """Torque of the joint (m,) at 4 kHz."""
        return tau

    def in_log(self, time: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Torques of all joints (n, 6) at 250 Hz."""
        return tau

    def seen(self, x: np.ndarray, order: int) -> np.ndarray:
        """Angle of the joint (m,) at 4 kHz, or its derivative of that order."""
        return x

    def unseen(self, x: np.ndarray, order: int) -> np.ndarray:
        """The true one of what is seen."""
        return x


@dataclass(frozen=True)
class Gain(Channel):
    """tau (1 + share)."""

    share: float

    def at_drive(self, tau: np.ndarray) -> np.ndarray:
        """More or less of it."""
        return tau * (1 + self.share)


@dataclass(frozen=True)
class Saturation(Channel):
    """tau (1 + share y^exponent), y = (|tau| - knee) / (knee / 0.35): a motor whose current grows
    more than its torque."""

    share: float
    knee: float
    exponent: float

    def at_drive(self, tau: np.ndarray) -> np.ndarray:
        """More of it beyond the knee."""
        beyond = np.maximum(np.abs(tau) - self.knee, 0) / (self.knee / 0.35)
        return np.asarray(tau * (1 + self.share * beyond**self.exponent))


@dataclass(frozen=True)
class TorqueDelay(Channel):
    """tau(t - delay) [s]."""

    delay: float

    def at_drive(self, tau: np.ndarray) -> np.ndarray:
        """Later."""
        return later(tau, round(self.delay / DT))


@dataclass(frozen=True)
class Offset(Channel):
    """tau + offset [Nm]."""

    offset: float

    def in_log(self, time: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Shifted."""
        tau[:, self.joint] += self.offset
        return tau


@dataclass(frozen=True)
class Drift(Channel):
    """tau + scale (sum_k w_k cos(k pi t / T) + ramp (t / T - 1/2)), k = 1 to 8, T the log's
    duration."""

    scale: float
    weights: np.ndarray
    ramp: float

    def in_log(self, time: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Shifted slowly."""
        waves = np.cos(np.outer(time, np.arange(1, 9)) * np.pi / DURATION) @ self.weights
        tau[:, self.joint] += self.scale * (waves + self.ramp * (time / DURATION - 0.5))
        return tau


@dataclass(frozen=True)
class Hold(Channel):
    """All torques stand still now and then: both the hold and what lies between have exponential
    lengths, `mean` [s] and 1 / `rate` [s]."""

    mean: float
    rate: float
    seed: int

    def in_log(self, time: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Held."""
        rng = np.random.default_rng(self.seed)
        held = tau.copy()
        i = 0
        while i < len(tau):
            i += int(rng.exponential(1 / self.rate) * RATE) + 1
            count = int(np.ceil(rng.exponential(self.mean) * RATE))
            if i < len(tau):
                held[i : i + count] = tau[i]
            i += count
        return held


@dataclass(frozen=True)
class Zero(Channel):
    """q + offset [rad]: the arm stands elsewhere than its encoder says, also under command."""

    offset: float

    def seen(self, x: np.ndarray, order: int) -> np.ndarray:
        """Off."""
        return x + self.offset if order == 0 else x

    def unseen(self, x: np.ndarray, order: int) -> np.ndarray:
        """Where it stands."""
        return x - self.offset if order == 0 else x


@dataclass(frozen=True)
class PositionDelay(Channel):
    """q(t - delay) [s]."""

    delay: float

    def seen(self, x: np.ndarray, order: int) -> np.ndarray:
        """Later."""
        return later(x, round(self.delay / DT))

    def unseen(self, x: np.ndarray, order: int) -> np.ndarray:
        """At its time."""
        return later(x, -round(self.delay / DT))


Motion = tuple[np.ndarray, np.ndarray, np.ndarray]
"""q, qd, qdd at 4 kHz"""


def _changed(motion: Motion, chain: list[Channel], back: bool) -> Motion:
    q, qd, qdd = (x.copy() for x in motion)
    for channel in chain:
        for order, x in enumerate((q, qd, qdd)):
            law = channel.unseen if back else channel.seen
            x[:, channel.joint] = law(x[:, channel.joint], order)
    return q, qd, qdd


def seen(motion: Motion, chain: list[Channel]) -> Motion:
    """A motion as the encoders show it."""
    return _changed(motion, chain, back=False)


def unseen(motion: Motion, chain: list[Channel]) -> Motion:
    """The motion that the encoders would show so."""
    return _changed(motion, chain, back=True)


def in_log(tau: np.ndarray, chain: list[Channel]) -> np.ndarray:
    """Torques (m, 6) at 4 kHz as the log has them, (n, 6) at 250 Hz, without noise."""
    tau = tau.copy()
    for channel in chain:
        tau[:, channel.joint] = channel.at_drive(tau[:, channel.joint])
    shown = tau[SHOWN]
    for channel in chain:
        shown = channel.in_log(TIME[SHOWN], shown)
    return shown
