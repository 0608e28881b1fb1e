"""What an arm may have, and how the shape of each law is drawn for one arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from independent_plant.parameters import RANGES, SPEEDS

from .forces import (
    Balancer,
    BoucWen,
    Bristle,
    Cable,
    Dahl,
    Dry,
    Formula,
    Law,
    LoadFriction,
    MaxwellSlip,
    OneWayCoupling,
    Ripple,
    State,
    TipPush,
    Viscous,
)

ALL = (1, 2, 3, 4, 5, 6)
Make = Callable[[float], Law]
Rng = np.random.Generator
TORQUE = np.array([300.0, 400.0, 200.0, 20.0, 30.0, 10.0])
"""what a joint carries in an ordinary motion [Nm]"""


@dataclass(frozen=True)
class Recipe:
    """One kind: where it acts ("force", "arm", "transmission", "cogging", "chain", "zero"), the
    joints it may sit on (none: the whole arm), the size to begin with and the largest plausible
    one (axes 4-6: a tenth), and for forces the draw of the shape."""

    where: str
    joints: tuple[int, ...]
    start: float
    limit: float
    draw: Callable[[Rng, int], Make] | None = None
    signed: bool = False


def _bristle(rng: Rng) -> Bristle:
    return Bristle(float(10 ** rng.uniform(-3.7, -2.7)))


def _middle(rng: Rng, joint: int, share: float) -> float:
    half = 0.27 * float(np.ptp(RANGES[joint]))
    return float(RANGES[joint].mean() + share * half * rng.uniform(-1, 1))


def _half(joint: int) -> float:
    return 0.27 * float(np.ptp(RANGES[joint]))


def asymmetry(rng: Rng, j: int) -> Make:
    """More friction one way, less the other; not by the same."""
    a, b = rng.uniform(0.7, 1.3, 2)
    travel = _bristle(rng).travel
    return lambda size: Dry(j, size, a, -b, 0.0, 1.0, 1.0, Bristle(travel))


def coulomb(rng: Rng, j: int) -> Make:
    """Dry friction with a rise at low speed of drawn shape."""
    rise = rng.uniform(0.0, 0.4)
    speed = rng.uniform(0.02, 0.2)
    power = rng.uniform(0.6, 2.0)
    travel = _bristle(rng).travel
    return lambda size: Dry(j, size, 1.0, 1.0, rise, speed, power, Bristle(travel))


def viscous(rng: Rng, j: int) -> Make:
    """Nearly linear."""
    power = rng.uniform(0.85, 1.15)
    return lambda size: Viscous(j, size, 0.4 * SPEEDS[j], power)


def _exponential(tau: float, time: float) -> float:
    return float(np.exp(-time / tau))


def _hyperbola(tau: float, time: float) -> float:
    return 1.0 / (1.0 + max(time, 0.0) / tau)


def _two_rates(tau: float, time: float) -> float:
    return 0.6 * float(np.exp(-time / tau)) + 0.4 * float(np.exp(-time / (4.0 * tau)))


def warm_up(rng: Rng, j: int) -> Make:
    """Viscous friction that fades: exponentially, hyperbolically or at two rates."""
    fades = (_exponential, _hyperbola, _two_rates)
    decay = partial(fades[rng.integers(3)], float(rng.uniform(6.0, 25.0)))
    power = rng.uniform(0.85, 1.1)
    return lambda size: Viscous(j, size, 0.4 * SPEEDS[j], power, decay)


def load_friction(rng: Rng, j: int) -> Make:
    """Power of the load 0.8 to 1.2."""
    power = rng.uniform(0.8, 1.2)
    travel = _bristle(rng).travel
    return lambda size: LoadFriction(j, size, TORQUE[j], power, Bristle(travel))


def hysteresis(rng: Rng, j: int) -> Make:
    """LuGre, Bouc-Wen or Maxwell-slip, with a way of 0.3 to 2 degrees."""
    travel = float(np.radians(rng.uniform(0.3, 2.0)))
    n = rng.uniform(1.0, 3.0)
    b = rng.uniform(0.5, 0.9)
    travels = travel * np.sort(rng.uniform(0.3, 4.0, 4))
    weights = rng.dirichlet(np.ones(4))
    made: tuple[Make, ...] = (
        lambda size: Dahl(j, size, Bristle(travel)),
        lambda size: BoucWen(j, size, travel, n, b),
        lambda size: MaxwellSlip(j, size, travels, weights),
    )
    return made[rng.integers(3)]


def ripple(rng: Rng, j: int) -> Make:
    """One to three harmonics of a gear's order; half of the arms another share backwards."""
    base = rng.uniform(8, 45) if j < 3 else rng.uniform(5, 25)
    count = int(rng.integers(1, 4))
    shares = np.array([1.0, 0.35, 0.2])[:count] * rng.uniform(0.5, 1.0, count)
    shares[0] = 1.0
    phases = rng.uniform(0, 2 * np.pi, count)
    orders = base * np.arange(1, count + 1)
    backward = float(rng.choice([1.0, rng.uniform(0.6, 1.0)]))
    return lambda size: Ripple(j, size, orders, shares, phases, backward)


def balancer(rng: Rng, j: int) -> Make:
    """Coil or gas, lifting or pressing."""
    a = rng.uniform(0.15, 0.4)
    b = a * rng.uniform(1.6, 2.6)
    zero = rng.uniform(-0.3, 0.3)
    rise = rng.uniform(0.2, 1.5)
    exponent = None if rng.uniform() < 0.5 else float(rng.uniform(0.5, 1.5))
    return lambda size: Balancer(j, size, a, b, zero, rise, exponent)


def cable(rng: Rng, j: int) -> Make:
    """A polynomial of third degree, even part included."""
    zero = _middle(rng, j, 0.4)
    square = rng.uniform(-0.2, 0.2)
    cube = rng.uniform(0.0, 0.35)
    return lambda size: Cable(j, size, zero, _half(j), square, cube)


def coupling(rng: Rng, j: int) -> Make:
    """The next joint drags on this one, mostly by dry friction."""
    dry = rng.uniform(0.5, 1.0)
    travel = _bristle(rng).travel
    scale = 0.4 * SPEEDS[j + 1]
    return lambda size: OneWayCoupling(j, j + 1, size, dry, scale, Bristle(travel))


def push(rng: Rng, j: int) -> Make:
    """Somewhere in the first 20 s, for 2 to 5 s, any direction."""
    way = rng.standard_normal(3)
    begins = rng.uniform(4.0, 14.0)
    lasts = rng.uniform(2.0, 5.0)
    flank = rng.uniform(0.1, 0.6)
    hump = bool(rng.uniform() < 0.5)
    way /= np.linalg.norm(way)
    return lambda size: TipPush(size, way, begins, lasts, flank, hump)


def _formula(law: Callable[[Rng, int], Callable[[State], float]]) -> Callable[[Rng, int], Make]:
    def draw(rng: Rng, j: int) -> Make:
        drawn = law(rng, j)
        return lambda size: Formula(j, size, drawn)

    return draw


def _vibration(rng: Rng, j: int) -> Callable[[State], float]:
    rate = 2 * np.pi * rng.uniform(4.0, 11.0)
    return lambda s: float(np.sin(rate * s.time))


def _angle_speed(rng: Rng, j: int) -> Callable[[State], float]:
    zero = _middle(rng, j, 0.3)
    return lambda s: (s.q[j] - zero) * s.qd[j] / SPEEDS[j]


def _speed_bump(rng: Rng, j: int) -> Callable[[State], float]:
    place = rng.uniform(0.08, 0.16) * SPEEDS[j]
    width = rng.uniform(0.02, 0.04) * SPEEDS[j]
    return lambda s: float(np.sign(s.qd[j]) * np.exp(-(((abs(s.qd[j]) - place) / width) ** 2)))


def _even_speed(rng: Rng, j: int) -> Callable[[State], float]:
    scale = 0.3 * SPEEDS[j]
    return lambda s: (s.qd[j] / scale) ** 2 - 0.5


def _speed_product(rng: Rng, j: int) -> Callable[[State], float]:
    k = int(rng.choice([i for i in range(6) if i != j]))
    scale = 0.1 * SPEEDS[j] * SPEEDS[k]
    return lambda s: s.qd[j] * s.qd[k] / scale


def _angle_product(rng: Rng, j: int) -> Callable[[State], float]:
    k = int(rng.choice([i for i in range(6) if i != j]))
    one = _middle(rng, j, 0.2)
    other = _middle(rng, k, 0.2)
    return lambda s: float(np.sin(2 * (s.q[j] - one)) * np.sin(2 * (s.q[k] - other)))


def _slow_drift(rng: Rng, j: int) -> Callable[[State], float]:
    rate = 2 * np.pi / rng.uniform(15.0, 35.0)
    return lambda s: float(np.sin(rate * s.time))


LIBRARY: dict[str, Recipe] = {
    "payload": Recipe("arm", (), 1.0, 12.0),
    "rotor_inertia": Recipe("arm", ALL, 1.0, 30.0),
    "coulomb_asymmetry": Recipe("force", ALL, 1.0, 60.0, asymmetry, signed=True),
    "coulomb_change": Recipe("force", ALL, 1.0, 60.0, coulomb),
    "viscous_change": Recipe("force", ALL, 1.0, 100.0, viscous),
    "viscous_warmup": Recipe("force", ALL, 1.0, 150.0, warm_up),
    "load_friction": Recipe("force", (1, 2, 3, 4, 5), 1.0, 200.0, load_friction),
    "hysteresis": Recipe("force", ALL, 1.0, 80.0, hysteresis),
    "gear_ripple": Recipe("force", ALL, 1.0, 80.0, ripple),
    "balancer": Recipe("force", (2, 3), 100.0, 3000.0, balancer, signed=True),
    "cable_spring": Recipe("force", (1, 3, 4, 5, 6), 1.0, 200.0, cable),
    "wrist_coupling": Recipe("force", (4, 5), 1.0, 200.0, coupling, signed=True),
    "torque_gain": Recipe("chain", ALL, 0.05, 0.3, signed=True),
    "torque_offset": Recipe("chain", ALL, 1.0, 60.0, signed=True),
    "time_delay": Recipe("chain", (), 0.004, 0.04),
    "encoder_zero": Recipe("zero", (2, 3, 5), 0.005, 0.04, signed=True),
    "elastic_joint": Recipe("transmission", ALL, 0.3, 3.0),
    "transmission_backlash": Recipe("transmission", ALL, 1e-3, 0.02),
    "base_tilt": Recipe("arm", (), 0.02, 0.1),
    "process_force": Recipe("force", (), 20.0, 400.0, push),
    "link_inertia": Recipe("arm", (2, 3, 4), 1.0, 25.0),
}

OUTSIDE: dict[str, Recipe] = {
    name: Recipe("force", ALL, 1.0, 300.0, _formula(law), signed=True)
    for name, law in (
        ("vibration", _vibration),
        ("angle_speed", _angle_speed),
        ("speed_bump", _speed_bump),
        ("even_speed", _even_speed),
        ("speed_product", _speed_product),
        ("angle_product", _angle_product),
        ("slow_drift", _slow_drift),
    )
}
OUTSIDE["gain_drift"] = Recipe("chain", ALL, 0.05, 0.5, signed=True)
KINDS = LIBRARY | OUTSIDE
