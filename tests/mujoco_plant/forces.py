"""Laws of force, each one object with memory: what the motors must give beyond rigid body and
friction.

Shapes are arguments, drawn at random per arm (`draws.py`). `size` is the torque [Nm] that the law
reaches, unless its class says otherwise.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np


class State:
    """What a law may look at: time [s], angles, speeds, motor torques of the instant before
    (6,)."""

    def __init__(self, dt: float, tip_force: Callable[[np.ndarray], np.ndarray]) -> None:
        self.dt = dt
        self.tip_force = tip_force
        self.time = 0.0
        self.q: Sequence[float] = ()
        self.qd: Sequence[float] = ()
        self.load: Sequence[float] = ()

    def at(self, time: float, q: np.ndarray, qd: np.ndarray, load: np.ndarray) -> None:
        """The next instant."""
        self.time = time
        self.q = q.tolist()
        self.qd = qd.tolist()
        self.load = load.tolist()


class Law(ABC):
    """Adds to the torques of the motors."""

    @abstractmethod
    def add(self, state: State, extra: np.ndarray) -> None:
        """Add this law's torque [Nm] to `extra` (6,)."""


@dataclass
class Bristle:
    """A sign that needs a way to turn: s' = (v - |v| s) / travel, exact over a step of constant
    speed."""

    travel: float
    s: float = 0.0

    def __call__(self, speed: float, dt: float) -> float:
        if speed != 0.0:
            side = 1.0 if speed > 0.0 else -1.0
            self.s = side + (self.s - side) * float(np.exp(-abs(speed) * dt / self.travel))
        return self.s


@dataclass
class Dry(Law):
    """size * (forward or backward share) * s * (1 + rise exp(-(|v| / speed)^power))."""

    joint: int
    size: float
    forward: float
    backward: float
    rise: float
    speed: float
    power: float
    sign: Bristle

    def add(self, state: State, extra: np.ndarray) -> None:
        v = state.qd[self.joint]
        s = self.sign(v, state.dt)
        share = self.forward if s > 0.0 else self.backward
        more = self.rise * float(np.exp(-((abs(v) / self.speed) ** self.power)))
        extra[self.joint] += self.size * share * s * (1.0 + more)


@dataclass
class Viscous(Law):
    """size * sgn(v) |v / scale|^power, times a decay in time of one of three shapes."""

    joint: int
    size: float
    scale: float
    power: float
    decay: Callable[[float], float] = lambda time: 1.0

    def add(self, state: State, extra: np.ndarray) -> None:
        v = state.qd[self.joint] / self.scale
        side = 1.0 if v > 0.0 else -1.0
        extra[self.joint] += self.size * self.decay(state.time) * side * abs(v) ** self.power


@dataclass
class LoadFriction(Law):
    """size * |load / scale|^power * s: friction that grows with what the gear carries."""

    joint: int
    size: float
    scale: float
    power: float
    sign: Bristle

    def add(self, state: State, extra: np.ndarray) -> None:
        carried = abs(state.load[self.joint] / self.scale) ** self.power
        extra[self.joint] += self.size * carried * self.sign(state.qd[self.joint], state.dt)


@dataclass
class BoucWen(Law):
    """z' = (v - v |z|^n (b + (1 - b) sgn(v z))) / travel, |z| <= 1; torque size * z."""

    joint: int
    size: float
    travel: float
    n: float
    b: float
    z: float = 0.0

    def add(self, state: State, extra: np.ndarray) -> None:
        v = state.qd[self.joint]
        parts = 1 + int(abs(v) * state.dt / (0.1 * self.travel))
        for _ in range(parts):
            turn = self.b + (1.0 - self.b) * (1.0 if v * self.z > 0.0 else -1.0)
            rate = v * (1.0 - abs(self.z) ** self.n * turn) / self.travel
            self.z = min(max(self.z + state.dt / parts * rate, -1.0), 1.0)
        extra[self.joint] += self.size * self.z


@dataclass
class MaxwellSlip(Law):
    """Elements of weight w that slip beyond their travel: torque size * sum w z / travel."""

    joint: int
    size: float
    travels: np.ndarray
    weights: np.ndarray
    z: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def add(self, state: State, extra: np.ndarray) -> None:
        if not len(self.z):
            self.z = np.zeros(len(self.travels))
        moved = self.z + state.qd[self.joint] * state.dt
        self.z = np.clip(moved, -self.travels, self.travels)
        extra[self.joint] += self.size * float(self.weights @ (self.z / self.travels))


@dataclass
class Dahl(Law):
    """LuGre without damping: size * s."""

    joint: int
    size: float
    sign: Bristle

    def add(self, state: State, extra: np.ndarray) -> None:
        extra[self.joint] += self.size * self.sign(state.qd[self.joint], state.dt)


@dataclass
class Ripple(Law):
    """size * sum a_k sin(n_k q + phase_k), another share in the other direction."""

    joint: int
    size: float
    orders: np.ndarray
    shares: np.ndarray
    phases: np.ndarray
    backward: float = 1.0

    def add(self, state: State, extra: np.ndarray) -> None:
        wave = self.shares @ np.sin(self.orders * state.q[self.joint] + self.phases)
        side = 1.0 if state.qd[self.joint] >= 0.0 else self.backward
        extra[self.joint] += self.size * side * float(wave)


@dataclass
class Balancer(Law):
    """A spring between two pins a and b from the axis, length L(q): size * F(L) dL/dq / a.

    F is a coil's (1 + rise (L / rest - 1)) or a gas cylinder's (rest / L)^exponent.
    """

    joint: int
    size: float
    a: float
    b: float
    zero: float
    rise: float
    exponent: float | None

    def add(self, state: State, extra: np.ndarray) -> None:
        angle = state.q[self.joint] - self.zero
        rest = abs(self.b - self.a)
        length = float(np.sqrt(self.a**2 + self.b**2 - 2 * self.a * self.b * np.cos(angle)))
        slope = self.a * self.b * float(np.sin(angle)) / length / self.a
        if self.exponent is None:
            force = 1.0 + self.rise * (length / rest - 1.0)
        else:
            force = (length / rest) ** self.exponent
        extra[self.joint] += self.size * force * slope


@dataclass
class Cable(Law):
    """size * (x + c2 x^2 + c3 x^3), x = (q - zero) / half."""

    joint: int
    size: float
    zero: float
    half: float
    square: float
    cube: float

    def add(self, state: State, extra: np.ndarray) -> None:
        x = (state.q[self.joint] - self.zero) / self.half
        extra[self.joint] += self.size * (x + self.square * x**2 + self.cube * x**3)


@dataclass
class OneWayCoupling(Law):
    """The partner's motion drags on this joint, not the other way: size * (dry s + viscous v)."""

    joint: int
    partner: int
    size: float
    dry: float
    scale: float
    sign: Bristle

    def add(self, state: State, extra: np.ndarray) -> None:
        v = state.qd[self.partner]
        s = self.sign(v, state.dt)
        extra[self.joint] += self.size * (self.dry * s + (1.0 - self.dry) * v / self.scale)


@dataclass
class TipPush(Law):
    """size [N] along a direction at the tool's tip, in a window with flanks of one of two
    shapes."""

    size: float
    direction: np.ndarray
    begins: float
    lasts: float
    flank: float
    hump: bool

    def add(self, state: State, extra: np.ndarray) -> None:
        x = (state.time - self.begins) / self.lasts
        if 0.0 < x < 1.0:
            edge = min(x, 1.0 - x) * self.lasts / self.flank
            share = float(np.sin(np.pi * x)) if self.hump else min(edge, 1.0)
            extra += state.tip_force(self.size * share * self.direction)


@dataclass
class Formula(Law):
    """Any smooth function of the state: the laws that no library is expected to know."""

    joint: int
    size: float
    law: Callable[[State], float]

    def add(self, state: State, extra: np.ndarray) -> None:
        extra[self.joint] += self.size * self.law(state)
