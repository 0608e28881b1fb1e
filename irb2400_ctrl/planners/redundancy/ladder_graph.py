"""Choice of the branch and of the free tool rotation over a whole path (ladder graph, dynamic
programming).

Nodes are (station, rotation, branch, whole turns); edges join neighbouring stations
where every joint moves continuously, and are never stored. Two sweeps, lexicographic: the largest
smallest margin first, then, among the nodes that keep it, the shortest motion.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance.crowd import Crowd
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE, relative_margins
from irb2400_ctrl.planners.toolpath.orientation import Orientation

BRANCHES = 8
# a joint that moves further between neighbouring stations than this has jumped to another solution
# [rad]
LARGEST_STEP = np.radians(60)
# distance kept from the ends of the joint box, room for the spline between stations [rad]
BOX_INSET = np.radians(0.2)
# turns of the tool between neighbouring stations, in steps of the rotation grid
FREE_SHIFTS = (0, -1, 1, -2, 2)

Turns = npt.NDArray[np.int8]
"""index of whole turns, or of a shift of the rotation: few, and there are millions"""
PRICE_OF_GIVING_WAY = 1.0
"""cost of a configuration that gives way as far as most do: more than any motion between two [s]"""
# whole turns by which angles of neighbouring stations, in (-pi, pi], are looked up to differ
_MOST_WHOLE = 2
MOST_TURNS = 27
"""combinations of whole turns that a node may carry; what is beyond is not looked for"""


def wound_axes(model: Model) -> list[int]:
    """Zero-based axes whose whole turns a path may use: the two that an arm of the family winds
    (4 and 6 of a spherical wrist), and others whose range goes beyond half a turn either way."""
    low = model.robot.q_min
    high = model.robot.q_max
    beyond = np.flatnonzero((low < -np.pi - 1e-9) | (high > np.pi + 1e-9))
    axes = list(model.arm_geometry.wound)
    turns = np.floor((high + np.pi) / (2 * np.pi)) - np.ceil((low - np.pi) / (2 * np.pi)) + 1
    for j in (3, 4, 0, 2, 1):
        if j in beyond and j not in axes and np.prod(turns[[*axes, j]]) <= MOST_TURNS:
            axes.append(j)
    return sorted(axes)


@dataclass(frozen=True)
class LadderWay:
    """One way through the ladder."""

    rotation: Array
    """free rotation at each station, continuous [rad], shape (n,)"""
    branch: Integers
    """closed-form branch at each station, shape (n,)"""
    q_start: Array
    """configuration at the first station, whole turns included [rad], shape (6,)"""
    margin: float
    """smallest relative margin at the stations [-]"""
    cost: float
    """sum over stations of the largest time a joint needs at full speed [s]"""


@dataclass(frozen=True)
class Ladder:
    """All configurations of a path's stations."""

    model: Model
    u: Array
    """curve parameters of the stations, shape (n,)"""
    rotation: Array
    """grid of tool rotations [rad], shape (r,)"""
    q: Array
    """[rad], shape (n, r, 8, 6); not finite where a branch does not exist"""
    overreach: Array
    """distance by which the wrist centre is out of reach [m], shape (n, r, 8)"""
    margin: Array
    """relative margin, smallest of three, shape (n, r, 8)"""
    turns: Array
    """whole turns of the wound axes that nodes may carry, shape (k, number of wound axes)"""
    inset: float = BOX_INSET
    """distance kept from the ends of the joint box [rad]"""
    external: Array | None = None
    """angles of the axes that carry the part at the stations [rad], shape (n, k); None: it
    stands"""
    crowd: Crowd | None = None
    """what the nodes are near to; None where it is not known"""
    price: Array | None = None
    """further cost of the nodes, beside the time of the motion [s], shape (n, r, 8)"""

    @classmethod
    def of(cls, model: Model, orientation: Orientation, u: Array, rotation: Array) -> Ladder:
        """Closed-form inverse kinematics of all stations and rotations."""
        found = cls.at(model, u, rotation, orientation.fan(u, rotation))
        return replace(found, external=orientation.external(u))

    @classmethod
    def at(cls, model: Model, u: Array, rotation: Array, X: Array) -> Ladder:
        """The same at poses X_BT (n, r, 4, 4)."""
        n = len(u)
        r = len(rotation)
        found = model.inverse_kinematics_branches(X.reshape(-1, 4, 4))
        q = found.q.reshape(n, r, BRANCHES, 6)
        margin = np.nan_to_num(relative_margins(model, q).min(axis=-1), nan=-1.0)
        low = model.robot.q_min
        high = model.robot.q_max
        # base angles lie in (-pi, pi]
        ranges = [
            np.arange(
                np.ceil((low[j] - np.pi) / (2 * np.pi)),
                np.floor((high[j] + np.pi) / (2 * np.pi)) + 1,
            )
            for j in wound_axes(model)
        ]
        turns = np.array(list(itertools.product(*ranges)))
        return cls(model, u, rotation, q, found.overreach.reshape(n, r, BRANCHES), margin, turns)

    @cached_property
    def wound(self) -> list[int]:
        """Zero-based axes whose whole turns the nodes carry."""
        return wound_axes(self.model)

    def free_of(self, scene: Scene, cutting: npt.NDArray[np.bool_]) -> Ladder:
        """The same without the nodes that touch something.

        Args:
            scene: the arm in its cell.
            cutting: stations at which the tool may cut, shape (n,).
        """
        boxed = np.array([self.inside(i).any(axis=2) for i in range(len(self.u))])
        usable = boxed & (self.margin > 0)
        turned = np.empty((len(self.u), 0)) if self.external is None else self.external
        return replace(self, crowd=Crowd.of(scene, self.q, usable, cutting, turned))

    def priced(
        self, scene: Scene | None, cutting: npt.NDArray[np.bool_], load: CuttingLoad | None
    ) -> Ladder:
        """`free_of` a scene and `giving_way` to a load, where there are such."""
        ladder = self if scene is None else self.free_of(scene, cutting)
        return ladder if load is None else ladder.giving_way(load)

    def giving_way(self, load: CuttingLoad) -> Ladder:
        """The same with a price on how far the tip gives way to a force."""
        given = load.deflection(self.model, self.q)
        usual = float(np.nanmedian(given)) if np.isfinite(given).any() else 1.0
        return replace(self, price=PRICE_OF_GIVING_WAY * given / usual)

    def allowed(self, station: int) -> npt.NDArray[np.bool_]:
        """Nodes of a station within the joint box that touch nothing, shape (r, 8, k)."""
        inside = self.inside(station)
        if self.crowd is None:
            return inside
        return np.asarray(inside & self.crowd.free(station)[..., None])

    def inside(self, station: int) -> npt.NDArray[np.bool_]:
        """Nodes of a station within the joint box, shape (r, 8, k)."""
        low = self.model.robot.q_min + self.inset
        high = self.model.robot.q_max - self.inset
        q = self.q[station]
        with np.errstate(invalid="ignore"):
            others = [j for j in range(q.shape[-1]) if j not in self.wound]
            fixed = ((q >= low) & (q <= high))[..., others].all(axis=-1)
            held = np.broadcast_to(fixed[..., None], (*fixed.shape, len(self.turns)))
            for k, j in enumerate(self.wound):
                angle = q[..., j, None] + 2 * np.pi * self.turns[:, k]
                held = held & (angle >= low[j]) & (angle <= high[j])
        return np.asarray(held)

    def best(
        self, shifts: tuple[int, ...], *, per_rotation: bool = False, keep: int = 4
    ) -> list[LadderWay]:
        """The best ways through the ladder, at most one per branch (and per rotation), best first.

        Args:
            shifts: allowed turns of the tool between stations, in grid steps; (0,) holds it
                constant.
            per_rotation: one candidate for every end rotation instead of the best one per branch.
            keep: how many to return.
        """
        margin, _ = self.sweep(shifts, level=None)
        ends = margin.max(axis=2)
        # more than comfortable is worth nothing: let the length of the motion decide there
        capped = np.minimum(ends, COMFORTABLE)
        candidates = []
        for branch in range(BRANCHES):
            rows = (
                range(len(self.rotation)) if per_rotation else [int(np.argmax(capped[:, branch]))]
            )
            candidates += [
                (float(capped[row, branch]), branch, row) for row in rows if capped[row, branch] > 0
            ]
        if not candidates:
            return []
        # ways of clearly smaller margin than the best are not followed further
        level = max(m for m, _, _ in candidates)
        found: list[tuple[float, float, tuple[int, int, int], list[Turns]]] = []
        sweeps: dict[float, tuple[Array, list[Turns]]] = {}
        for m, branch, row in candidates:
            if m < 0.9 * level:
                continue
            # a few levels, so that ways of nearly equal margin share a sweep
            floor = 0.99 * level * 0.97 ** np.ceil(np.log(level / m) / -np.log(0.97))
            if floor not in sweeps:
                cost, back = self.sweep(shifts, level=floor)
                sweeps[floor] = (cost, back)
            cost, back = sweeps[floor]
            slice_ = cost[row, branch] if per_rotation else cost[:, branch].min(axis=0)
            if not np.isfinite(slice_.min()):
                continue
            end_row = row if per_rotation else int(np.argmin(cost[:, branch].min(axis=1)))
            end = (end_row, branch, int(np.argmin(cost[end_row, branch])))
            found.append((-round(m, 3), float(cost[end]), end, back))
        found.sort(key=lambda way: way[:2])
        return [self._trace(end, back, shifts, cost) for _, cost, end, back in found[:keep]]

    def sweep(
        self, shifts: tuple[int, ...], level: float | None, stations: int | None = None
    ) -> tuple[Array, list[Turns]]:
        """One pass over the (first) stations: bottleneck margin (level None), or cost among nodes
        of margin >= level.

        Returns the value of the nodes of the last station, shape (r, 8, k), and the shift taken
        into each station.
        """
        r = self.q.shape[1]
        k = len(self.turns)
        worst = -1.0 if level is None else np.inf
        node = self.node_value(0, level)
        value = node
        back: list[Turns] = []
        for i in range(1, len(self.u) if stations is None else stations):
            node = self.node_value(i, level)
            best = np.full((r, BRANCHES, k), worst)
            taken = np.full((r, BRANCHES, k), -1, dtype=np.int8)
            for number, shift in enumerate(shifts):
                time, source = self.moves(i, shift)
                came = np.take_along_axis(
                    np.roll(value, shift, axis=0), np.maximum(source, 0), axis=2
                )
                came = np.where(source >= 0, came, worst)
                if level is None:
                    reached = np.minimum(came, node)
                    better = reached > best
                else:
                    reached = came + node + (time + 1e-3 * shift**2)[..., None]
                    better = reached < best
                best = np.where(better, reached, best)
                taken[better] = number
            value = best
            back.append(taken)
            if not (value > 0).any() if level is None else not np.isfinite(value).any():
                break
        return value, back

    def moves(self, i: int, shift: int) -> tuple[Array, Turns]:
        """Time that the joints take at full speed into station i from the rotations `shift` below
        [s], (r, 8), and the index of the whole turns they come from, -1 where there is none, (r, 8,
        k)."""
        if (i, shift) not in self._moves:
            self._moves[i, shift] = self._found_moves(i, shift)
        return self._moves[i, shift]

    @cached_property
    def _moves(self) -> dict[tuple[int, int], tuple[Array, Turns]]:
        return {}

    def _found_moves(self, i: int, shift: int) -> tuple[Array, Turns]:
        step = self.q[i] - np.roll(self.q[i - 1], shift, axis=0)
        with np.errstate(invalid="ignore"):
            whole = np.round(step[..., self.wound] / (2 * np.pi))
            step[..., self.wound] -= 2 * np.pi * whole
            joined = (np.abs(step) < LARGEST_STEP).all(axis=-1)
        time = np.nan_to_num(np.abs(step) / self.model.robot.qd_max, nan=np.inf).max(axis=-1)
        return time, np.where(joined[..., None], self._source(whole), -1).astype(np.int8)

    def node_value(self, i: int, level: float | None) -> Array:
        """What the nodes of a station are worth by themselves, shape (r, 8, k)."""
        allowed = self.allowed(i)
        margin = self.margin[i][..., None]
        if level is None:
            return np.where(allowed, margin, -1.0)
        cost = np.zeros(margin.shape) if self.crowd is None else self.crowd.cost(i)[..., None]
        if self.price is not None:
            cost = cost + self.price[i][..., None]
        return np.where(allowed & (margin >= level), cost, np.inf)

    def _source(self, whole: Array) -> Turns:
        """Index into `turns` a node comes from, -1 where that lies outside, shape (r, 8, k)."""
        # no number compares false
        known = np.asarray((np.abs(whole) <= _MOST_WHOLE).all(axis=-1))
        code = np.zeros(whole.shape[:-1], dtype=np.int64)
        for k in range(whole.shape[-1]):
            step = np.where(known, whole[..., k], 0.0).astype(np.int64)
            code = code * (2 * _MOST_WHOLE + 1) + step + _MOST_WHOLE
        return np.asarray(np.where(known[..., None], self._sources[code], -1))

    @cached_property
    def _sources(self) -> Turns:
        """`_source` for every combination of whole turns between two stations, shape (codes,
        k)."""
        steps = range(-_MOST_WHOLE, _MOST_WHOLE + 1)
        whole = np.array(list(itertools.product(steps, repeat=len(self.wound))))
        first = self.turns.min(axis=0)
        count = (self.turns.max(axis=0) - first + 1).astype(int)
        wanted = (self.turns + whole[:, None, :] - first).astype(np.int64)
        valid = ((wanted >= 0) & (wanted < count)).all(axis=-1)
        place = np.zeros(wanted.shape[:-1], dtype=np.int64)
        for k, size in enumerate(count):
            place = place * size + wanted[..., k]
        return np.asarray(np.where(valid, place, -1).astype(np.int8))

    def _trace(
        self, end: tuple[int, int, int], back: list[Turns], shifts: tuple[int, ...], cost: float
    ) -> LadderWay:
        row, branch, turn = end
        rows = [row]
        for i in range(len(back), 0, -1):
            number = int(back[i - 1][row, branch, turn])
            step = self.q[i, row, branch]
            previous = (row - shifts[number]) % len(self.rotation)
            whole = np.round((step - self.q[i - 1, previous, branch])[self.wound] / (2 * np.pi))
            turn = int(self._source(whole.reshape(1, 1, -1))[0, 0, turn])
            row = previous
            rows.append(row)
        rows.reverse()
        margin = float(self.margin[np.arange(len(rows)), rows, branch].min())
        rotation = np.unwrap(self.rotation[rows])
        q_start = self.q[0, row, branch].copy()
        q_start[self.wound] += 2 * np.pi * self.turns[turn]
        return LadderWay(rotation, np.full(len(rows), branch), q_start, margin, cost)
