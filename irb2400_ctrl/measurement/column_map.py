"""What the columns of somebody else's file are: a TOML file with one entry per column.

[time]
column = "Time"
unit = "ms"

[[columns]]
file = "J2_current"
quantity = "tau"
joint = 2
unit = "A"
Nm_per_A = 0.62
gear_ratio = -101.0
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading import bounded_text, toml_tables

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
TURN = 2.0 * np.pi
UNITS = {
    "q": {"rad": 1.0, "deg": TURN / 360, "rev": TURN},
    "qd": {"rad_s": 1.0, "deg_s": TURN / 360, "rpm": TURN / 60},
    "tau": {"Nm": 1.0, "kNm": 1e3, "mNm": 1e-3, "A": 1.0, "percent": 0.01},
    "q_ref": {"rad": 1.0, "deg": TURN / 360, "rev": TURN},
}


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TimeColumn(_Strict):
    """Which column is the time, and its unit."""

    column: str
    unit: Literal["s", "ms", "us", "ns"] = "s"


class Column(_Strict):
    """One column of the file.

    Args:
        file: its name there; quantity: q, qd, tau or q_ref; joint: from 1.
        unit: of `UNITS`.
        gear_ratio: of a column on the motor's side (motor turns per joint turn, signed).
        Nm_per_A: of a current at the motor; full_scale_Nm: of a torque in per cent.
        factor: anything else; sign: 1 or -1.
    """

    file: str
    quantity: Literal["q", "qd", "tau", "q_ref"]
    joint: int = Field(ge=1)
    unit: str
    gear_ratio: float = Field(default=1.0, allow_inf_nan=False)
    Nm_per_A: float | None = Field(default=None, allow_inf_nan=False)
    full_scale_Nm: float | None = Field(default=None, allow_inf_nan=False)
    factor: float = Field(default=1.0, allow_inf_nan=False)
    sign: Literal[1, -1] = 1

    @model_validator(mode="after")
    def _complete(self) -> Self:
        known = UNITS[self.quantity]
        if self.unit not in known:
            raise ValueError(f"unit {self.unit!r}, expected one of {', '.join(known)}")
        if self.unit == "A" and self.Nm_per_A is None:
            raise ValueError("a current needs Nm_per_A, the torque constant of the motor")
        if self.unit == "percent" and self.full_scale_Nm is None:
            raise ValueError("a torque in per cent needs full_scale_Nm")
        if self.gear_ratio == 0.0 or self.factor == 0.0:
            raise ValueError("gear_ratio and factor must not be zero")
        return self

    @property
    def scale(self) -> float:
        """SI at the joint per number in the file."""
        gear = self.gear_ratio if self.quantity == "tau" else 1.0 / self.gear_ratio
        constant = {"A": self.Nm_per_A, "percent": self.full_scale_Nm}.get(self.unit) or 1.0
        return self.sign * self.factor * UNITS[self.quantity][self.unit] * constant * gear


class ColumnMap(_Strict):
    """All columns that count; the others are kept aside."""

    time: TimeColumn | None = None
    columns: tuple[Column, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _once(self) -> Self:
        for what, keys in (
            ("column", [c.file for c in self.columns]),
            ("quantity and joint", [f"{c.quantity} {c.joint}" for c in self.columns]),
        ):
            doubled = sorted({key for key in keys if keys.count(key) > 1})
            if doubled:
                raise ValueError(f"{what} {doubled[0]!r} appears more than once")
        return self


def load_column_map(path: Path | str) -> ColumnMap:
    """Read a column map.

    Raises:
        InputError: no such file, not TOML, unknown or contradictory entries; all at once.
    """
    path = Path(path)
    try:
        text = bounded_text(path, "a column map (TOML)")
        return ColumnMap.model_validate(toml_tables(text, str(path)))
    except ValidationError as error:
        wrong = "; ".join(
            f"{'.'.join(str(part) for part in item['loc'])}: {item['msg']}"
            for item in error.errors()[:5]
        )
        raise InputError(f"{path}: {wrong} (docs/logs.md says what a column map holds)") from error
