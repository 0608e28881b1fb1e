"""`Scene`: an arm in its cell, and how near its bodies are to each other and to the cell."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.util import find_spec
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell.arm_space import arm_space
from irb2400_ctrl.cell.description import Cell, CellTool
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.cell.narrow import Narrow, load_coal
from irb2400_ctrl.cell.piece import Piece, cell_pieces, no_namesakes
from irb2400_ctrl.cell.reach import rates, reach
from irb2400_ctrl.cell.rough import Rough
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.chain import chain_of
from irb2400_ctrl.robot import Robot

# taken off every distance: what rounding may hide [m]
ROUNDING = 1e-9
# configurations that are looked at in one go
_CHUNK = 8192


@dataclass(frozen=True, eq=False)
class Scene:
    """Pairs of pieces that must not touch: first those of the arm itself, then those with the cell.

    Where a shape of the arm is no capsule, the capsule around it says how near it may be to the
    rest of the arm, and coal, where it is installed, how near it is.
    """

    model: Model
    robot: Robot
    """the arm with the TCP of its file"""
    tool: CellTool | None
    """of the cell, in the spindle"""
    arm: tuple[Piece, ...]
    things: tuple[Piece, ...]
    own: tuple[tuple[int, int], ...]
    """numbers in `arm`, the link nearer to the base first"""
    outer: tuple[tuple[int, int], ...]
    """numbers in `arm` and in `things`"""
    keep: float = 0.0
    """a motion stays at least so far from everything [m]; how near a tool comes to what it cuts is
    its program's to say (`kept`)"""
    external: ExternalAxes | None = None
    """axes that carry the work object, or the arm; configurations then have their angles behind the
    arm's"""
    triangles: dict[Any, Any] = field(default_factory=dict)
    """of coal by shape, filled as they are needed: a large mesh is built once"""

    @classmethod
    def of(
        cls, model: Model, robot: Robot, cell: Cell | None = None, tool: CellTool | None = None
    ) -> Scene | None:
        """The scene of an arm; None where its file says nothing of the space it takes up.

        Args:
            model: the arm as it is planned for, with the TCP of the tool.
            robot: the arm with the TCP of its file, in which the shapes of the spindle are stated.
            cell: what stands around it.
            tool: of the cell, in the spindle.

        Raises:
            InputError: a mesh cannot be read, coal is not installed, or two bodies have one name.
        """
        if robot.outline is None:
            return None
        arm, own, _ = arm_space(robot, tool)
        things = [] if cell is None else cell_pieces(cell, robot)
        no_namesakes(arm, things)
        if things:
            load_coal()
        outer = [(i, k) for i, p in enumerate(arm) if p.link > 0 for k in range(len(things))]
        if not own and not outer:
            return None
        keep = 0.0 if cell is None else cell.clearance_mm / 1e3
        external = None if cell is None else cell.external_axes
        return cls(model, robot, tool, arm, tuple(things), own, tuple(outer), keep, external)

    def placed(self, X: Array) -> Scene:
        """The same with the work object, and all that stands in its frame, at X_BW (4, 4) [m]."""
        things = tuple(
            replace(piece, X=X) if piece.on_work_object else piece for piece in self.things
        )
        return replace(self, things=things)

    def standing(self, e: Array) -> Scene:
        """The same with the further axes at e (k,) [rad, m of a rail]."""
        if self.external is None:
            return self
        M = self.external.turned(e[None])[0]
        slides = self.external.slides
        still = self.external.rail.turned(e[None, :slides])[0]
        moved = (replace(p, X=(M if p.on_work_object else still) @ p.X) for p in self.things)
        return replace(self, things=tuple(moved), external=None)

    def shifted(self, X: Array) -> Scene:
        """The same with all of the cell moved by X (4, 4) [m]."""
        things = tuple(replace(piece, X=X @ piece.X) for piece in self.things)
        return replace(self, things=things)

    @property
    def pairs(self) -> int:
        """Number of pairs."""
        return len(self.own) + len(self.outer)

    def names(self, pair: int) -> tuple[str, str]:
        """What the two bodies of a pair are called."""
        if pair < len(self.own):
            i, j = self.own[pair]
            return self.arm[i].name, self.arm[j].name
        i, k = self.outer[pair - len(self.own)]
        return self.arm[i].name, self.things[k].name

    @cached_property
    def cutting(self) -> npt.NDArray[np.bool_]:
        """Pairs that may touch at feed: what cuts and what may be cut, shape (pairs,)."""
        outer = [self.arm[i].cuts and self.things[k].may_be_cut for i, k in self.outer]
        return np.array([False] * len(self.own) + outer, dtype=np.bool_)

    @cached_property
    def kept(self) -> Array:
        """What the moves of a program keep between the bodies of each pair, shape (pairs,) [m]:
        between what cuts and what may be cut they need not touch, no more."""
        return np.where(self.cutting, 0.0, self.keep)

    def near(self, q: Array) -> tuple[Array, Array]:
        """Distances of the arm's own pairs as capsules (m, own) [m] and the poses of base and links
        (m, n + 1, 3, 4) at q (m, n); where the work object is carried, the poses that it sees
        follow, and where the arm is, those that the floor sees."""
        n = self.model.robot.n
        own, rows = arm_space(self.robot, self.tool)[2].map(q[:, :n])
        poses = rows.reshape(len(q), -1, 3, 4)
        if self.external is not None:
            M = self.external.turned(q[:, n:])
            seen = [poses, _seen(M, poses)]
            if self.external.slides:
                seen.append(_seen(self.external.rail.turned(q[:, n : n + 1]), poses))
            poses = np.concatenate(seen, axis=1)
        return own - ROUNDING, poses

    @cached_property
    def _poses(self) -> list[int]:
        """Which pose of a configuration the arm's body of each pair with the cell has."""
        bodies = self.model.robot.n + 1
        part = 0 if self.external is None else bodies
        floor = 0 if self.external is None or not self.external.slides else 2 * bodies
        return [
            self.arm[i].link + (part if self.things[k].on_work_object else floor)
            for i, k in self.outer
        ]

    @cached_property
    def _rough(self) -> Rough:
        return Rough(self.arm, self.things, self.outer, self._poses)

    def rough(self, poses: Array) -> Array:
        """Lower bounds of the distances to the cell, shape (m, outer) [m]; cheap, not tight."""
        return self._rough(poses) - ROUNDING

    @cached_property
    def _narrow(self) -> list[Narrow]:
        return [Narrow.of(self.arm[i], self.things[k], self.triangles) for i, k in self.outer]

    @cached_property
    def _local(self) -> list[Array]:
        return [piece.pose() for piece in self.arm]

    def exact(self, number: int, poses: Array) -> Array:
        """Distance of one pair with the cell at the poses of `near`, shape (m,) [m]."""
        i, _ = self.outer[number]
        narrow = self._narrow[number]
        local = self._local[i]
        link = poses[:, self._poses[number]]
        R = link[:, :, :3] @ local[:3, :3]
        p = link[:, :, :3] @ local[:3, 3] + link[:, :, 3]
        found = [narrow.distance(R[m], p[m]) for m in range(len(poses))]
        return np.array(found) - ROUNDING

    @cached_property
    def measured(self) -> tuple[int, ...]:
        """Numbers of the pairs of which `near` and `rough` say a lower bound only."""
        if self._around is None:
            return tuple(range(len(self.own), self.pairs))
        return (*self._around, *range(len(self.own), self.pairs))

    @cached_property
    def _around(self) -> dict[int, Narrow] | None:
        """Own pairs that are not both capsules, for coal; None where it is not installed."""
        pairs = [
            number
            for number, pair in enumerate(self.own)
            if not all(self.arm[k].is_capsule for k in pair)
        ]
        if not pairs or find_spec("coal") is None:
            return None
        own = [tuple(self.arm[k] for k in self.own[number]) for number in pairs]
        return {n: Narrow.of(a, b, self.triangles) for n, (a, b) in zip(pairs, own, strict=True)}

    def distance(self, number: int, poses: Array) -> Array:
        """Of one of the `measured` pairs at poses (m, n + 1, 3, 4), shape (m,) [m]."""
        if number >= len(self.own):
            return self.exact(number - len(self.own), poses)
        assert self._around is not None
        i, j = self.own[number]
        local = self._local[i]
        first = poses[:, self.arm[i].link]
        other = poses[:, self.arm[j].link]
        back = other[:, :, :3].transpose(0, 2, 1)
        R = back @ first[:, :, :3]
        p = np.einsum("mij,mj->mi", back, first[:, :, 3] - other[:, :, 3])
        p = p + R @ local[:3, 3]
        R = R @ local[:3, :3]
        narrow = self._around[number]
        return np.array([narrow.distance(R[m], p[m]) for m in range(len(poses))]) - ROUNDING

    @cached_property
    def carried(self) -> npt.NDArray[np.bool_]:
        """Pairs of what the last link carries and the cell, shape (pairs,)."""
        outer = [self.arm[i].link == self.model.robot.n for i, _ in self.outer]
        return np.array([False] * len(self.own) + outer, dtype=bool)

    def clearance(
        self,
        q: Array,
        cutting: npt.NDArray[np.bool_],
        most: float,
        pairs: npt.NDArray[np.bool_] | None = None,
        kept: Array | None = None,
    ) -> Array:
        """Smallest distance at q (m, n), or `most` where all is further away, shape (m,) [m].

        Args:
            q: [rad].
            cutting: where what cuts may touch what may be cut, shape (m,).
            most: what lies further away is not looked at closely.
            pairs: those to look at, shape (pairs,); default all.
            kept: taken off the distance of each pair, shape (pairs,) [m], such as `kept`.
        """
        asked = np.ones(self.pairs, dtype=bool) if pairs is None else pairs
        off = np.zeros(self.pairs) if kept is None else kept
        found = np.empty(len(q))
        for first in range(0, len(q), _CHUNK):
            part = slice(first, first + _CHUNK)
            found[part] = self._nearest(q[part], cutting[part], most, asked, off)
        return found

    def _nearest(
        self,
        q: Array,
        cutting: npt.NDArray[np.bool_],
        most: float,
        asked: npt.NDArray[np.bool_],
        off: Array,
    ) -> Array:
        count = len(self.own)
        own, poses = self.near(q)
        least = np.full((len(q), self.pairs), np.inf)
        least[:, :count] = own
        if asked[count:].any():
            least[:, count:] = self.rough(poses)
        least -= off
        least[(cutting[:, None] & self.cutting) | ~asked] = np.inf
        measured = np.array(self.measured, dtype=np.int64)
        known = np.delete(least, measured, axis=1)
        best: Array = np.minimum(known.min(axis=1, initial=np.inf), most)
        # the nearest looking pairs first: they spare the others a closer look
        for number in measured[np.argsort(least[:, measured].min(axis=0))]:
            close = np.flatnonzero((least[:, number] < best) & (best > 0))
            if len(close):
                exact = self.distance(number, poses[close]) - off[number]
                best[close] = np.minimum(best[close], exact)
        return best

    def tightest(self, q: Array, cutting: bool) -> tuple[tuple[str, str], float, float]:
        """The two bodies with the least room at q (n,), their distance and what is kept between
        them [m]; `cutting` as in `clearance`."""
        own, poses = self.near(q[None])
        distance = np.concatenate([own[0], np.full(len(self.outer), np.inf)])
        for number in self.measured:
            distance[number] = self.distance(number, poses)[0]
        distance[self.cutting & cutting] = np.inf
        pair = int(np.argmin(distance - self.kept))
        return self.names(pair), float(distance[pair]), float(self.kept[pair])

    @cached_property
    def _chain(self) -> tuple[Array, Array]:
        chain = chain_of(self.model.robot)
        n = self.model.robot.n
        seen = np.array([rates(chain, i) for i in range(n + 1)])
        rho = [reach(chain, self.arm[i].link, self.arm[j]) for i, j in self.own]
        rho += [reach(chain, 0, self.arm[i]) for i, _ in self.outer]
        return seen, np.array(rho).reshape(-1, n)

    @cached_property
    def _reference(self) -> Integers:
        links = [self.arm[i].link for i, _ in self.own] + [0] * len(self.outer)
        return np.array(links, dtype=np.int64)

    def speed(self, rate: Array) -> Array:
        """Upper bound of the speed of one body of each pair in the eyes of the other, shape (m,
        pairs) [m per unit of s].

        Args:
            rate: Bernstein coefficients of dq/ds on m cells, shape (m, d, n) [rad per unit of s];
                those of the further axes follow.
        """
        seen, rho = self._chain
        n = self.model.robot.n
        turned = np.abs(rate[:, :, n:]).max(axis=1)
        rate = rate[:, :, :n]
        found = np.empty((len(rate), self.pairs))
        for i in np.unique(self._reference):
            at = self._reference == i
            turning = np.abs(rate @ seen[i].T).max(axis=1)
            found[:, at] = turning @ rho[at].T
        return found if self.external is None else found + turned @ self._levers.T

    @cached_property
    def _levers(self) -> Array:
        """How far the arm's body of each pair can be from the axes that carry what it is compared
        with, or the arm, shape (pairs, k) [m]; 1 of a rail."""
        assert self.external is not None
        steps = [np.linalg.norm(link.frame.matrix()[:3, 3]) for link in self.model.robot.links]
        found = np.zeros((self.pairs, len(self.external)))
        for number, (i, k) in enumerate(self.outer, start=len(self.own)):
            if self.things[k].on_work_object:
                ends, radius = self.arm[i].capsule()
                far = float(np.linalg.norm(ends, axis=1).max()) + radius
                reach = float(np.sum(steps[: self.arm[i].link])) + far
                found[number] = self.external.levers(reach)
            found[number, : self.external.slides] = 1.0
        return found


def _seen(M: Array, poses: Array) -> Array:
    """Poses (m, b, 3, 4) as seen from what has been moved by M (m, 4, 4)."""
    R = M[:, None, :3, :3].transpose(0, 1, 3, 2)
    found = R @ poses
    found[:, :, :, 3] -= (R @ M[:, None, :3, 3:])[:, :, :, 0]
    return np.asarray(found)
