"""A case of a sweep, a line of `cases.jsonl` and a row of `cases.parquet`: its columns."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table


class CaseRow(Table):
    """A run of a sweep. Besides the columns below there is a number for whatever was drawn or
    measured: `tcp_error_rms_mm`, `joint2_torque_ratio_max`, `gear_ripple_joint`, …; null where a
    run has none. The first line of `cases.jsonl` names the study instead."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, float | None]

    case: int = Field(ge=0, description="its number")
    draw: int = Field(ge=0, description="number of the plant")
    controller: str
    motion: str
    speed: Positive = Field(description="over the motion's own")
    status: Literal["ok", "failed", "lost"]
    message: str = Field(description="why it failed; empty where it did not")
    wall_time_s: NotNegative | None = Field(description="null: lost")
