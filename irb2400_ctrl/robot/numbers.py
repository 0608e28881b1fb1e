"""Numbers as the tables of a robot file hold them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Vector3 = tuple[float, float, float]
Range = tuple[float, float]

UNKNOWN = "unknown"
"""the source of a number that nobody has stated"""
