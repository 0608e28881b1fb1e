"""`plan.json`: its keys, for one operation and for a whole program."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, RootModel

from irb2400_ctrl.formats.placement_file import CuttingForceEntry
from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table


class ClearanceEntry(Table):
    """The smallest distance between two bodies."""

    value: float | None = Field(description="lower bound over the whole motion [mm]; null: unknown")
    pair: tuple[str, str] | None = Field(description="the bodies that come nearest")
    at_mm: float | None = Field(description="where, along the TCP's way")
    reason: str | None = Field(None, description="why it is not known")


class MarginsEntry(Table):
    """Smallest distances from the singularities."""

    wrist: NotNegative = Field(description="|sin q5| [-]")
    shoulder: NotNegative = Field(description="[m]")
    elbow: NotNegative = Field(description="[m]")


class StretchEntry(Table):
    """A stretch that is driven below the programmed feed."""

    from_mm: float
    to_mm: float
    from_s: float
    to_s: float
    point: int = Field(description="way-point of its slowest place")
    slowest_mm_s: NotNegative
    feed_mm_s: Positive = Field(description="programmed there")
    limit: str = Field(description="what keeps it slow")
    place: str = Field(description="what is there")


class FeedEntry(Table):
    """Where the programmed feed is held; of a whole program the first two alone."""

    programmed_mm: NotNegative = Field(description="length of the way with a programmed feed")
    share_at_feed: NotNegative = Field(description="part of it that is driven at the feed")
    below_by_limit_mm: dict[str, float] | None = None
    below_by_place_mm: dict[str, float] | None = None
    stretches: list[StretchEntry] | None = None
    stretches_left_out: int | None = None


class DeflectionEntry(CuttingForceEntry):
    """How far the tip gives way to the cutting force."""

    largest_mm: NotNegative
    at_mm: float = Field(description="where, along the TCP's way")
    mean_mm: NotNegative


class ComparedEntry(Table):
    """A way to hold the tool that was compared."""

    kind: str = Field(description="how the tool rotation is chosen")
    branch: int = Field(description="of the inverse kinematics")
    relative_margin: float = Field(description="distance from singularities over its largest")
    turn_deg: float = Field(description="of the tool about its axis, along the path")
    duration_s: Positive = Field(description="fastest, without limits of rates")
    deflection_mm: NotNegative | None = None


class PassageEntry(Table):
    """Where the path comes close to the wrist singularity."""

    at_mm: float
    miss_deg: float = Field(description="how near it comes")
    taken: Literal["through", "past"]


class RemedyEntry(Table):
    """What could be done there."""

    remedy: str
    duration_s: Positive | None = Field(description="null: it leads nowhere")
    position_mm: NotNegative = Field(description="how far the TCP leaves the path")
    angle_deg: NotNegative = Field(description="how far the tool leaves its orientation")
    allowed: bool


class ExternalAxisEntry(Table):
    """An axis that turns the part during the cut; bounds over all times of the rows."""

    name: Literal["tilt", "turn"]
    between_deg: tuple[float, float] = Field(description="angles that it stays between")
    max_speed_ratio: NotNegative
    max_acceleration_ratio: NotNegative
    speed_limit_deg_s: Positive
    acceleration_limit_deg_s2: Positive


class RailAxisEntry(Table):
    """A rail whose carriage moves during the cut; bounds over all times of the rows."""

    name: Literal["rail"]
    between_mm: tuple[float, float] = Field(description="places that the carriage stays between")
    max_speed_ratio: NotNegative
    max_acceleration_ratio: NotNegative
    speed_limit_mm_s: Positive
    acceleration_limit_mm_s2: Positive


class _Promise(Table):
    """What both kinds of plan promise."""

    schema_version: Literal[2]
    path: str = Field(description="name of the tool path or program")
    robot: str = Field(description="its name")
    points: int = Field(ge=1, description="way-points")
    length_mm: NotNegative = Field(description="of the TCP's way")
    duration_s: Positive
    reachable: Literal[True]
    max_tcp_deviation_mm: NotNegative = Field(description="from the way-points' polygon")
    max_tool_axis_deviation_deg: NotNegative = Field(description="from the stated tool axis")
    margins_of: Literal["rows", "path"] = Field(
        description="of what the margins are bounds: the rows as they are read, or the path"
    )
    singularity_margin: MarginsEntry
    clearance_mm: ClearanceEntry
    external_axes: list[RailAxisEntry | ExternalAxisEntry] = Field(
        description="of a carriage and of a positioner that move"
    )
    max_torque_ratio: NotNegative = Field(description="over the robot's limit, at every instant")
    max_velocity_ratio: NotNegative = Field(description="over the robot's limit, at every instant")
    max_acceleration_ratio: NotNegative | None = Field(
        None, description="over the robot's limit, at every instant; null where it states none"
    )
    max_feed_ratio: NotNegative | None = Field(description="over the feed; null without a feed")
    feed: FeedEntry | None = Field(description="null without a programmed feed")
    torque_share: float = Field(gt=0, le=1, description="of the torque limits that was allowed")
    interpolation: Literal["cubic", "linear"] = Field(description="how the rows are read")
    guaranteed: bool = Field(description="whether the torque bound holds at every instant")
    guarantee_note: str = Field(description="why not; empty where it does")
    timing: Literal["certified", "toppra"]
    wall_time_s: dict[str, float] = Field(description="of planning, by stage")


class OperationPlan(_Promise):
    """A tool path as one motion from rest to rest."""

    rail_mm: float | None = Field(
        description="where the carriage stands; null without a rail, and where it moves"
    )
    positioner_deg: tuple[float, float] | None = Field(description="tilt, turn; null without one")
    deflection: DeflectionEntry | None = Field(description="null without a cutting force")
    tool_rotation: str = Field(description="how it was chosen")
    tool_rotation_deg: tuple[float, float] = Field(description="smallest and largest")
    branch: int = Field(description="of the inverse kinematics")
    compared: list[ComparedEntry] = Field(description="ways to hold the tool")
    peak_torque_Nm: list[NotNegative] = Field(description="of each joint, at the rows")
    wrist_passages: list[PassageEntry]
    wrist_remedies: list[RemedyEntry] = Field(description="cheapest first")
    rates_note: str | None = Field(None, description="where the rates are kept by slowing down")
    duration_without_rates_s: Positive | None = None
    torque_rate_limit_Nm_s: list[Positive | None] | None = None
    max_torque_rate_Nm_s: list[NotNegative | None] | None = None
    jerk_limit_deg_s3: list[Positive | None] | None = None
    max_jerk_deg_s3: list[NotNegative | None] | None = None


class PlaneEntry(Table):
    """Above what the arm moves between operations."""

    clearance_mm: float = Field(description="above the highest cut")
    approach_mm: float = Field(description="last part of the way down, along the tool axis")
    up: tuple[float, float, float] = Field(description="its normal, in the base")
    height_mm: float = Field(description="along it")


class SegmentEntry(Table):
    """A piece of the motion from rest to rest."""

    kind: Literal[
        "approach", "lead-in", "operation", "retract", "link", "unwind", "return", "wait", "turn"
    ]
    operation: int = Field(description="its number")
    start_s: float
    end_s: float
    moves: Literal["joints", "tool", "positioner", "carriage", "nothing"]
    length_mm: NotNegative
    from_deg: list[float] = Field(description="joint angles")
    to_deg: list[float] = Field(description="joint angles")
    feed_mm_s: tuple[float, float] | None = Field(description="smallest and largest; null: none")
    clearance_mm: ClearanceEntry
    guaranteed: bool
    max_torque_ratio: NotNegative
    max_velocity_ratio: NotNegative
    max_acceleration_ratio: NotNegative | None = None
    above_clearance_plane_mm: float | None = None
    feed: FeedEntry | None = None
    rail_mm: float | None = Field(None, description="where the carriage is at the start")
    rail_to_mm: float | None = Field(None, description="where it goes")
    positioner_deg: tuple[float, float] | None = None
    positioner_to_deg: tuple[float, float] | None = Field(None, description="where it moves")
    note: str | None = None


class EventEntry(Table):
    """What the program asks for besides motion."""

    kind: str = Field(description="tool, spindle, coolant, stop, dwell, …")
    text: str = Field(description="as in the CAM file")
    line: int = Field(description="of the CAM file")
    operation: int = Field(description="its number")
    time_s: float
    at_rest: bool = Field(description="whether the arm stands there")


class UnwindingEntry(Table):
    """Where axes are turned back in the middle of an operation."""

    operation: int
    at_s: float
    turned_deg: list[float] = Field(description="each joint")
    says: str
    because: str


class ProgramPlan(_Promise):
    """A whole CAM program as one motion."""

    clearance_plane: PlaneEntry
    segments: list[SegmentEntry]
    events: list[EventEntry]
    unwindings: list[UnwindingEntry]


class PlanFile(RootModel[OperationPlan | ProgramPlan]):
    """A timed motion and what is promised of it."""
