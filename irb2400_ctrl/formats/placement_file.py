"""`placement.json`: its keys, for a part and for an arm on its rail."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, RootModel

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table

Frame = tuple[float, float, float, float, float, float]
_MARGINS = "smallest of each; the unit is in the name, those without are parts"


class CuttingForceEntry(Table):
    """A force on the tip."""

    force_N: list[float] = Field(description="one number for any direction, or x, y, z")
    stiffness_Nm_rad: list[Positive | None] = Field(description="of each joint; null: rigid")
    stiffness_from: str = Field(description="who states it")


class ContinuousEntry(Table):
    """Margins over the continuous path."""

    margins: dict[str, float] = Field(description=_MARGINS)
    deflection_mm: NotNegative | None = Field(description="how far the tip gives way")
    refused: str = Field(description="why there is no motion; empty where there is one")


class OutlookEntry(Table):
    """What a place promises."""

    work_frame: Frame = Field(description="x, y, z [mm], turns about x, y, z [deg]: --work-frame")
    worth: float = Field(description="worst margin over what is comfortable; 1 is comfortable")
    worst: str = Field(description="its name, or why the part cannot be driven there")
    margins: dict[str, float] = Field(description=_MARGINS)
    deflection_mm: NotNegative | None = Field(description="how far the tip gives way")
    refused: str = Field(description="why the part cannot be driven there; empty where it can")
    continuous: ContinuousEntry | None = None


class MapEntry(Table):
    """A place that was looked at."""

    middle_mm: tuple[float, float, float] = Field(description="of the part, in the arm's base")
    turn_deg: float = Field(description="of the part about the vertical")
    worth: float = Field(description="as of the places")
    worst: str = Field(description="as of the places")
    deflection_mm: NotNegative | None = Field(description="how far the tip gives way")


class PlannedEntry(Table):
    """What planning at a place gave; only `refused` where it did not."""

    refused: str = Field(description="why there is no plan; empty where there is one")
    duration_s: Positive | None = None
    singularity_margin: dict[str, float] | None = None
    margins: dict[str, float] | None = Field(
        None,
        description="the same as parts of their largest values, and joint_limits_deg, as of the "
        "continuous path",
    )
    clearance_mm: float | None = None
    max_torque_ratio: NotNegative | None = None
    max_velocity_ratio: NotNegative | None = None
    guaranteed: bool | None = None
    deflection_mm: NotNegative | None = None


class PartPlacement(Table):
    """Where to put a part."""

    schema_version: Literal[1]
    robot: str = Field(description="its name")
    parts: list[str] = Field(description="files of the part's tool paths")
    start: OutlookEntry = Field(description="where it stood")
    found: OutlookEntry = Field(description="where it should stand")
    cutting_force: CuttingForceEntry | None = Field(description="null: none was asked for")
    looked_at: int = Field(ge=1, description="number of places")
    map: list[MapEntry] = Field(description="all of them")
    planned: dict[Literal["start", "found"], PlannedEntry] | None = None


class RailMapEntry(Table):
    """A place on the rail that was looked at."""

    rail_mm: float = Field(description="place of the carriage")
    worth: float = Field(description="as of the places")
    worst: str = Field(description="as of the places")


class RailPlacement(Table):
    """Where the carriage of an arm should stand."""

    schema_version: Literal[1]
    rail_mm: float = Field(description="where it should stand")
    start: OutlookEntry = Field(description="where it stood")
    found: OutlookEntry = Field(description="what it has there")
    map: list[RailMapEntry] = Field(description="all places that were looked at")


class PlacementFile(RootModel[PartPlacement | RailPlacement]):
    """Where a part should stand, or an arm on its rail."""
