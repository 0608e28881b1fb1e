"""`program.json`: its keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table

Point = tuple[float, float, float]


class ToolEntry(Table):
    """A tool as the CAM file states it; null: not stated."""

    number: int | None
    name: str
    diameter_mm: Positive | None
    length_mm: Positive | None
    length_offset: int | None = Field(description="number of the machine's offset")


class ProgramEventEntry(Table):
    """What the program asks for besides motion."""

    kind: str = Field(description="tool, spindle, coolant, stop, dwell, …")
    text: str = Field(description="as in the CAM file")
    line: int = Field(description="of the CAM file")
    point: int = Field(ge=-1, description="way-point that it follows, from 0; -1: before the first")
    seconds: NotNegative = Field(description="how long the tool waits there")


class OperationEntry(Table):
    """An operation of the file, and whether there is a motion for it."""

    number: int = Field(ge=1)
    name: str
    lines: tuple[int, int] = Field(description="first and last of the CAM file")
    tool: ToolEntry
    spindle_rpm: NotNegative | None
    spindle: Literal["clockwise", "counter-clockwise"]
    coolant: str = Field(description="at the first point")
    points: int = Field(ge=1, description="way-points")
    rapid_moves: int = Field(ge=0)
    cutting_length_mm: NotNegative
    rapid_length_mm: NotNegative
    feed_mm_s: tuple[float, float] | None = Field(description="smallest and largest; null: none")
    extent_mm: tuple[Point, Point] = Field(description="smallest and largest x, y, z")
    frame: list[list[float]] | None = Field(description="4 by 4, [m]; null: the file's own")
    events: list[ProgramEventEntry]
    planned: bool = Field(description="whether there is a motion")
    refused: str = Field(description="why there is none; empty where there is one")
    folder: str | None = Field(description="where its trajectory.csv and plan.json are")
    parts: int = Field(ge=0, description="in which it is followed; more than one where it unwinds")
    duration_s: Positive | None


class NoteEntry(Table):
    """A line of the file that made no motion, and why."""

    kind: Literal["ignored", "assumed", "unknown"] = Field(
        description="ignored: moves nothing; assumed: read with what is said; unknown: not "
        "understood"
    )
    line: int
    text: str
    count: int = Field(ge=1, description="statements of this kind")


class TransferEntry(Table):
    """From the end of an operation to the start of the next, where they are apart."""

    start: int = Field(alias="from", description="number of the operation")
    to: int = Field(description="number of the operation")
    distance_mm: Positive


class ProgramFile(Table):
    """A CAM program: its operations, which of them are planned, and whether they are linked."""

    schema_version: Literal[1]
    file: str = Field(description="its name")
    dialect: str = Field(description="language of the CAM file")
    units: str = Field(description="of the CAM file")
    operations: list[OperationEntry]
    notes: list[NoteEntry] = Field(description="lines that made no motion")
    transfers: list[TransferEntry]
    linked: bool = Field(description="whether trajectory.csv holds the whole as one motion")
    links_refused: str = Field(description="why not; empty where it does")
    transfers_not_planned: list[TransferEntry]
