"""The tool centre point along a joint path: position, tool axis and speed, bounded between the
samples.

Every joint turns some links about an axis, so a partial derivative of the TCP's position, of
whatever order, is at most as long as the links that its outermost joint turns (`levers`), and one
of a direction at most 1. With q(s) cubic that bounds the third derivative along the path, and a
parabola through three values misses at most

    |f - p| <= sqrt(3) / 216 h^3 max |f'''|.

Where further axes carry the part, everything is said as the part sees it: these axes, the last one
first, come before the arm's joints in the chain. A rail under the arm comes last of them, with the
place e(s) along a direction d that only axes before it turn, R: what e adds to a derivative of
R d e beyond that of a point that stands (whose levers count the rail's length) is

    (R d e)''':    |e'''| + 3 |R'| |e''| + 3 |R''| |e'|.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath

_MISS = np.sqrt(3) / 216
_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(8)
# a joint turns no further than this within one formula of quadrature [rad]
_TURN = 0.2


_Rates = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Enclosed:
    """Parabolas on m cells as Bernstein coefficients, shape (m, 3, 3), and how far the truth is
    from them, (m,)."""

    points: Array
    miss: Array

    @property
    def size(self) -> Array:
        """Upper bound of the length of the vector in each cell: it stays within the hull of the
        coefficients, (m,)."""
        return np.asarray(np.linalg.norm(self.points, axis=2).max(axis=1) + self.miss)


@dataclass(frozen=True, eq=False)
class TcpPath:
    """The TCP of one arm along one joint path, in the base or, where the part is carried, in the
    eyes of the part."""

    model: Model
    joints: JointPath
    spindle: Array
    """tool direction in the TCP frame, out of the spindle, shape (3,)"""
    carried: ExternalAxes | None = None
    """what carries the part; its columns follow those of the arm"""

    def pose(self, s: Array, piece: npt.NDArray[np.int64] | None = None) -> tuple[Array, Array]:
        """Position [m] and tool axis (towards the spindle) at the lengths s, each (k, 3)."""
        at = self.joints(s) if piece is None else self.joints.on_piece(s, piece)
        n = self.model.robot.n
        found = _pose(self.model).map(at[:, :n])[0]
        R = found[:, 3:].reshape(-1, 3, 3).transpose(0, 2, 1)
        if self.carried is None:
            return found[:, :3], -(R @ self.spindle)
        X = np.zeros((len(found), 4, 4))
        X[:, :3, 3] = found[:, :3]
        X[:, :3, :3] = R
        X = self.carried.seen(at[:, n:], X)
        return X[:, :3, 3], -(X[:, :3, :3] @ self.spindle)

    def velocity(self, s: Array, piece: npt.NDArray[np.int64]) -> Array:
        """dp/ds, shape (k, 3) [m/m]."""
        n = self.model.robot.n
        q = self.joints.on_piece(s, piece)
        dq = self.joints.on_piece(s, piece, 1)
        found = _velocity(self.model).map(q[:, :n], dq[:, :n])[0]
        if self.carried is None:
            return found
        place = _pose(self.model).map(q[:, :n])[0][:, :3]
        return self.carried.velocity_seen(q[:, n:], dq[:, n:], place, found)

    def enclosed(self, ends: Array) -> tuple[Enclosed, Enclosed]:
        """Position and tool axis on cells that start and end at `ends` (2, m), each inside one
        piece of the path."""
        at, pieces = _three(self.joints, ends)
        p, axis = self.pose(at, pieces)
        miss = self.missed(ends)
        return Enclosed(_parabolas(p), miss[0]), Enclosed(_parabolas(axis), miss[1])

    def missed(self, ends: Array) -> tuple[Array, Array]:
        """How far position [m] and tool axis are from the parabolas of `enclosed`, each (m,)."""
        blocks = bernstein.blocks(ends.shape[1])
        position, axis = zip(*(self._missed(ends[:, block]) for block in blocks), strict=True)
        return np.concatenate(position), np.concatenate(axis)

    def _missed(self, ends: Array) -> tuple[Array, Array]:
        """The same on so many cells at once."""
        turning, slid = self._rates(ends)
        a, b, c = (_inner(rate) for rate in turning)
        # three derivatives of the position; partial ones of a direction are at most 1
        bend = a**3 + 3 * a * b + c
        scale = _MISS * (ends[1] - ends[0]) ** 3
        along = np.zeros(len(scale))
        if slid is not None:
            first, second = self._before(a, b)[:2]
            along = slid[2] + 3 * first * slid[1] + 3 * second * slid[0]
        return scale * (_outermost(bend, self._levers) + along), scale * bend[:, -1]

    def enclosed_velocity(self, s: Array) -> Enclosed:
        """dp/ds on the cells between the lengths s (m + 1,), knots of the path included."""
        parts = list(self._moving_parts(s))
        points = np.concatenate([part.points for part in parts])
        return Enclosed(points, np.concatenate([part.miss for part in parts]))

    def largest_velocity(self, s: Array) -> Array:
        """Upper bound of |dp/ds| in each of those cells, (m,) [m/m]."""
        return np.concatenate([part.size for part in self._moving_parts(s)])

    def _moving_parts(self, s: Array) -> Iterator[Enclosed]:
        for first in range(0, len(s) - 1, bernstein.AT_ONCE):
            yield self._moving(s[first : first + bernstein.AT_ONCE + 1])

    def _moving(self, s: Array) -> Enclosed:
        """The same on so many cells at once."""
        ends = np.stack([s[:-1], s[1:]])
        at, pieces = _three(self.joints, ends)
        turning, slid = self._rates(ends)
        a, b, c = (_inner(rate) for rate in turning)
        # four derivatives of the position; q'''' = 0
        square = a * a
        bend = _outermost(square * (square + 6 * b) + 4 * a * c + 3 * b * b, self._levers)
        if slid is not None:
            first, second, third = self._before(a, b, c)
            bend = bend + 4 * first * slid[2] + 6 * second * slid[1] + 4 * third * slid[0]
        return Enclosed(_parabolas(self.velocity(at, pieces)), _MISS * np.diff(s) ** 3 * bend)

    def way(self, s: Array | float) -> Array:
        """Length of the TCP's way up to the lengths s along the path, which count the tool's
        turning, too [m]."""
        return np.asarray(np.interp(s, self.joints.knots, self.lengths))

    @cached_property
    def lengths(self) -> Array:
        """Length of the TCP's way from the start to the knots of the joint path, shape (m + 1,)
        [m]."""
        knots = self.joints.knots
        ends = np.stack([knots[:-1], knots[1:]])
        turned = self._rates(ends)[0][0].max(axis=1) * np.diff(knots)
        parts = np.maximum(1, np.ceil(turned / _TURN)).astype(int)
        piece = np.repeat(np.arange(len(parts)), parts)
        h = np.repeat(np.diff(knots) / parts, parts)
        start = divided(knots, parts)[:-1]
        at = (start[:, None] + h[:, None] * (1 + _GAUSS) / 2).ravel()
        rate = self.velocity(at, np.repeat(piece, len(_GAUSS)))
        way = np.linalg.norm(rate, axis=1).reshape(len(h), -1) @ (_WEIGHT / 2) * h
        return np.concatenate([[0.0], np.cumsum(np.bincount(piece, way))])

    def _rates(self, ends: Array) -> tuple[_Rates, _Rates | None]:
        """Bounds of the first three derivatives in the cells, without their signs: of the axes that
        turn, each (m, n), in the order of the chain; and of a rail, each (m,), or None."""
        first, last = ends
        piece = self.joints.piece((first + last) / 2)
        d0 = self.joints.on_piece(first, piece, 1)
        dd0 = self.joints.on_piece(first, piece, 2)
        d1 = self.joints.on_piece(last, piece, 1)
        dd1 = self.joints.on_piece(last, piece, 2)
        speed = bernstein.leaving(d0, dd0 * (last - first)[:, None], d1)
        found = (
            bernstein.largest_size(speed),
            np.maximum(np.abs(dd0), np.abs(dd1)),
            np.abs(self.joints.on_piece(first, piece, 3)),
        )
        if self.carried is None:
            return found, None
        n = self.model.robot.n
        slides = self.carried.slides
        # from the part: its last axis first, then the arm from its base on
        order = [*range(n + len(self.carried) - 1, n + slides - 1, -1), *range(n)]
        turning = (found[0][:, order], found[1][:, order], found[2][:, order])
        return turning, (found[0][:, n], found[1][:, n], found[2][:, n]) if slides else None

    def _before(self, a: Array, b: Array, c: Array | None = None) -> _Rates:
        """Bounds of the first three derivatives of a direction that the axes between part and rail
        turn, each (m,), from the sums of their rates."""
        assert self.carried is not None
        count = len(self.carried) - 1
        if not count:
            nothing = np.zeros(len(a))
            return nothing, nothing, nothing
        first = a[:, count - 1]
        second = b[:, count - 1]
        third = 0 * first if c is None else c[:, count - 1]
        return first, first**2 + second, first**3 + 3 * first * second + third

    @cached_property
    def _levers(self) -> Array:
        own = levers(self.model)
        if self.carried is None:
            return own
        lever = self.carried.levers(reach(self.model))[self.carried.slides :]
        return np.append(lever[::-1], own)


@lru_cache(maxsize=8)
def _pose(model: Model) -> CompiledFunction:
    """q -> position and orientation of the TCP."""
    q = ca.SX.sym("q", model.robot.n)
    X = model.tcp_pose(q)
    return compile_function(ca.Function("tcp_pose", [q], [ca.vertcat(X[:3, 3], ca.vec(X[:3, :3]))]))


@lru_cache(maxsize=8)
def _velocity(model: Model) -> CompiledFunction:
    """q, q' -> velocity of the TCP."""
    q = ca.SX.sym("q", model.robot.n)
    dq = ca.SX.sym("dq", model.robot.n)
    return compile_function(
        ca.Function("tcp_velocity", [q, dq], [model.tcp_jacobian(q)[:3, :] @ dq])
    )


def levers(model: Model) -> Array:
    """Length of the links that each joint turns, the joints before it standing or not, shape (n,)
    [m].

    Raises:
        InputError: a coupling other than that of the parallelogram.
    """
    g = model.arm_geometry
    if not g.exact:
        return _levers_of_chain(model)
    flange = float(np.linalg.norm(g.X_6F[:3, 3]))
    tool = flange + float(np.linalg.norm(model.robot.X_FT[:3, 3]))
    last = tool + (0.0 if g.spherical else float(np.hypot(g.d4, g.e4)))
    fore = g.forearm + last
    # q3 is absolute in a parallelogram: axis 2 alone turns the upper arm only
    upper = g.a2 if _parallelogram(model) else g.a2 + fore
    whole = abs(g.a1) + g.a2 + abs(g.b) + fore
    return np.array([whole, upper, fore, last, tool, tool])


def reach(model: Model) -> float:
    """How far the TCP can be from the origin of the base: the sum of all links [m]."""
    return float(_frame_lengths(model).sum())


def _frame_lengths(model: Model) -> Array:
    """Lengths from frame to frame up to the TCP [m], shape (n + 2,)."""
    robot = model.robot
    frames = [*(link.frame.matrix() for link in robot.links), robot.flange.matrix(), robot.X_FT]
    return np.array([np.linalg.norm(X[:3, 3]) for X in frames])


def _parallelogram(model: Model) -> bool:
    """Whether theta3 = q3 - q2; InputError for a coupling that is neither this nor none."""
    parallelogram = np.eye(6)
    parallelogram[2, 1] = -1.0
    if np.array_equal(model.robot.A, parallelogram):
        return True
    if np.array_equal(model.robot.A, np.eye(6)):
        return False
    raise InputError(
        f"{model.robot.name}: planning knows serial arms and the parallelogram theta3 = q3 - q2, "
        "not this coupling"
    )


def _levers_of_chain(model: Model) -> Array:
    """`levers` of an arm that is only near its family: every length that lies beyond the joint.

    Axis 2 of a parallelogram whose axes 2 and 3 are not quite parallel also turns the forearm, at
    |z2 - z3| = epsilon; all further derivatives of that turn are below 2 epsilon (it is small).
    """
    robot = model.robot
    lengths = _frame_lengths(model)
    beyond = np.array([lengths[i + 1 :].sum() for i in range(robot.n)])
    if _parallelogram(model):
        axis = robot.links[2].frame.matrix()[:3, 2]
        epsilon = float(np.linalg.norm(axis - np.eye(3)[2]))
        beyond[1] = lengths[2] + 2.0 * epsilon * beyond[2]
    return beyond


def _inner(rate: Array) -> Array:
    """Sums over the first 1, 2, ... joints, shape (m, n)."""
    return np.asarray(rate @ np.triu(np.ones((rate.shape[1], rate.shape[1]))))


def _outermost(together: Array, lever: Array) -> Array:
    """Sum over joints i, j, ... of lever[max(i, j, ...)] rate_i rate_j ..., shape (m,), from the
    same sum over the first 1, 2, ... joints alone with every lever 1, shape (m, n)."""
    return np.asarray(together @ (lever - np.append(lever[1:], 0.0)))


def _three(joints: JointPath, ends: Array) -> tuple[Array, npt.NDArray[np.int64]]:
    """Start, middle and end of all cells, and the polynomial piece of each."""
    middle = (ends[0] + ends[1]) / 2
    piece = joints.piece(middle)
    return np.concatenate([ends[0], middle, ends[1]]), np.concatenate([piece, piece, piece])


def _parabolas(values: Array) -> Array:
    """Through the values of vectors at the places of `_three`, shape (m, 3, 3)."""
    return bernstein.through(*values.reshape(3, -1, 3))
