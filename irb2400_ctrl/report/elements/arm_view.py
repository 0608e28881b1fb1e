"""The arm of a report, to turn and to play: its bodies, where they are over time, the tool's way.

The browser only interpolates poses; they come from the model's own kinematics.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.cell.description import CellTool
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.cell.mesh import Surface
from irb2400_ctrl.cell.piece import FLOOR, Piece, arm_pieces, cell_pieces, tool_offset
from irb2400_ctrl.model.kinematics import link_poses
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.outline import SPINDLE, TOOL
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Hull, Sphere

MOST_FRAMES = 600
"""poses that are sent; the browser interpolates between them"""
MOST_TRIANGLES = 20_000
"""of a mesh; a larger one is shown by its box"""
STICK_MM = 45.0
"""radius of the links where the robot file does not say what space they take up"""


@dataclass(frozen=True)
class Colouring:
    """What the tool's way is coloured by.

    Args:
        name: for the reader.
        unit: as text, such as mm/s; "" for none.
        values: at the times of the view, shape (m,).
        digits: after the point.
        high: end of the colours, where it is to be the same as that of another one.
    """

    name: str
    unit: str
    values: Array
    digits: int = 0
    high: float | None = None


@dataclass(frozen=True)
class ArmView:
    """A motion to look at.

    Args:
        robot: the arm, with the TCP of its file.
        time: [s], shape (m,).
        q: angles [rad], shape (m, n).
        colourings: the first is shown first.
        cell: what stands around the arm.
        tool: of the cell, in the spindle.
        reference: another way of the TCP, drawn thin, shape (k, 3) [m].
        external: places of the axes of the cell that carry the part or the arm, where these move
            [rad, m of a rail], shape (m, k).
    """

    robot: Robot
    time: Array
    q: Array
    colourings: tuple[Colouring, ...] = ()
    cell: Cell | None = None
    tool: CellTool | None = None
    reference: Array | None = None
    external: Array | None = None

    def data(self) -> dict[str, Any]:
        """All that the browser needs, as JSON's own types; arrays are float32 in base64."""
        count = min(MOST_FRAMES, max(2, len(self.time)))
        time = np.linspace(self.time[0], self.time[-1], count)
        poses = _poses(self.robot, self._at(time, self.q))
        X_nT = self.robot.flange.matrix() @ self.robot.X_FT
        if self.tool is not None:
            X_nT = X_nT @ tool_offset(self.tool)
        poses = np.concatenate([self._on_floor(time, poses), self._carried(time)], axis=1)
        # an arm that hangs is shown hanging
        poses = self.robot.upright @ poses
        last = poses[:, self.robot.n]
        way = last[:, :, :3] @ X_nT[:3, 3] + last[:, :, 3]
        reference = None if self.reference is None else self.reference @ self.robot.upright.T
        return {
            "start": float(time[0]),
            "stop": float(time[-1]),
            "bodies": [_body(piece, self._frame(piece)) for piece in self._pieces()],
            "frames": _packed(_quaternions(poses)),
            "links": poses.shape[1],
            "flange": self.robot.n,
            "tcp": [float(v) for v in X_nT[:3, 3]],
            "way": _packed(way),
            "reference": None if reference is None else _packed(_thin(reference)),
            "floor": self._floor(),
            "fields": [self._field(one, time) for one in self.colourings],
        }

    def _at(self, time: Array, values: Array) -> Array:
        """The columns at other times."""
        return np.stack([np.interp(time, self.time, column) for column in values.T], axis=1)

    def _on_floor(self, time: Array, poses: Array) -> Array:
        """Poses (m, b, 3, 4) of an arm whose carriage moves, as the floor sees them."""
        if self._axes is None or self.external is None or not self._axes.slides:
            return poses
        found = poses.copy()
        place = self._at(time, self.external)[:, :1]
        found[:, :, :, 3] -= (place * self._axes.direction[0])[:, None]
        return found

    def _carried(self, time: Array) -> Array:
        """What the axes of the cell do to the part, shape (frames, 1, 3, 4); no pose (0) where it
        stands."""
        if self._axes is None or self.external is None or not len(self._axes.turning):
            return np.empty((len(time), 0, 3, 4))
        angles = self._at(time, self.external)[:, self._axes.slides :]
        return self._axes.turning.turned(angles)[:, None, :3]

    @property
    def _axes(self) -> ExternalAxes | None:
        """What carries part or arm, where it is known all over the motion."""
        return None if self.cell is None or self.external is None else self.cell.external_axes

    def _frame(self, piece: Piece) -> int:
        """Number of the pose that a body moves with."""
        moves = piece.on_work_object and self._axes is not None and len(self._axes.turning)
        return self.robot.n + 1 if moves else piece.link

    def _pieces(self) -> list[Piece]:
        arm = arm_pieces(self.robot, self.tool) or _sticks(self.robot)
        things = [] if self.cell is None else cell_pieces(self.cell)
        return [*arm, *(thing for thing in things if thing.name != FLOOR)]

    def _floor(self) -> float:
        """Height of the grid [m]."""
        known = None if self.cell is None else self.cell.floor_mm
        return 0.0 if known is None else known / 1e3

    def _field(self, one: Colouring, time: Array) -> dict[str, Any]:
        # the ends are those of the motion: between two poses that are sent there may be more
        whole = np.nan_to_num(one.values)
        return {
            "name": one.name,
            "unit": one.unit,
            "digits": one.digits,
            "low": float(whole.min()) if one.high is None else 0.0,
            "high": float(whole.max()) if one.high is None else one.high,
            "values": _packed(np.interp(time, self.time, whole)),
        }


def _poses(robot: Robot, q: Array) -> Array:
    """Of base and links at q (m, n), shape (m, n + 1, 3, 4)."""
    angles = ca.SX.sym("q", robot.n)
    poses = [ca.SX.eye(4), *link_poses(robot, angles)]
    rows = ca.vertcat(*(ca.vec(X[:3, :].T) for X in poses))
    found = np.asarray(ca.Function("poses", [angles], [rows])(q.T))
    return np.ascontiguousarray(found.T).reshape(len(q), robot.n + 1, 3, 4)


def _quaternions(poses: Array) -> Array:
    """Place [m] and quaternion x, y, z, w, shape (m, n + 1, 7); neighbours on one side."""
    m, bodies = poses.shape[:2]
    flat = Rotation.from_matrix(poses[..., :3].reshape(-1, 3, 3)).as_quat()
    turns = flat.reshape(m, bodies, 4)
    flips = np.sign((turns[1:] * turns[:-1]).sum(axis=2))
    turns[1:] *= np.cumprod(np.where(flips < 0, -1.0, 1.0), axis=0)[..., None]
    return np.concatenate([poses[..., 3], turns], axis=2)


def _sticks(robot: Robot) -> list[Piece]:
    """Links as straight lines between the joints, for a robot file without an outline."""
    poses = _poses(robot, np.zeros((1, robot.n)))[0]
    tip = (robot.flange.matrix() @ robot.X_FT)[:3, 3]
    found = []
    for i, X in enumerate(poses):
        after = tip if i == robot.n else X[:, :3].T @ (poses[i + 1][:, 3] - X[:, 3])
        x, y, z = (1e3 * float(v) for v in after)
        shape: Capsule | Sphere
        if np.linalg.norm(after) < 1e-3:
            shape = Sphere(kind="sphere", radius_mm=1.2 * STICK_MM)
        else:
            radius = STICK_MM if i < robot.n else STICK_MM / 2
            shape = Capsule(
                kind="capsule", from_mm=(0.0, 0.0, 0.0), to_mm=(x, y, z), radius_mm=radius
            )
        found.append(Piece(f"link {i}", i, np.eye(4), shape, "base" if i == 0 else f"link_{i}"))
    return found


def _body(piece: Piece, frame: int) -> dict[str, Any]:
    """Shape, place on what it moves with, and look."""
    X = piece.pose()
    turn = Rotation.from_matrix(X[:3, :3]).as_quat()
    place = [float(v) for v in (*X[:3, 3], *turn)]
    return {"link": frame, "place": place, "look": _look(piece), **_form(piece)}


def _look(piece: Piece) -> str:
    if piece.body in {SPINDLE, TOOL}:
        return "tool"
    if piece.body:
        return "base" if piece.link == 0 else "arm"
    return "part" if piece.may_be_cut else "thing"


def _form(piece: Piece) -> dict[str, Any]:
    """The shape in its own frame, axis of symmetry z [m]."""
    shape = piece.shape
    if isinstance(shape, Sphere):
        return {"kind": "capsule", "radius": shape.radius, "length": 0.0}
    if isinstance(shape, Capsule | Cylinder):
        return {"kind": shape.kind, "radius": shape.radius, "length": shape.length}
    if isinstance(shape, Surface) and len(shape.triangles) <= MOST_TRIANGLES:
        corners = shape.points[shape.triangles].reshape(-1, 3)
        return {"kind": "mesh", "corners": _packed(corners)}
    if isinstance(shape, Hull):
        return {"kind": "mesh", "corners": _packed(shape.triangles.reshape(-1, 3))}
    size = shape.size if isinstance(shape, Box) else 2 * piece.half_size()
    return {"kind": "box", "size": [float(v) for v in size]}


def _thin(points: Array) -> Array:
    """At most as many points as there are frames."""
    keep = np.linspace(0, len(points) - 1, min(len(points), MOST_FRAMES)).round().astype(int)
    return np.asarray(points[keep])


def _packed(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()
