"""Families of arms for the measure of names; every list follows from its seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from independent_plant.parameters import TORQUE_LIMITS

from .case import Case
from .draws import LIBRARY, OUTSIDE
from .present import Wanted
from .reading import Reading

Rng = np.random.Generator
FRACTIONS = (0.03, 0.05, 0.08, 0.15)
NEEDS_CHIRP = ("elastic_joint", "transmission_backlash")
WRONG = 2.5
RATES = (50.0, 62.5, 83.3, 100.0, 125.0)


def _seed(rng: Rng) -> int:
    return int(rng.integers(2**31))


def clean(rng: Rng, i: int) -> Case:
    """The best conditions: 250 Hz, commanded motion, no jitter."""
    return Case(_seed(rng), chirp=bool(rng.uniform() < 0.2))


def jitter(rng: Rng, i: int) -> Case:
    """Printed stamps off by 0.2 to 1.5 ms rms; every other arm without the commanded motion."""
    reading = Reading(jitter=float(rng.uniform(2e-4, 1.5e-3)), with_reference=i % 2 == 0)
    return Case(_seed(rng), reading=reading)


def slow(rng: Rng, i: int) -> Case:
    """50 to 125 samples a second."""
    return Case(_seed(rng), reading=Reading(rate=RATES[i % 5], with_reference=i % 2 == 0))


def digits(rng: Rng, i: int) -> Case:
    """Angles in steps of 1e-4 rad, 50 to 250 Hz."""
    rate = float(rng.choice([50.0, 100.0, 250.0]))
    reading = Reading(rate=rate, angle_step=1e-4, speed_noise=4e-3, with_reference=i % 2 == 0)
    return Case(_seed(rng), reading=reading)


def bursts(rng: Rng, i: int) -> Case:
    """A fifth of the samples lost, 4 to 20 in a row."""
    reading = Reading(lost=0.2, burst=float(rng.uniform(4, 20)), with_reference=i % 2 == 0)
    return Case(_seed(rng), reading=reading)


def coarse(rng: Rng, i: int) -> Case:
    """Torque in steps of 0.3 to 1 % of what the drives can give."""
    step = rng.uniform(0.003, 0.01) * TORQUE_LIMITS
    return Case(_seed(rng), reading=Reading(torque_step=tuple(float(v) for v in step)))


def friction(rng: Rng, i: int) -> Case:
    """All friction up to 30 % more or less: a cold or a warm arm."""
    return Case(_seed(rng), friction_scale=float(rng.uniform(0.7, 1.3)))


def single(rng: Rng, i: int) -> Case:
    """One effect of the library; kinds and sizes in turn."""
    kinds = tuple(LIBRARY)
    kind = kinds[i % len(kinds)]
    fraction = FRACTIONS[(i + i // len(kinds)) % len(FRACTIONS)]
    return Case(_seed(rng), (Wanted(kind, None, fraction),), chirp=kind in NEEDS_CHIRP)


def payload(rng: Rng, i: int) -> Case:
    """1, 2, 3 kg that nobody declared."""
    return Case(_seed(rng), (Wanted("payload", size=1.0 + i % 3),))


def wrong_priors(rng: Rng, i: int) -> Case:
    """All numbers of the arm 2.5 times as far off as the data sheet says."""
    return Case(_seed(rng), spread=WRONG)


def wrong_priors_load(rng: Rng, i: int) -> Case:
    """The same with 2, 3, 4 kg that nobody declared."""
    return Case(_seed(rng), (Wanted("payload", size=2.0 + i % 3),), spread=WRONG)


def _several(rng: Rng, count: int) -> Case:
    kinds = [str(k) for k in rng.choice(list(LIBRARY), count, replace=False)]
    if {*NEEDS_CHIRP} <= {*kinds}:  # the plant has one transmission
        kinds[kinds.index("transmission_backlash")] = "gear_ripple"
        kinds = list(dict.fromkeys(kinds))
    wanted = tuple(Wanted(k, None, float(rng.choice(FRACTIONS[1:]))) for k in kinds)
    return Case(_seed(rng), wanted, chirp=bool({*NEEDS_CHIRP} & {*kinds}))


def pairs(rng: Rng, i: int) -> Case:
    """Two different effects of the library."""
    return _several(rng, 2)


def three(rng: Rng, i: int) -> Case:
    """Three different effects of the library."""
    return _several(rng, 3)


def outside(rng: Rng, i: int) -> Case:
    """One effect that no library is expected to know."""
    kinds = tuple(OUTSIDE)
    wanted = Wanted(kinds[i % len(kinds)], None, FRACTIONS[1:][(i + i // len(kinds)) % 3])
    return Case(_seed(rng), (wanted,))


SUITES: dict[str, Callable[[Rng, int], Case]] = {
    f.__name__: f
    for f in (
        clean,
        jitter,
        slow,
        digits,
        bursts,
        coarse,
        friction,
        single,
        payload,
        wrong_priors,
        wrong_priors_load,
        pairs,
        three,
        outside,
    )
}


def suite(name: str, start: int, count: int, seed: int) -> list[Case]:
    """Cases `start` to `start + count` of a family; nothing is simulated here.

    Raises:
        ValueError: unknown family.
    """
    if name not in SUITES:
        raise ValueError(f"unknown suite {name!r}; known are {', '.join(SUITES)}")
    made = []
    for i in range(start, start + count):
        case = SUITES[name](np.random.default_rng([seed, i, *name.encode()]), i)
        made.append(replace(case, name=f"{name}/{i}"))
    return made
