"""Edges of a ladder: from which nodes of a station a joint moves continuously into those of the
next, and how long that takes."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers

# a joint that moves further between neighbouring stations than this has jumped to another solution
# [rad]
LARGEST_STEP = np.radians(60)
Turns = npt.NDArray[np.int8]
"""index of a shift of the rotation: few, and there are millions"""
Node = tuple[int, int, int]
"""rotation, branch, whole turns"""
# whole turns by which angles of neighbouring stations, in (-pi, pi], are looked up to differ
_MOST_WHOLE = 2
# cost of a step of the rotation grid, squared: of ways equally fast the straighter one [s]
_PRICE_OF_TURNING = 1e-3


class _Edges(NamedTuple):
    """Into the nodes of one station."""

    cost: Array
    """the time that the joints take at full speed, and a little for a turn of the tool [s]; inf
    where a joint jumps, shape (shifts, r, b)"""
    wound: tuple[Integers, ...]
    """shifts, rotations and branches of the few between which base angles differ by whole turns,
    each (m,)"""
    code: Integers
    """of their whole turns, shape (m,)"""


@dataclass(frozen=True, eq=False)
class LadderMoves:
    """The edges between neighbouring stations, for some turns of the tool between them."""

    q: Array
    """configurations [rad], shape (n, r, b, 6); not finite where there is none"""
    turns: Array
    """whole turns of the wound axes that nodes may carry, shape (k, number of wound axes)"""
    wound: list[int]
    """zero-based axes whose whole turns the nodes carry"""
    qd_max: Array
    """full speed of the joints [rad/s], shape (6,)"""
    shifts: tuple[int, ...]
    """allowed turns of the tool between stations, in steps of the rotation grid"""

    def widest(self, i: int, value: Array, node: Array) -> tuple[Array, Turns]:
        """The smallest margin on the best way to each node of station i, and the number of the
        shift by which it comes.

        Args:
            value: the same of the station before, shape (r, b, k); -1 where no way leads.
            node: margin of the nodes of station i by themselves, shape (r, b, k).
        """
        edges = self._edges(i)
        came = self._came(edges, value, -1.0)
        came[~np.isfinite(edges.cost)] = -1.0
        reached = np.minimum(came, node)
        return reached.max(axis=0), reached.argmax(axis=0).astype(np.int8)

    def cheapest(self, i: int, value: Array, node: Array) -> tuple[Array, Turns]:
        """The cost of the best way to each node of station i [s], and the number of the shift by
        which it comes; as `widest`, inf where no way leads."""
        edges = self._edges(i)
        reached = self._came(edges, value, np.inf) + node
        reached += edges.cost[..., None]
        return reached.min(axis=0), reached.argmin(axis=0).astype(np.int8)

    def source(self, i: int, node: Node, number: int) -> Node:
        """The node of the station before from which the shift of that number leads to one of
        station i."""
        row, branch, turn = node
        edges = self._edges(i)
        before = int(self._before[number, row])
        for k in np.flatnonzero((np.stack(edges.wound) == [[number], [row], [branch]]).all(axis=0)):
            turn = int(self._turns_before[edges.code[k], turn])
        return before, branch, turn

    def _came(self, edges: _Edges, value: Array, nothing: float) -> Array:
        """Value of the nodes that each node of a station comes from, shape (shifts, r, b, k)."""
        came = value[self._before]
        number, row, branch = edges.wound
        if len(number):
            known = np.append(value, np.full((*value.shape[:2], 1), nothing), axis=2)
            before = self._before[number, row]
            turn = self._turns_before[edges.code]
            came[edges.wound] = known[before[:, None], branch[:, None], turn]
        return np.asarray(came)

    @cached_property
    def _before(self) -> Integers:
        """Rotation that each comes from, shape (shifts, r)."""
        count = self.q.shape[1]
        return np.asarray((np.arange(count) - np.array(self.shifts)[:, None]) % count)

    def _edges(self, i: int) -> _Edges:
        if i not in self._found:
            self._found[i] = self._found_edges(i)
        return self._found[i]

    @cached_property
    def _found(self) -> dict[int, _Edges]:
        return {}

    def _found_edges(self, i: int) -> _Edges:
        step = self.q[i] - self.q[i - 1][self._before]
        turning = np.array(self.shifts, dtype=float)[:, None, None] ** 2
        with np.errstate(invalid="ignore"):
            whole = np.round(step[..., self.wound] / (2 * np.pi))
            step[..., self.wound] -= 2 * np.pi * whole
            size = np.abs(step)
            # no number compares false
            joined = (size < LARGEST_STEP).all(axis=-1) & (np.abs(whole) <= _MOST_WHOLE).all(-1)
        time = np.where(joined, (size / self.qd_max).max(axis=-1), np.inf)
        wound = np.nonzero(joined & (whole != 0).any(axis=-1))
        base = (2 * _MOST_WHOLE + 1) ** np.arange(len(self.wound))[::-1]
        code = (whole[wound] + _MOST_WHOLE) @ base
        return _Edges(time + _PRICE_OF_TURNING * turning, wound, code.astype(int))

    @cached_property
    def _turns_before(self) -> Integers:
        """Which of its whole turns a node comes from, for every combination of whole turns between
        two stations; -1 where that lies outside, shape (codes, k)."""
        steps = range(-_MOST_WHOLE, _MOST_WHOLE + 1)
        whole = np.array(list(itertools.product(steps, repeat=len(self.wound))))
        first = self.turns.min(axis=0)
        count = (self.turns.max(axis=0) - first + 1).astype(int)
        wanted = (self.turns + whole[:, None, :] - first).astype(np.int64)
        valid = ((wanted >= 0) & (wanted < count)).all(axis=-1)
        place = np.zeros(wanted.shape[:-1], dtype=np.int64)
        for k, size in enumerate(count):
            place = place * size + wanted[..., k]
        return np.asarray(np.where(valid, place, -1))
