"""`Cell`: what stands around an arm, as a cell file (TOML) states it; its fields are the file's
keys.

Places are in the robot base or, where a thing says so, in the frame of the work object. Lengths are
in mm, angles in degrees, turned about the fixed x, then y, then z.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import RAIL, ExternalAxes
from irb2400_ctrl.cell.positioner import Angles, Plate
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.numbers import NotNegative, Positive, Vector3
from irb2400_ctrl.robot.shape import (
    Box,
    Capsule,
    Cylinder,
    Shape,
    Sphere,
    place_and_turn,
    pose,
)
from irb2400_ctrl.table import Table

Role = Literal["part", "stock", "fixture", "table", "obstacle"]
CUT = ("part", "stock")
"""what the cutting part of a tool may touch at feed"""


class Mesh(Table):
    """Triangles of an STL file (or another that trimesh reads), moved and turned."""

    kind: Literal["mesh"]
    file: Path
    """relative to the cell file"""
    unit: Literal["mm", "cm", "m", "inch"] = "mm"
    """of the file: STL states none"""
    place_mm: Vector3 = (0.0, 0.0, 0.0)
    turn_deg: Vector3 = (0.0, 0.0, 0.0)


CellShape = Annotated[Capsule | Cylinder | Sphere | Box | Mesh, Field(discriminator="kind")]


class Placed(Table):
    """Where a frame stands in the robot base."""

    place_mm: Vector3
    turn_deg: Vector3 = (0.0, 0.0, 0.0)

    @property
    def pose(self) -> Array:
        """X_BW [m], shape (4, 4)."""
        return pose(self.place_mm, self.turn_deg)

    @classmethod
    def at(cls, X: Array) -> Self:
        """A frame at the pose X (4, 4) [m]."""
        place, turn = place_and_turn(X)
        return cls(place_mm=place, turn_deg=turn)


RailPlace = float | Literal["move"]


class Rail(Table):
    """A straight track under the arm. Places in the base are stated with its carriage at zero."""

    direction: Vector3
    """in the robot base; its length says nothing"""
    range_mm: tuple[float, float]
    position_mm: RailPlace = 0.0
    """where the carriage stands while the arm works, or that it moves"""
    operations: dict[str, RailPlace] = Field(default_factory=dict)
    """where it stands during an operation of this name, or number [mm], or that it moves"""
    speed_mm_s: Positive | None = None
    acceleration_mm_s2: Positive | None = None
    jerk_mm_s3: Positive | None = None
    """limits of a carriage that moves during the cut; of the jerk, where it has one"""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        low, high = self.range_mm
        if not any(self.direction):
            raise ValueError("direction: found no direction, expected one such as [0, 1, 0]")
        if not low + 10 <= high:
            found = f"range_mm: found {low:g} to {high:g}"
            raise ValueError(f"{found}, expected the lower end first, 10 mm or more (not metres)")
        places = {"position_mm": self.position_mm, **self.operations}
        if "move" in places.values():
            _ = self.moving
        for name, place in places.items():
            if place != "move" and not low <= place <= high:
                raise ValueError(
                    f"{name}: found {place:g}, expected a place on the rail, {low:g} to {high:g}"
                )
        return self

    @property
    def stands_mm(self) -> float:
        """Where the carriage stands, or what places are stated at where it moves [mm]."""
        return 0.0 if self.position_mm == "move" else self.position_mm

    @property
    def moving(self) -> ExternalAxes:
        """The carriage as it moves during the cut: all else slides the other way.

        Raises:
            ValueError: it has no limits of speed and acceleration.
        """
        if self.speed_mm_s is None or self.acceleration_mm_s2 is None:
            raise ValueError(
                "the rail has no speed_mm_s or no acceleration_mm_s2, expected both of a carriage "
                'that moves during the cut ("move")'
            )
        way = np.array(self.direction, dtype=float)
        return ExternalAxes(
            names=RAIL,
            direction=-way[None] / np.linalg.norm(way),
            point=np.zeros((1, 3)),
            low=np.array([self.range_mm[0] / 1e3]),
            high=np.array([self.range_mm[1] / 1e3]),
            speed=np.array([self.speed_mm_s / 1e3]),
            acceleration=np.array([self.acceleration_mm_s2 / 1e3]),
            jerk=np.array([(self.jerk_mm_s3 or np.inf) / 1e3]),
            slides=1,
        )

    def asked(self, number: int, name: str) -> RailPlace:
        """Where the carriage stands during an operation [mm], or that it moves."""
        return self.operations.get(name, self.operations.get(str(number), self.position_mm))

    def moved(self, distance_mm: float) -> Array:
        """What a carriage that goes so far does to everything else, as the arm sees it, (4, 4)."""
        way = np.array(self.direction) / np.linalg.norm(self.direction)
        return pose((-distance_mm * way).tolist())


class Thing(Table):
    """A body of the cell that stands still."""

    name: str = Field(min_length=1)
    role: Role
    frame: Literal["base", "work_object"] = "base"
    shapes: tuple[CellShape, ...] = Field(min_length=1)

    @property
    def may_be_cut(self) -> bool:
        """Whether the cutting part of a tool may touch it at feed."""
        return self.role in CUT


class CellTool(Table):
    """A tool by name: its TCP, and the space that it takes up in the frame of that TCP.

    It takes the place of what the robot file's spindle holds; the spindle stays, and so do the mass
    data of the robot file.
    """

    name: str = Field(min_length=1)
    number: int | None = None
    """of the CAM file: chosen for the operations with this tool where no tool is named"""
    offset_mm: Vector3 = (0.0, 0.0, 0.0)
    """its tip in the TCP frame of the robot file; the third is out of the spindle"""
    shapes: tuple[Shape, ...] = Field(min_length=1)
    """in the TCP frame at its own tip"""


class Cell(Table):
    """The surroundings of an arm."""

    schema_version: Literal[1] = 1
    name: str = Field(min_length=1)
    clearance_mm: NotNegative = 0.0
    """a motion keeps at least this distance, or is refused; what cuts and what may be cut come as
    near as its program says"""
    floor_mm: float | None = None
    """height of the floor over the origin of the robot base, up against gravity: below zero under
    an arm that hangs; absent: no floor"""
    work_object: Placed | None = None
    rail: Rail | None = None
    positioner: Plate | None = None
    """turns the work object; its place is stated at zero angles"""
    things: tuple[Thing, ...] = ()
    tools: tuple[CellTool, ...] = ()
    folder: Path = Field(default=Path(), exclude=True)
    """where the files of meshes are looked for"""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = []
        for what, names in (
            ("things", [thing.name for thing in self.things]),
            ("tools", [tool.name for tool in self.tools]),
        ):
            twice = sorted({name for name in names if names.count(name) > 1})
            problems += [f"two {what} are called {name!r}" for name in twice]
        numbers = [tool.number for tool in self.tools if tool.number is not None]
        again = sorted({number for number in numbers if numbers.count(number) > 1})
        problems += [f"two tools have the number {number}" for number in again]
        beyond = [t.name for t in self.tools if all(s.place()[2, 3] > 0 for s in t.shapes)]
        problems += [
            f"tool {name}: all of it lies beyond its tip, at positive z, where the part is; z "
            "points out of the spindle, expected negative z"
            for name in beyond
        ]
        placed = [thing.name for thing in self.things if thing.frame == "work_object"]
        if placed and self.work_object is None:
            problems.append(
                f"{placed[0]} stands in the frame of the work object, but there is no "
                "[work_object] with its place_mm"
            )
        if self.positioner is not None and self.work_object is None:
            problems.append(
                "[positioner] turns the work object, but there is no [work_object] with its "
                "place_mm (at zero angles)"
            )
        if problems:
            raise ValueError("; ".join(problems))
        return self

    @property
    def work_frame(self) -> Array | None:
        """X_BW of the work object, as the arm sees it from its carriage and as the positioner has
        turned it, shape (4, 4); None where the file has none."""
        if self.work_object is None:
            return None
        return self.seen @ self.turned @ self.work_object.pose

    @property
    def turned(self) -> Array:
        """What the positioner does to the work object, shape (4, 4)."""
        angles = self.positioner_deg
        return (
            np.eye(4)
            if self.positioner is None or angles is None
            else self.positioner.moved(angles)
        )

    @property
    def positioner_deg(self) -> Angles | None:
        """(tilt, turn) of the positioner; None without one, or where they are yet to be found."""
        stated = None if self.positioner is None else self.positioner.position_deg
        return None if isinstance(stated, str) else stated

    @property
    def external_axes(self) -> ExternalAxes | None:
        """Axes that move the part or the arm during the cut, as the arm sees them from its
        carriage; None where none does."""
        rail = self.rail.moving if self.rail is not None and self.rail_moves else None
        if self.positioner is None or self.positioner.position_deg != "move":
            return rail
        axes = self.positioner.moving
        return replace(axes, point=axes.point + self.seen[:3, 3]).behind(rail)

    @property
    def rail_moves(self) -> bool:
        """Whether the carriage moves during the cut; places are then those with it at zero."""
        return self.rail is not None and self.rail.position_mm == "move"

    def on_positioner(self, angles_deg: Angles | Literal["find", "move"]) -> Cell:
        """The same with the positioner at (tilt, turn) [deg], at angles to be found, or moving.

        Raises:
            InputError: the cell has no positioner, or the angles are outside its ranges.
        """
        if self.positioner is None:
            raise InputError(
                f"cell {self.name}: found no [positioner], expected one with tilt and turn"
            )
        if angles_deg != "find":
            try:
                if angles_deg == "move":
                    _ = self.positioner.moving
                else:
                    self.positioner.moved(angles_deg)
            except ValueError as error:
                raise InputError(f"cell {self.name}: {error}") from error
        plate = self.positioner.model_copy(update={"position_deg": angles_deg, "operations": {}})
        return self.model_copy(update={"positioner": plate})

    @property
    def seen(self) -> Array:
        """Pose of the base with the carriage at zero, from where the carriage stands, (4, 4)."""
        return np.eye(4) if self.rail is None else self.rail.moved(self.rail.stands_mm)

    def on_rail(self, position_mm: RailPlace) -> Cell:
        """The same with the carriage elsewhere, or moving during the cut.

        Raises:
            InputError: the cell has no rail, or not one so long.
        """
        if self.rail is None:
            raise InputError(
                f"cell {self.name}: found no [rail], expected one with direction and range_mm"
            )
        low, high = self.rail.range_mm
        if position_mm == "move":
            try:
                _ = self.rail.moving
            except ValueError as error:
                raise InputError(f"cell {self.name}: {error}") from error
        elif not low <= position_mm <= high:
            raise InputError(
                f"cell {self.name}: found {position_mm:g} mm, expected a place on the rail, "
                f"{low:g} to {high:g} mm"
            )
        moved = self.rail.model_copy(update={"position_mm": position_mm, "operations": {}})
        return self.model_copy(update={"rail": moved})

    def placed(self, X: Array | None) -> Cell:
        """The same with the work object, and all that stands in its frame, at X_BW (4, 4) [m] with
        a positioner at zero; as it is where X is None."""
        if X is None:
            return self
        standing = Placed.at(np.linalg.inv(self.seen) @ X)
        return self.model_copy(update={"work_object": standing})

    def tool_of(self, number: int | None, name: str) -> str | None:
        """Name of the tool that an operation of a CAM file asks for by number or else by name; None
        where the cell has no such tool."""
        if number is not None:
            for tool in self.tools:
                if tool.number == number:
                    return tool.name
        return next((tool.name for tool in self.tools if tool.name == name), None)

    def tool(self, name: str) -> CellTool:
        """The tool of this name.

        Raises:
            InputError: there is none; lists those that there are.
        """
        for tool in self.tools:
            if tool.name == name:
                return tool
        known = ", ".join(tool.name for tool in self.tools) or "none"
        raise InputError(
            f"cell {self.name}: found no tool called {name!r}; it has {known}; add a [[tools]] "
            "table or choose one of these"
        )
