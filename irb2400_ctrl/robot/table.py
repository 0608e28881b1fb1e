"""What every table of a robot file is: immutable, no unknown keys, no infinite numbers."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Vector3 = tuple[float, float, float]
Range = tuple[float, float]

UNKNOWN = "unknown"
"""the source of a number that nobody has stated"""


class Table(BaseModel):
    """One table of the robot file."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, ignored_types=(cached_property,)
    )
