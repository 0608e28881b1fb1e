"""Effects of an arm: drawn, and sized so that each is a share of what its joint's torque is."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .arm import Arm
from .drives import Run, added_torques, rms, run, with_effects
from .effect import IDENTIFICATION, Draw, Effect, Reach
from .sensors import seen
from .suites import KINDS, Planned

LEAST = 0.012
MOST = 0.17
"""rms torque of an effect over its main joint's"""
TRIES = 30
WANTED_TRIES = 5
"""draws on the joint that is to be tried first"""


@dataclass(frozen=True)
class Bench:
    """What sizes are searched on: the arm, its command (m, 18), gains, and the run without
    effects."""

    arm: Arm
    command: np.ndarray
    gains: np.ndarray
    plain: Run

    def shares(self, effect: Effect, made: Run) -> tuple[np.ndarray, np.ndarray]:
        """Torque that it adds alone (n, 6), and its rms over the plain one's (6,)."""
        (added,) = added_torques(self.arm, [effect], IDENTIFICATION, made)
        return added, rms(added) / rms(self.plain.tau)

    def made_with(self, effect: Effect) -> Run:
        """The closed loop with it, or where it does not act on the motion, the plain one as its
        measuring chain shows it."""
        if effect.closed:
            return run(self.arm, [effect], IDENTIFICATION, self.command, self.gains)
        chain = with_effects(self.arm, [effect], IDENTIFICATION)[1]
        return replace(self.plain, seen=seen(self.plain.motion, chain))


def _sized(bench: Bench, effect: Effect, rng: np.random.Generator) -> bool:
    """Gives the effect a size whose torque is a share drawn; whether that went."""
    target = float(np.exp(rng.uniform(np.log(0.017), np.log(effect.most))))
    for turn in range(4 if effect.closed else 3):
        made = bench.made_with(effect)
        added, shares = bench.shares(effect, made)
        if effect.balances and turn == 0 and rng.uniform() < 0.8:
            j = (effect.joint or 1) - 1
            if (added[:, j] * bench.plain.tau[:, j]).mean() > 0:
                effect.sign = -1.0
        main = effect.joint - 1 if effect.joint else int(np.argmax(shares))
        share = shares[main]
        if effect.kept:
            return bool(share > LEAST)
        if share < 1e-7:
            return False
        step = target / share
        step = np.clip(step, 0.2, 5) if effect.closed else step  # a spring is far from linear
        effect.size = float(np.clip(effect.size * step, effect.low, effect.high))
    made = bench.made_with(effect) if effect.closed else made
    share = bench.shares(effect, made)[1][main]
    return bool(LEAST < share < MOST)


def drawn_effects(
    planned: Planned, bench: Bench, reach: Reach, rng: np.random.Generator
) -> list[Effect]:
    """The arm's effects with their sizes, no two on one joint.

    Raises:
        RuntimeError: none in 30 draws is of a size that can be seen.
    """
    effects: list[Effect] = []
    used: set[int] = set()
    for kind, joint in zip(planned.kinds, planned.joints, strict=True):
        for turn in range(TRIES):
            # every other rotor inertia may be that of all joints
            free = turn >= WANTED_TRIES or (kind == "rotor_inertia" and joint % 2 == 1)
            effect = KINDS[kind](Draw(rng, reach, kind, None if free else joint))
            taken = {effect.joint} if effect.joint else set()
            if kind == "wrist_coupling" and effect.joint:
                taken = {effect.joint, effect.joint - 1}
            if taken & used:
                continue
            if _sized(bench, effect, rng):
                break
        else:
            raise RuntimeError(f"{planned.name}: no {kind} that can be seen in {TRIES} draws")
        effects.append(effect)
        used |= taken
    return effects
