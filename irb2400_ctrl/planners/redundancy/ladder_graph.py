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
from irb2400_ctrl.model.inverse_kinematics import BRANCHES
from irb2400_ctrl.planners.clearance.crowd import Crowd
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.ladder_moves import LadderMoves, Node, Turns
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE, relative_margins
from irb2400_ctrl.planners.toolpath.orientation import Orientation

ROOM = np.radians(3.0)
"""distance kept from the ends of the joint box where a rotation is smoothed afterwards [rad]"""
# distance kept from the ends of the joint box, room for the spline between stations [rad]
BOX_INSET = np.radians(0.2)
# turns of the tool between neighbouring stations, in steps of the rotation grid
FREE_SHIFTS = (0, -1, 1, -2, 2)

PRICE_OF_GIVING_WAY = 1.0
"""cost of a configuration that gives way as far as most do: more than any motion between two [s]"""
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
        """The same at poses X_BT (n, r, 4, 4).

        Raises:
            InputError: an arm without a closed form, whose branches are not eight.
        """
        _ = model.arm_geometry
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
        boxed = self._inside.any(axis=3)
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
        return np.asarray(self._inside[station])

    @cached_property
    def _inside(self) -> npt.NDArray[np.bool_]:
        """Of all stations, shape (n, r, 8, k)."""
        low = self.model.robot.q_min + self.inset
        high = self.model.robot.q_max - self.inset
        held = np.ones((*self.q.shape[:3], len(self.turns)), dtype=bool)
        with np.errstate(invalid="ignore"):
            for j in range(self.q.shape[-1]):
                q = self.q[..., j]
                if j in self.wound:
                    whole = self.turns[:, self.wound.index(j)]
                    for turn in np.unique(whole):
                        angle = q + 2 * np.pi * turn
                        within = (angle >= low[j]) & (angle <= high[j])
                        held[..., whole == turn] &= within[..., None]
                else:
                    held &= ((q >= low[j]) & (q <= high[j]))[..., None]
        return held

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
        found: list[tuple[float, float, Node, list[Turns]]] = []
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
        moves = self.moves(shifts)
        value = self.node_value(0, level)
        back: list[Turns] = []
        for i in range(1, len(self.u) if stations is None else stations):
            node = self.node_value(i, level)
            if level is None:
                value, taken = moves.widest(i, value, node)
            else:
                value, taken = moves.cheapest(i, value, node)
            back.append(taken)
            if not (value > 0).any() if level is None else not np.isfinite(value).any():
                break
        return value, back

    def moves(self, shifts: tuple[int, ...]) -> LadderMoves:
        """The edges, where the tool may turn by these steps of the grid between stations."""
        if shifts not in self._moves:
            q_and_turns = (self.q, self.turns, self.wound)
            self._moves[shifts] = LadderMoves(*q_and_turns, self.model.robot.qd_max, shifts)
        return self._moves[shifts]

    @cached_property
    def _moves(self) -> dict[tuple[int, ...], LadderMoves]:
        return {}

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

    def _trace(
        self, end: Node, back: list[Turns], shifts: tuple[int, ...], cost: float
    ) -> LadderWay:
        moves = self.moves(shifts)
        node = end
        rows = [node[0]]
        for i in range(len(back), 0, -1):
            node = moves.source(i, node, int(back[i - 1][node]))
            rows.append(node[0])
        row, branch, turn = node
        rows.reverse()
        margin = float(self.margin[np.arange(len(rows)), rows, branch].min())
        rotation = np.unwrap(self.rotation[rows])
        q_start = self.q[0, row, branch].copy()
        q_start[self.wound] += 2 * np.pi * self.turns[turn]
        return LadderWay(rotation, np.full(len(rows), branch), q_start, margin, cost)
