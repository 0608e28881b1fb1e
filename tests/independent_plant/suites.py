"""Families of cases for the blind evaluation; every list follows from its seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .case import Case
from .effects import LIBRARY, OUTSIDE, Effect
from .sensors import Sensors

FRACTIONS = (0.02, 0.04, 0.08, 0.15)
CHIRP_SHARE = 0.2
NEEDS_CHIRP = ("elastic_joint", "transmission_backlash")


def _chirp(rng: np.random.Generator, *kinds: str) -> bool:
    return any(k in NEEDS_CHIRP for k in kinds) or bool(rng.uniform() < CHIRP_SHARE)


def _effect(
    rng: np.random.Generator, kind: str, fraction: float | None = None, on_at: float = -np.inf
) -> Effect:
    return Effect(kind, None, float(rng.choice(FRACTIONS)) if fraction is None else fraction, on_at)


def clean(rng: np.random.Generator, i: int) -> Case:
    """Nothing but an uncertain arm."""
    return Case(int(rng.integers(2**31)), chirp=_chirp(rng))


def single(rng: np.random.Generator, i: int) -> Case:
    """One effect of the library; kinds and sizes in turn."""
    kinds = tuple(LIBRARY)
    kind = kinds[i % len(kinds)]
    fraction = FRACTIONS[(i + i // len(kinds)) % len(FRACTIONS)]
    return Case(int(rng.integers(2**31)), (_effect(rng, kind, fraction),), chirp=_chirp(rng, kind))


def pairs(rng: np.random.Generator, i: int) -> Case:
    """Two different effects of the library."""
    kinds = rng.choice(list(LIBRARY), 2, replace=False)
    if {*kinds} == {*NEEDS_CHIRP}:  # the plant has one transmission
        kinds[1] = "gear_ripple"
    effects = tuple(_effect(rng, str(k), float(rng.choice(FRACTIONS[1:]))) for k in kinds)
    return Case(int(rng.integers(2**31)), effects, chirp=_chirp(rng, *kinds))


def outside(rng: np.random.Generator, i: int) -> Case:
    """One effect that no library is expected to know."""
    kinds = tuple(OUTSIDE)
    kind = kinds[i % len(kinds)]
    fraction = FRACTIONS[1:][(i + i // len(kinds)) % 3]
    return Case(int(rng.integers(2**31)), (_effect(rng, kind, fraction),), chirp=_chirp(rng))


def _any(rng: np.random.Generator, i: int, on_at: float = -np.inf) -> tuple[Effect, ...]:
    """Nothing in every third case, else an effect of the library that needs no chirp."""
    kinds = [k for k in LIBRARY if k not in NEEDS_CHIRP]
    return (
        ()
        if i % 3 == 0
        else (_effect(rng, str(rng.choice(kinds)), float(rng.choice(FRACTIONS[1:])), on_at),)
    )


def short(rng: np.random.Generator, i: int) -> Case:
    """Records of 6 to 15 s."""
    return Case(
        int(rng.integers(2**31)),
        _any(rng, i),
        duration=float(rng.uniform(6.0, 15.0)),
        validation_duration=15.0,
    )


def idle_axis(rng: np.random.Generator, i: int) -> Case:
    """One axis at rest; in some cases the effect sits on it and cannot show in the identification
    record."""
    return Case(int(rng.integers(2**31)), _any(rng, i), idle=(int(rng.integers(1, 7)),))


def switched(rng: np.random.Generator, i: int) -> Case:
    """An effect that begins in the middle of the record."""
    kinds = [k for k in LIBRARY if k not in (*NEEDS_CHIRP, "encoder_zero", "viscous_warmup")]
    at = float(rng.uniform(12.0, 26.0))
    return Case(
        int(rng.integers(2**31)),
        (_effect(rng, str(rng.choice(kinds)), float(rng.choice(FRACTIONS[1:])), at),),
    )


def payload(rng: np.random.Generator, i: int) -> Case:
    """A load that nobody declared, of 4 to 15 % of the torque of the joint it moves most."""
    return Case(int(rng.integers(2**31)), (Effect("payload", None, FRACTIONS[1:][i % 3]),))


def wrong_priors(rng: np.random.Generator, i: int) -> Case:
    """All numbers of the arm 2.5 times as far off as the data sheet says, every other one with a
    load."""
    load = (Effect("payload", None, FRACTIONS[1:][i // 2 % 3]),) if i % 2 else ()
    return Case(int(rng.integers(2**31)), load, spread=2.5, name="load" if load else "nothing")


def traps(rng: np.random.Generator, i: int) -> Case:
    """Records that look like an effect, or like another one."""
    seed = int(rng.integers(2**31))
    quiet = Sensors()
    loud = Sensors(torque_noise=tuple(3 * s for s in quiet.torque_noise))
    made: tuple[tuple[str, Callable[[], Case]], ...] = (
        ("wrong_priors", lambda: Case(seed, spread=2.5)),
        ("loud", lambda: Case(seed, sensors=loud)),
        (
            "coarse_encoder",
            lambda: Case(
                seed, sensors=Sensors(angle_step=1e-4, angle_noise=1e-5, speed_noise=4e-3)
            ),
        ),
        ("lossy", lambda: Case(seed, sensors=Sensors(lost=0.08))),
        ("coloured", lambda: Case(seed, sensors=Sensors(white_share=0.1, colour_time=0.15))),
        ("asymmetry_or_offset", lambda: Case(seed, (_effect(rng, "torque_offset"),))),
        ("offset_or_asymmetry", lambda: Case(seed, (_effect(rng, "coulomb_asymmetry"),))),
        ("backlash_or_zero", lambda: Case(seed, (Effect("encoder_zero", 3, 0.03),))),
        ("gain_or_balancer", lambda: Case(seed, (Effect("torque_gain", 2, 0.04),))),
        ("balancer_or_gain", lambda: Case(seed, (Effect("balancer", 2, 0.08),))),
        ("rotor_or_link", lambda: Case(seed, (Effect("rotor_inertia", 1, 0.08),))),
        ("warm_or_viscous", lambda: Case(seed, (_effect(rng, "viscous_warmup", 0.08),))),
        (
            "wrong_priors_and_payload",
            lambda: Case(seed, (Effect("payload", None, 0.08),), spread=2.5),
        ),
    )
    name, make = made[i % len(made)]
    case = make()
    return Case(case.seed, case.effects, spread=case.spread, sensors=case.sensors, name=name)


SUITES: dict[str, Callable[[np.random.Generator, int], Case]] = {
    f.__name__: f
    for f in (
        clean,
        single,
        pairs,
        outside,
        short,
        idle_axis,
        switched,
        payload,
        wrong_priors,
        traps,
    )
}


def suite(name: str, n: int, seed: int = 0) -> list[Case]:
    """The first n cases of a family; nothing is simulated before `Case.simulate` is called.

    Args:
        name: clean, single, pairs, outside, short, idle_axis, switched, payload,
            wrong_priors or traps.
        n: how many.
        seed: another list of the same family.
    """
    from dataclasses import replace

    if name not in SUITES:
        raise ValueError(f"unknown suite {name!r}; known are {', '.join(SUITES)}")
    cases = []
    for i in range(n):
        case = SUITES[name](np.random.default_rng([seed, i, *name.encode()]), i)
        cases.append(replace(case, name="/".join(filter(None, (name, case.name, str(i))))))
    return cases
