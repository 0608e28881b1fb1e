"""`watch.json`: its keys."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table


class AlarmEntry(Table):
    """A joint that left what is usual."""

    joint: int = Field(ge=1, description="counted from 1")
    since_s: float = Field(description="when it began, by the log's time")
    at_s: float = Field(description="when the alarm was given")
    torque_Nm: float = Field(description="mean of what the model leaves since then")


class SuspicionEntry(Table):
    """What a short diagnosis says of alarms."""

    since_s: float = Field(description="when it began, by the log's time")
    alarms: list[AlarmEntry] = Field(description="that it explains")
    diagnosed_s: NotNegative = Field(description="length of the record that was diagnosed")
    says: str = Field(description="in words")
    effects: list[dict[str, Any]] = Field(description="kind, joint, confidence, and since when")


class ChangeEntry(Table):
    """What has drifted since the learned stretch, with two standard deviations."""

    change: float = Field(description="since the learned stretch")
    change_band: NotNegative = Field(description="of it, to either side")


class FrictionEntry(Table):
    """A friction of every joint at the log's end, with two standard deviations."""

    value: list[float] = Field(description="of each joint")
    band: list[NotNegative] = Field(description="of it, to either side")
    change: list[float] = Field(description="since the learned stretch")
    change_band: list[NotNegative] = Field(description="of it, to either side")


class TrackedEntry(Table):
    """The numbers that drift."""

    coulomb_Nm: FrictionEntry = Field(description="Coulomb friction")
    viscous_Nms_rad: FrictionEntry = Field(description="viscous friction")
    load_kg: ChangeEntry = Field(description="mass added at the tool")


class WatchFile(Table):
    """An arm that was watched."""

    schema_version: Literal[1]
    log: str = Field(description="what was watched")
    robot: str = Field(description="name of the model")
    learned_s: Positive = Field(description="beginning that was taken as sound")
    watched_s: NotNegative = Field(description="what was judged after it")
    false_alarm_after_s: Positive = Field(
        description="mean time of motion between false alarms, all joints together"
    )
    external_torque_band_Nm: list[float | None] = Field(
        description="of each joint, three standard deviations while nothing was wrong; null for a "
        "joint that hardly moved"
    )
    largest_external_torque_Nm: list[NotNegative] = Field(description="of each joint")
    tracked: TrackedEntry = Field(description="as it stands at the log's end")
    alarms: list[AlarmEntry] = Field(description="in their order")
    suspicions: list[SuspicionEntry] = Field(description="what may be their cause")
