"""`Room`: whether what is moved to another place would stand in what stays where it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.mesh import Surface
from irb2400_ctrl.cell.narrow import Narrow
from irb2400_ctrl.cell.piece import Piece
from irb2400_ctrl.cell.scene import Scene
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Solid, Sphere

# so deep may things stand in each other: what rests on a table is not in it [mm]
_DEPTH = 1.0


class Room:
    """Pairs of what is moved and what stays; those that overlap at the start are as the user has
    placed them, and are not looked at."""

    def __init__(self, moved: Sequence[Piece], still: Sequence[Piece]) -> None:
        made: dict[Any, Any] = {}
        pairs = [_Pair.of(_trimmed(p), other, made) for p in moved for other in still]
        at_start = [pair.overlaps(np.eye(4)) for pair in pairs]
        self._pairs = [pair for pair, is_in in zip(pairs, at_start, strict=True) if not is_in]
        told = (f"{p.moved.name} in {p.still.name}" for p in pairs if p not in self._pairs)
        self.overlapping = tuple(dict.fromkeys(told))
        """what stands in what at the start"""

    @classmethod
    def of_part(cls, scene: Scene | None) -> Room:
        """For what stands on the work object, among the rest of the cell and the arm's base; none
        where the robot file says nothing of the space of its arm."""
        if scene is None:
            return cls((), ())
        foot = [piece for piece in scene.arm if piece.link == 0]
        moved = [piece for piece in scene.things if piece.on_work_object]
        return cls(moved, [p for p in scene.things if not p.on_work_object] + foot)

    @classmethod
    def of_cell(cls, scene: Scene | None) -> Room:
        """For all of a cell, as an arm on a carriage sees it pass its base."""
        if scene is None:
            return cls((), ())
        return cls(scene.things, [piece for piece in scene.arm if piece.link == 0])

    def taken(self, M: Array) -> str:
        """What would stand in what after a move by M (4, 4); empty where nothing does."""
        return next(
            (f"{p.moved.name} would stand in {p.still.name}" for p in self._pairs if p.overlaps(M)),
            "",
        )


@dataclass(frozen=True, eq=False)
class _Pair:
    moved: Piece
    still: Piece
    to_still: Narrow | None
    """the moved one as it comes to the other; None where only the way back sees all"""
    to_moved: Narrow | None
    """the way back: a mesh knows what is within it only where it is the one that stands still"""

    @classmethod
    def of(cls, moved: Piece, still: Piece, made: dict[Any, Any]) -> _Pair:
        mesh = isinstance(moved.shape, Surface)
        there = isinstance(still.shape, Surface) or not mesh
        return cls(
            moved,
            still,
            Narrow.of(moved, still, made) if there else None,
            Narrow.of(still, moved, made) if mesh else None,
        )

    def overlaps(self, M: Array) -> bool:
        """Whether they do after a move of the first by M (4, 4)."""
        there = M @ self.moved.pose()
        back = np.linalg.inv(M) @ self.still.pose()
        ways = ((self.to_still, there), (self.to_moved, back))
        return any(n is not None and n.distance(X[:3, :3], X[:3, 3]) <= 0 for n, X in ways)


def _trimmed(piece: Piece) -> Piece:
    """The same without its outermost millimetre, but never less than half of it."""
    return replace(piece, shape=_smaller(piece.shape))


def _smaller(shape: Solid | Surface) -> Solid | Surface:
    if isinstance(shape, Surface):
        half = 1e3 * np.maximum(shape.half_size, 1e-9)
        return replace(shape, points=shape.points * np.maximum(1 - _DEPTH / half, 0.5))
    if isinstance(shape, Box):
        edges = tuple(max(edge - 2 * _DEPTH, edge / 2) for edge in shape.size_mm)
        return shape.model_copy(update={"size_mm": edges})
    assert isinstance(shape, Capsule | Cylinder | Sphere)
    thin: dict[str, Any] = {"radius_mm": max(1e3 * shape.radius - _DEPTH, 500 * shape.radius)}
    if isinstance(shape, Cylinder):
        ends = np.array([shape.from_mm, shape.to_mm])
        cut = min(_DEPTH / (1e3 * shape.length), 0.25) * (ends[1] - ends[0])
        thin |= {"from_mm": tuple(ends[0] + cut), "to_mm": tuple(ends[1] - cut)}
    return shape.model_copy(update=thin)
