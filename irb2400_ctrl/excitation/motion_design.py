"""Choice of pieces: a random pool, Fedorov's exchange on their information, and mutations of what
was chosen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.excitation.assemble import Workshop
from irb2400_ctrl.excitation.segments import FLAVOURS, Piece, allowed, drawn, mutated
from irb2400_ctrl.given import whole
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed

PIECE = 8.0
"""[s] wanted for a piece with the move to the next one"""
MOVE = 1.5
"""[s] of it for the move"""
ENOUGH = 300.0
"""standard deviations beyond which more does not count"""


@typed
@dataclass(frozen=True)
class Budget:
    """How long is searched: pieces drawn, rounds of mutations, mutations in each."""

    pool: int = 72
    rounds: int = 2
    mutations: int = 24

    def __post_init__(self) -> None:
        whole("pool", self.pool, 1)
        whole("rounds", self.rounds)
        whole("mutations", self.mutations)


@dataclass(frozen=True)
class MotionCandidate:
    """A piece with its information in each slot of the motion (one entry where the slot does not
    matter)."""

    piece: Piece
    grams: tuple[Array, ...]

    def gram(self, slot: int) -> Array:
        """Information when placed in this slot."""
        return self.grams[slot if len(self.grams) > 1 else 0]


def merit(D: Array, enough: Array) -> float:
    """What is maximised: the smallest distance weighs as much as all others together.

    Args:
        D: distances; enough: of each what counts at most, 0 for a pair that is left out; shape
        (pairs,).
    """
    used = np.minimum(D, enough)[enough > 0]
    if len(used) == 0:
        return 0.0
    logs = np.log(np.maximum(used, 1e-6))
    return float(logs.min() + logs.mean())


class Criterion(Protocol):
    """What a motion is chosen for: distances that its information comes to, the larger the
    better."""

    @property
    def timed(self) -> bool:
        """Whether it matters when a piece is made."""
        ...

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the flavours that pieces are drawn from."""
        ...

    def gram(self, motion: PreparedLog) -> Array:
        """Information of a motion; those of several add up."""
        ...

    def at(self, motion: PreparedLog, start: float) -> PreparedLog:
        """The motion begun at another time of the record [s]."""
        ...

    def distances(self, gram: Array) -> tuple[Array, Array]:
        """In standard deviations, and a second measure for tables; (k,) each."""
        ...


class Design:
    """The search for one criterion on one robot."""

    def __init__(
        self,
        workshop: Workshop,
        alternatives: Criterion,
        enough: Array,
        seconds: float,
        seed: int,
        joint: int | None = None,
    ) -> None:
        """`enough`: as in `merit`; `joint` (from 1) always moves."""
        self.workshop = workshop
        self.alternatives = alternatives
        self.enough = enough
        self.seconds = seconds
        self.rng = np.random.default_rng(whole("seed", seed))
        self.joint = joint
        self.slots = max(1, round(seconds / PIECE))
        self.duration = (seconds - MOVE * (self.slots - 1)) / self.slots
        self.timed = alternatives.timed
        self.flavours = [FLAVOURS[name] for name in alternatives.motions]

    def run(
        self, budget: Budget, progress: Callable[[str], None]
    ) -> tuple[Trajectory, tuple[str, ...]]:
        """The chosen pieces joined to one motion, and their flavours, in order.

        Raises:
            InfeasibleError: the limits leave no such motion.
        """
        pieces = self._pieces(budget, progress)
        progress("joining the pieces")
        course = self.workshop.filling(pieces, self.duration, self.seconds)
        return course, tuple(piece.flavour for piece in pieces)

    def _pieces(self, budget: Budget, progress: Callable[[str], None]) -> list[Piece]:
        """The chosen pieces, in order.

        Raises:
            InfeasibleError: hardly any piece is inside the limits.
        """
        pool: list[MotionCandidate] = []
        for k in range(6 * budget.pool):
            progress(f"drawing motions ({len(pool)} of {budget.pool})")
            piece = drawn(
                self.rng,
                self.workshop.robot,
                self.flavours[k % len(self.flavours)],
                self.duration,
                self.joint,
            )
            self._add(pool, piece)
            if len(pool) >= budget.pool:
                break
        if len(pool) < self.slots:
            raise InfeasibleError(
                f"only {len(pool)} of {6 * budget.pool} random pieces of motion are inside the "
                "limits of "
                f"{self.workshop.robot.name}; expected at least {self.slots}: check torque limits "
                "and joint box"
            )
        chosen = self._exchanged(pool, self._greedy(pool))
        for number in range(budget.rounds):
            progress(f"improving the motion ({number + 1} of {budget.rounds})")
            share = 0.3 / (number + 1)
            for k in range(budget.mutations):
                parent = pool[chosen[k % self.slots]].piece
                self._add(
                    pool, mutated(self.rng, self.workshop.robot, parent, self.duration, share)
                )
            chosen = self._exchanged(pool, chosen)
        return [pool[k].piece for k in chosen]

    def _add(self, pool: list[MotionCandidate], piece: Piece) -> None:
        fitted = self.workshop.fitted(piece, self.duration)
        if fitted is None:
            return
        motion = self.workshop.recorded(self.workshop.course(fitted, self.duration))
        starts = [k * self.seconds / self.slots for k in range(self.slots)] if self.timed else [0.0]
        grams = tuple(
            self.alternatives.gram(self.alternatives.at(motion, start)) for start in starts
        )
        pool.append(MotionCandidate(fitted, grams))

    def _merit(self, pool: Sequence[MotionCandidate], chosen: Sequence[int]) -> float:
        gram = np.sum([pool[k].gram(slot) for slot, k in enumerate(chosen)], axis=0)
        return merit(self.alternatives.distances(gram)[0], self.enough)

    def _greedy(self, pool: Sequence[MotionCandidate]) -> list[int]:
        chosen: list[int] = []
        for _ in range(self.slots):
            chosen.append(
                int(np.argmax([self._merit(pool, [*chosen, k]) for k in range(len(pool))]))
            )
        return chosen

    def _exchanged(
        self, pool: Sequence[MotionCandidate], chosen: Sequence[int], sweeps: int = 3
    ) -> list[int]:
        """Each slot given the piece that is best beside the others, until nothing changes."""
        best = list(chosen)
        value = self._merit(pool, best)
        for _ in range(sweeps):
            before = value
            for slot in range(self.slots):
                others = [pool[k].gram(s) for s, k in enumerate(best) if s != slot]
                rest = np.sum(others, axis=0) if others else np.zeros_like(pool[0].grams[0])
                found = [
                    merit(self.alternatives.distances(rest + c.gram(slot))[0], self.enough)
                    for c in pool
                ]
                place = int(np.argmax(found))
                if found[place] > value:
                    best[slot] = place
                    value = found[place]
            if value <= before + 1e-3:
                break
        return best


def standard_course(workshop: Workshop, seconds: float) -> Trajectory:
    """The usual identification motion, for comparison: a multi-sine of all axes up to 0.42 Hz about
    the box's middle.

    Raises:
        InfeasibleError: none is inside the limits.
    """
    rng = np.random.default_rng(0)
    robot = workshop.robot
    harmonics = np.arange(1, 18)[:, None] / 40.0
    for _ in range(50):
        bell = np.exp(-(((harmonics - rng.uniform(0.05, 0.35, robot.n)) / 0.14) ** 2))
        weight = rng.uniform(0, 1, (17, robot.n)) * bell
        piece = Piece(
            "standard",
            robot.q_min + (robot.q_max - robot.q_min) * rng.uniform(0.4, 0.6, robot.n),
            weight,
            np.broadcast_to(harmonics, weight.shape),
            np.zeros_like(weight),
            rng.uniform(0, 2 * np.pi, weight.shape),
        )
        room = 0.3 * (robot.q_max - robot.q_min)
        factor = allowed(robot, piece, seconds, room, 0.45, 2000)
        fitted = workshop.fitted(piece.scaled(factor), seconds)
        if fitted is not None:
            return workshop.course(fitted, seconds)
    raise InfeasibleError(
        f"no standard motion is inside the limits of {robot.name}: check torque limits and joint "
        "box"
    )
