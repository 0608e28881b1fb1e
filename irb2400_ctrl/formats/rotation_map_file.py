"""`rotation_map.json`: its keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irb2400_ctrl.table import Table


class RotationMapFile(Table):
    """What other tool rotations would bring, along a path; rows as `way_mm`, columns as
    `rotation_deg`."""

    schema_version: Literal[1]
    way_mm: list[float] = Field(description="places along the TCP's way")
    rotation_deg: list[float] = Field(description="tool rotations that were looked at")
    chosen_deg: list[float] = Field(description="rotation that is driven, at each place")
    limits: list[str] = Field(description="names of what may be met; empty: nothing")
    worst_margin: list[list[float | None]] = Field(
        description="smallest margin over what is comfortable; null out of reach"
    )
    limit: list[list[int]] = Field(description="what is met: place in `limits`, from 0")
