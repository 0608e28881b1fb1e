"""Where to leave a path and come back in another configuration, at least cost.

The ladder gets a second kind of edge: at a station the tool may be retracted, all joints move to
any other configuration of the same place (another branch, rotation or whole turn), and the tool
comes back. Such an edge costs its time, and a mark where the tool is cutting. What is looked for
is the cheapest way through, so that it is left as seldom as possible.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.model.inverse_kinematics import BRANCHES
from irb2400_ctrl.planners.redundancy.ladder_graph import ROOM, Ladder
from irb2400_ctrl.planners.redundancy.ladder_moves import Node, Turns
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE

# margins at the stations that are tried, the largest with the fewest re-entries wins [-]
_LEVELS = (COMFORTABLE, 0.15, 0.05)
# a re-entry is looked for at every so many stations
_STRIDE = 3

CostOf = Callable[[int], float]
"""what leaving the path at a station and coming back costs, the move of the joints apart [s]; inf
where it cannot be"""
FreeOf = Callable[[int], Array]
"""which nodes of a station can be left along the way out, shape (r, 8)"""


def cheapest_reentries(
    ladder: Ladder, shifts: tuple[int, ...], cost_of: CostOf, free_of: FreeOf
) -> tuple[int, ...] | None:
    """The stations where the path is left and entered again on the cheapest way with the fewest
    re-entries among a few levels of the margin; among equals that of the largest margin. None
    where even re-entries lead nowhere."""
    cost = functools.cache(lambda i: np.inf if i % _STRIDE else cost_of(i))
    free = functools.cache(free_of)
    for inset in (max(ladder.inset, ROOM), ladder.inset):
        roomy = replace(ladder, inset=inset)
        fewest = _Sweep(roomy, shifts, 0.0, cost, free).run()
        if fewest is None:
            continue
        for level in _LEVELS:
            found = _Sweep(roomy, shifts, level, cost, free).run()
            if found is not None and len(found) <= len(fewest):
                return found
        return fewest
    return None


@dataclass(frozen=True)
class _Sweep:
    """One pass over the stations, among nodes of at least some margin."""

    ladder: Ladder
    shifts: tuple[int, ...]
    level: float
    cost_of: CostOf
    free_of: FreeOf

    def run(self) -> tuple[int, ...] | None:
        """Cost of the nodes from station to station; how they were reached is kept to trace it."""
        ladder = self.ladder
        moves = ladder.moves(self.shifts)
        value = ladder.node_value(0, self.level)
        moved: list[Turns] = []
        entered: list[Integers | None] = [None]
        for i in range(1, len(ladder.u)):
            value, taken = moves.cheapest(i, value, ladder.node_value(i, self.level))
            moved.append(taken)
            value, came = self._entered(i, value)
            entered.append(came)
            if not np.isfinite(value).any():
                return None
        return self._traced(value, moved, entered)

    def _entered(self, i: int, value: Array) -> tuple[Array, Integers | None]:
        """The edges of a re-entry at station i, from the cheapest node of each branch to all."""
        fixed = self.cost_of(i)
        if not np.isfinite(fixed) or not np.isfinite(value).any():
            return value, None
        free = self.free_of(i)[..., None]
        node = np.where(free, self.ladder.node_value(i, self.level), np.inf)
        leaving = np.where(free, value, np.inf)
        q = self._configurations(i)
        speed = self.ladder.model.robot.qd_max
        best = value
        source = np.full(value.shape, -1, dtype=np.int64)
        for branch in range(BRANCHES):
            cheapest = int(np.argmin(leaving[:, branch]))
            row, turn = np.unravel_index(cheapest, leaving[:, branch].shape)
            cost = leaving[row, branch, turn]
            if not np.isfinite(cost):
                continue
            away = np.nan_to_num(np.abs(q - q[row, branch, turn]) / speed, nan=np.inf)
            reached = cost + fixed + away.max(axis=-1) + node
            better = reached < best
            number = np.ravel_multi_index((int(row), branch, int(turn)), value.shape)
            source = np.where(better, number, source)
            best = np.where(better, reached, best)
        return best, source

    def _configurations(self, i: int) -> Array:
        """Of all nodes of a station, whole turns included [rad], shape (r, 8, k, 6)."""
        ladder = self.ladder
        q = np.repeat(ladder.q[i][:, :, None], len(ladder.turns), axis=2)
        q[..., ladder.wound] += 2 * np.pi * ladder.turns
        return q

    def _traced(
        self,
        value: Array,
        moved: list[Turns],
        entered: list[Integers | None],
    ) -> tuple[int, ...]:
        """The stations of the re-entries on the cheapest way."""
        ladder = self.ladder
        moves = ladder.moves(self.shifts)
        node = _node(int(np.argmin(value)), value)
        found = []
        for i in range(len(ladder.u) - 1, 0, -1):
            came = entered[i]
            if came is not None and came[node] >= 0:
                found.append(i)
                node = _node(int(came[node]), value)
            node = moves.source(i, node, int(moved[i - 1][node]))
        return tuple(sorted(found))


def _node(number: int, value: Array) -> Node:
    """Rotation, branch and whole turns of a node by its number among those of `value`."""
    row, branch, turn = np.unravel_index(number, value.shape)
    return int(row), int(branch), int(turn)
