"""`Piece`: one convex shape or mesh on a link of the arm, or on something that stands still."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.description import Cell, CellTool, Thing
from irb2400_ctrl.cell.mesh import Surface, read_mesh
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Body, Robot, Tool, Transform
from irb2400_ctrl.robot.outline import BASE, SPINDLE, TOOL
from irb2400_ctrl.robot.shape import Box, Hull, Solid
from irb2400_ctrl.typed import typed

FLOOR = "floor"
# the floor is a slab of this size [mm]: wide enough for any arm, and so thick that one which is
# stated above an arm (that hangs) has the whole arm within
_FLOOR_MM = (40_000.0, 40_000.0, 40_000.0)
# a thing of solid shapes that is no larger was stated in metres [m]
_SPECK = 0.005
# and so was a tool; it may be smaller, as a ball stands for a beam of light [m]
_SPECK_OF_TOOL = 0.001


@dataclass(frozen=True, eq=False)
class Piece:
    """A shape with its place and its rights."""

    name: str
    """for messages: of a link, of the tool, of a thing of the cell"""
    link: int
    """0 for what stands still, 1…n for what moves with a link"""
    X: Array
    """pose of the frame that the shape is stated in, in the frame of the link, shape (4, 4)"""
    shape: Solid | Surface
    body: str = ""
    """its name in the outline of the robot file; empty for things of the cell"""
    cuts: bool = False
    """of a tool: it may touch what may be cut, at feed"""
    may_be_cut: bool = False
    on_work_object: bool = False
    """whether X is the pose of the work object"""

    def capsule(self) -> tuple[Array, float]:
        """Both ends (2, 3) in the frame of the link and the radius of a capsule around it [m]."""
        ends, radius = self.shape.capsule()
        return ends @ self.X[:3, :3].T + self.X[:3, 3], radius

    @property
    def is_capsule(self) -> bool:
        """Whether `capsule` is the shape itself."""
        return isinstance(self.shape, Solid) and self.shape.is_capsule

    def pose(self) -> Array:
        """Pose of the shape's own frame in the frame of the link, shape (4, 4)."""
        return np.asarray(self.X @ self.shape.place())

    def half_size(self) -> Array:
        """Half the edges of a box around it, along the axes of its own frame [m], shape (3,)."""
        if isinstance(self.shape, Surface):
            return self.shape.half_size
        if isinstance(self.shape, Box):
            return np.asarray(self.shape.size / 2)
        if isinstance(self.shape, Hull):
            return np.asarray(np.abs(self.shape.points).max(axis=0))
        ends, radius = self.shape.capsule()
        half = np.full(3, radius)
        half[2] += np.linalg.norm(ends[1] - ends[0]) / 2
        return half


def arm_pieces(robot: Robot, tool: CellTool | None = None) -> list[Piece]:
    """The shapes of the robot file, with another tool in the spindle if one is given.

    Args:
        robot: the arm as its file describes it, with its own TCP.
        tool: what the spindle holds instead.

    Raises:
        InputError: the tool is a speck.
    """
    if robot.outline is None:
        return []
    number = {link.name: i + 1 for i, link in enumerate(robot.links)}
    X_6T = robot.flange.matrix() @ robot.X_FT
    held = "tool" if robot.tool is None else robot.tool.name
    found = []
    for part in robot.outline.parts:
        if part.on in {SPINDLE, TOOL}:
            if part.on == TOOL and tool is not None:
                continue
            name = held if part.on == SPINDLE else f"tool of the {held}"
            found.append(Piece(name, robot.n, X_6T, part.shape, part.on, part.shape.cuts))
        else:
            link = 0 if part.on == BASE else number[part.on]
            found.append(Piece(part.on, link, np.eye(4), part.shape, part.on))
    if tool is not None:
        _no_speck(f"tool {tool.name}", tool.shapes, _SPECK_OF_TOOL)
        X = X_6T @ tool_offset(tool)
        found += [Piece(tool.name, robot.n, X, shape, TOOL, shape.cuts) for shape in tool.shapes]
    return found


@typed
def with_tool(robot: Robot, tool: CellTool) -> Robot:
    """The arm with the TCP at the tip of a tool of the cell; its mass data are those of the robot
    file, and an arm that holds nothing there carries no mass.

    Args:
        robot: the arm; without a tool the offset starts from its flange.
        tool: of the cell.
    """
    tcp = Transform.model_validate({"transform": (robot.X_FT @ tool_offset(tool)).tolist()})
    held = robot.tool
    if held is None:
        nothing = Body(mass_kg=0.0, com_m=(0.0,) * 3, inertia_kgm2=(0.0,) * 6)
        held = Tool(name=tool.name, tcp=tcp, body=nothing, source="the cell: without its mass")
    return robot.model_copy(update={"tool": held.model_copy(update={"tcp": tcp})})


def tool_offset(tool: CellTool) -> Array:
    """Pose of its TCP in that of the robot file, shape (4, 4)."""
    X = np.eye(4)
    X[:3, 3] = np.array(tool.offset_mm) / 1e3
    return X


def cell_pieces(cell: Cell, robot: Robot | None = None) -> list[Piece]:
    """The shapes of a cell; reads the files of its meshes.

    The floor lies across gravity: above the base of an arm that hangs, as its base frame has it.

    Args:
        cell: what stands around the arm.
        robot: whose gravity says where the floor is; default straight down.

    Raises:
        InputError: a mesh cannot be read; a thing is a speck, cuts, or is called as the floor.
    """
    if cell.floor_mm is not None and any(thing.name == FLOOR for thing in cell.things):
        raise InputError(
            f"cell {cell.name}: found a thing called {FLOOR!r}, as the floor at floor_mm is; "
            "expected another name, or no floor_mm"
        )
    found = []
    for thing in cell.things:
        X = cell.work_frame if thing.frame == "work_object" else cell.seen
        assert X is not None
        for shape in _shapes(cell, thing):
            moves = thing.frame == "work_object"
            found.append(
                Piece(
                    thing.name,
                    0,
                    X,
                    shape,
                    may_be_cut=thing.may_be_cut,
                    on_work_object=moves,
                )
            )
    if cell.floor_mm is not None:
        centre = (0.0, 0.0, cell.floor_mm - _FLOOR_MM[2] / 2)
        slab = Box(kind="box", centre_mm=centre, size_mm=_FLOOR_MM)
        X = np.eye(4)
        if robot is not None:
            X[:3, :3] = robot.upright.T
        found.append(Piece(FLOOR, 0, X, slab))
    return found


def no_namesakes(arm: Sequence[Piece], things: Sequence[Piece]) -> None:
    """Refuses a thing whose name in a message would be that of a body of the arm.

    Raises:
        InputError: there is one.
    """
    both = sorted({piece.name for piece in things} & {piece.name for piece in arm})
    if both:
        raise InputError(
            f"the cell has a thing called {both[0]!r}, as a body of the arm or its tool is; "
            "expected another name, so that messages say which of the two they mean"
        )


def open_meshes(pieces: Sequence[Piece]) -> str | None:
    """What to ask of meshes that have no inside, in which a body that slips through a gap is free;
    None where there are none.

    Args:
        pieces: of a cell.
    """
    of_mesh = (piece for piece in pieces if isinstance(piece.shape, Surface))
    gaps = dict.fromkeys(p.name for p in of_mesh if not p.shape.closed)  # type: ignore[union-attr]
    if not gaps:
        return None
    return (
        f"the triangles of {', '.join(gaps)} do not close, or are turned both ways: they alone may "
        "not be touched, what lies behind them counts as air; export a closed solid, unless it is "
        "a sheet"
    )


def _shapes(cell: Cell, thing: Thing) -> list[Solid | Surface]:
    solids = [s for s in thing.shapes if isinstance(s, Solid)]
    if len(solids) == len(thing.shapes):
        _no_speck(f"cell {cell.name}, {thing.name}", solids, _SPECK)
    if not thing.may_be_cut and any(solid.cuts for solid in solids):
        raise InputError(
            f"cell {cell.name}, {thing.name}: found cuts = true, which belongs to the shapes of a "
            f'tool; what may be cut has the role "part" or "stock", and this is "{thing.role}"'
        )
    return [s if isinstance(s, Solid) else read_mesh(s, cell.folder) for s in thing.shapes]


def _no_speck(name: str, solids: Sequence[Solid], least: float) -> None:
    """Refuses what is smaller than `least` [m] as a whole."""
    size = float(np.ptp(np.concatenate([s.corners() for s in solids]), axis=0).max())
    if size < least:
        raise InputError(
            f"{name}: found a thing of {1e3 * size:.3g} mm, expected {1e3 * least:g} mm or more; "
            "are its numbers metres? State them in mm"
        )
