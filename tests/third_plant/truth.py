"""What an arm has, in the library's terms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .effect import Effect
from .suites import LIBRARY


@dataclass(frozen=True)
class Entry:
    """One effect as the library counts them; torque (n, 6)."""

    kind: str
    joint: int | None
    size: float
    torque: np.ndarray


def in_library_terms(effect: Effect, torque: np.ndarray) -> Iterator[Entry]:
    """A coupling belongs to the joint that drives, rotors are one effect per joint, a link is the
    joint's that moves it, a heavier tool is a payload."""
    told = effect.told()
    kind = effect.kind
    if kind == "wrist_coupling":
        yield Entry(kind, told["driven_by_joint"], effect.signed_size, torque)
    elif kind == "rotor_inertia" and effect.joint is None:
        for j, inertia in enumerate(told["reflected_inertia_kgm2"]):
            yield Entry(kind, j + 1, inertia, torque * (np.arange(6) == j))
    elif kind == "link_inertia" and told["link"] == "tool":
        yield Entry("payload", None, told["relative_mass"], torque)
    elif kind == "link_inertia":
        yield Entry(kind, told["link"], told["relative_mass"], torque)
    else:
        yield Entry(kind, effect.joint, effect.signed_size, torque)


@dataclass(frozen=True)
class Truth:
    """One effect: kind, joint, joint whose torque it changes most, size, share of that torque,
    standard deviations it stands out of noise and data sheet."""

    kind: str
    joint: int | None
    main_joint: int
    size: float
    fraction: float
    strength: float
    in_library: bool

    @staticmethod
    def of(entry: Entry, shares: np.ndarray, strength: float) -> Truth:
        """Of shares of each joint's torque (6,)."""
        main = int(np.argmax(shares))
        known = entry.kind in LIBRARY
        where = (entry.joint, main + 1)
        return Truth(entry.kind, *where, float(entry.size), float(shares[main]), strength, known)
