"""`excitation.json`: its keys, for a motion that tells effects apart and for one to identify by."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, RootModel

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table


class AssumedEntry(Table):
    """What the distances rest on."""

    size_of_each_effect_over_joint_rms_torque: Positive
    noise_over_torque_limit: Positive
    noise_Nm: list[Positive] = Field(description="of each joint")
    separated_from_distance: Positive


class PairEntry(Table):
    """An effect and what it may be taken for."""

    member: str = Field(description="effect and its joint")
    rival: str = Field(description="effect and its joint, or the uncertain base")
    distance_before: NotNegative = Field(description="on the standard motion [standard errors]")
    distance_after: NotNegative = Field(description="on this motion [standard errors]")
    sine_before: NotNegative = Field(description="of the angle between their torques; 0: alike")
    sine_after: NotNegative
    separable_by_motion: bool
    verdict: str = Field(description="in words")
    largest_distance_of_any_record: NotNegative | None = Field(description="null: no bound")
    why_not: str = Field(description="empty where a motion separates them")


class _Extent(Table):
    """How near to its limits the arm goes."""

    schema_version: Literal[1]
    robot: str = Field(description="its name")
    duration_s: Positive
    pieces: list[str] = Field(description="kinds of motion, in their order")
    max_torque_ratio: NotNegative = Field(description="over the robot's limit")
    max_velocity_ratio: NotNegative = Field(description="over the robot's limit")
    max_acceleration_ratio: NotNegative | None = Field(
        None, description="over the limits below; null in files from before they were kept"
    )
    acceleration_limits_deg_s2: list[Positive] | None = Field(
        None, description="of each joint that the motion keeps"
    )
    acceleration_assumed_of_joints: list[int] | None = Field(
        None, description="joints, from 1, of which the robot file states none"
    )
    ranges_kept_deg: list[tuple[float, float]] | None = Field(
        None, description="of each joint, where a part of the file's has room; else null"
    )
    smallest_distance_from_joint_box_deg: float = Field(description="from the ranges kept")
    smallest_height_m: float = Field(description="of wrist and tip above the floor")
    smallest_radius_m: float = Field(description="of wrist and tip from axis 1")


class SeparatingMotion(_Extent):
    """A motion that tells effects apart that look alike."""

    group: str
    members: list[str] = Field(description="kinds of effects")
    joint: int | None = Field(description="counted from 1; null: all")
    assumed: AssumedEntry
    smallest_distance_before: NotNegative = Field(description="of the pairs that can be separated")
    smallest_distance_after: NotNegative
    improves: bool = Field(description="whether it is better than the standard motion")
    separability: list[PairEntry]
    splits: str = Field(description="what tells them apart, in words")
    measure_else: str = Field(description="what to measure besides; empty where motion is enough")


class ConditionEntry(Table):
    """Of the standard motion and of this one."""

    standard: NotNegative
    planned: NotNegative


class IdentifyingMotion(_Extent):
    """Two motions: one that shows bodies and fast friction, and slow runs that show friction."""

    purpose: Literal["identify"] = Field(alias="for")
    friction_runs_s: Positive = Field(description="duration of the slow runs")
    condition_number: ConditionEntry = Field(description="of the regressor")
    smallest_distance: ConditionEntry = Field(
        description="of the number that is shown least [standard errors]"
    )
    friction_speeds_rad_s: list[list[Positive]] = Field(description="of each joint")


class ExcitationFile(RootModel[SeparatingMotion | IdentifyingMotion]):
    """A planned motion, and what it promises to show."""
