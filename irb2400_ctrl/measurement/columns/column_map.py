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

One entry may stand for the columns of all joints: `{j}` in its name counts them from 1, `{j0}` from
0, `{j+7}` from 8, `{3j-2}` is 1, 4, 7… (with `joints`, where further columns go on counting), and
what differs among them is a list.

[[columns]]
file = "actual_current_{j0}"
quantity = "tau"
unit = "A"
Nm_per_A = [0.11, 0.11, 0.09, 0.09, 0.09, 0.09]
gear_ratio = 101.0

Where a column holds more, or less, than what its joint does, the joint's is a sum.

[[sums]]
quantity = "q"
joint = 3
plus = { 2 = -1.0 }
"""

from __future__ import annotations

import re
from collections.abc import Collection
from itertools import count
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.two_part_time import COUNTED, TimePair
from irb2400_ctrl.reading import bounded_text, toml_tables
from irb2400_ctrl.robot.file_problems import explain
from irb2400_ctrl.table import Table
from irb2400_ctrl.typed import typed

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ticks": 1e-7, "ns": 1e-9}
TURN = 2.0 * np.pi
UNITS = {
    "q": {"rad": 1.0, "deg": TURN / 360, "rev": TURN},
    "qd": {"rad_s": 1.0, "deg_s": TURN / 360, "rpm": TURN / 60},
    "tau": {"Nm": 1.0, "kNm": 1e3, "mNm": 1e-3, "A": 1.0, "percent": 0.01},
    "q_ref": {"rad": 1.0, "deg": TURN / 360, "rev": TURN},
}


class TimeColumn(Table):
    """Which column is the time, and its unit; or how many samples a second there are."""

    column: str | None = None
    unit: Literal["s", "ms", "us", "ticks", "ns"] = "s"
    nanoseconds: str | None = None
    """a second column, beyond the whole seconds of the first"""
    microseconds: str | None = None
    milliseconds: str | None = None
    rate_Hz: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    """of a file without a time"""

    @model_validator(mode="after")
    def _in_seconds(self) -> Self:
        if (self.column is None) == (self.rate_Hz is None):
            raise ValueError("expected either column or rate_Hz")
        beyond = [word for word in COUNTED.values() if getattr(self, word) is not None]
        if beyond and self.unit != "s":
            raise ValueError(f"{beyond[0]} beyond a column in {self.unit}, expected unit = 's'")
        if len(beyond) > 1 or (beyond and self.column is None):
            raise ValueError(f"{' and '.join(beyond)}, expected one beyond a column of seconds")
        return self

    @property
    def pair(self) -> TimePair | None:
        """The columns of a time in two parts; None where it is in one."""
        for counts, word in COUNTED.items():
            beyond = getattr(self, word)
            if self.column is not None and beyond is not None:
                return TimePair(self.column, beyond, counts)
        return None


Number = Annotated[float, Field(allow_inf_nan=False)]
Numbers = Number | tuple[Number, ...]
_COUNTS = re.compile(r"\{([1-9]\d?)?j(0|[+-]\d+)?\}")
PER_JOINT = ("gear_ratio", "Nm_per_A", "full_scale_Nm", "zero", "factor", "sign")


class Column(Table):
    """One column of the file.

    Args:
        file: its name there; quantity: q, qd, tau or q_ref; joint: from 1, left out where the name
            holds `{j}`, `{j0}`, `{j+1}`, `{2j}`…, or a list there, if their order is not the
            robot's: the joint of the first, the second…
        joints: how many it stands for, default as many as the file has columns of that name.
        unit: of `UNITS`.
        gear_ratio: of a column on the motor's side (motor turns per joint turn, signed).
        Nm_per_A: of a current at the motor; full_scale_Nm: of a torque in per cent.
        zero: of an angle, what the file writes where the joint is at zero.
        factor: anything else; sign: 1 or -1.
        wrapped: of an angle that jumps by a whole turn.
    """

    file: str
    quantity: Literal["q", "qd", "tau", "q_ref"]
    joint: Annotated[int, Field(ge=1)] | tuple[Annotated[int, Field(ge=1)], ...] = 0
    joints: int | None = Field(default=None, ge=1, le=99)
    unit: str
    gear_ratio: Numbers = 1.0
    Nm_per_A: Numbers | None = None
    full_scale_Nm: Numbers | None = None
    zero: Numbers = 0.0
    factor: Numbers = 1.0
    sign: Literal[1, -1] | tuple[Literal[1, -1], ...] = 1
    wrapped: bool = False

    @model_validator(mode="after")
    def _complete(self) -> Self:
        known = UNITS[self.quantity]
        if self.unit not in known:
            raise ValueError(f"unit {self.unit!r}, expected one of {', '.join(known)}")
        if self.quantity not in {"q", "q_ref"}:
            if self.wrapped:
                raise ValueError(f"wrapped = true for {self.quantity}, expected an angle")
            if any(_each(self.zero)):
                raise ValueError(f"zero for {self.quantity}, expected an angle")
        if self.unit == "A" and self.Nm_per_A is None:
            raise ValueError("a current needs Nm_per_A, the torque constant of the motor")
        if self.unit == "percent" and self.full_scale_Nm is None:
            raise ValueError("a torque in per cent needs full_scale_Nm")
        if 0.0 in _each(self.gear_ratio) + _each(self.factor):
            raise ValueError("gear_ratio and factor must not be zero")
        self._of_which_joints()
        return self

    def _of_which_joints(self) -> None:
        listed = [name for name in PER_JOINT if isinstance(getattr(self, name), tuple)]
        if self.every_joint:
            if self.joint and not self.order:
                raise ValueError(f"joint = {self.joint} and {{j}} in file: expected one of them")
            if sorted(self.order) != list(range(1, len(self.order) + 1)):
                raise ValueError(f"joint = {list(self.order)}, expected 1 to n, each once")
            return
        if self.order:
            raise ValueError("a list of joints needs {j} or {j0} in file")
        if not self.joint:
            raise ValueError("which joint? expected joint = 1…, or {j} or {j0} in file")
        if listed:
            raise ValueError("a list of numbers needs {j} or {j0} in file")

    @property
    def order(self) -> tuple[int, ...]:
        """Joints (from 1) of the columns that the entry stands for; empty: in their own order."""
        return self.joint if isinstance(self.joint, tuple) else ()

    @property
    def every_joint(self) -> bool:
        """Whether the entry stands for the columns of all joints."""
        return _COUNTS.search(self.file) is not None

    def name_of(self, joint: int) -> str:
        """The column of a joint."""

        def place(found: re.Match[str]) -> str:
            step = int(found[1] or 1)
            return str(step * (joint - 1) if found[2] == "0" else step * joint + int(found[2] or 0))

        return _COUNTS.sub(place, self.file)

    def of_joint(self, joint: int) -> Self:
        """The entry of one joint.

        Raises:
            InputError: a list that is too short.
        """
        on = self._taken("joint", joint, joint) if self.order else joint
        change: dict[str, object] = {"file": self.name_of(joint), "joint": on}
        for name in PER_JOINT:
            if isinstance(getattr(self, name), tuple):
                change[name] = self._taken(name, on, joint)
        return self.model_copy(update=change)

    def _taken(self, name: str, place: int, column: int) -> Any:
        """One of a list of numbers, counted from 1, for one of the columns."""
        values = getattr(self, name)
        if len(values) < place:
            raise InputError(
                f"column map: {name} of {self.file!r} holds {len(values)} numbers, the log has a "
                f"column {self.name_of(column)!r}"
            )
        return values[place - 1]

    @property
    def scale(self) -> float:
        """SI at the joint per number in the file."""
        ratio = _one(self.gear_ratio)
        gear = ratio if self.quantity == "tau" else 1.0 / ratio
        constant = {"A": self.Nm_per_A, "percent": self.full_scale_Nm}.get(self.unit)
        unit = UNITS[self.quantity][self.unit] * (1.0 if constant is None else _one(constant))
        return _one(self.sign) * _one(self.factor) * unit * gear


def _each(values: Numbers) -> tuple[float, ...]:
    return values if isinstance(values, tuple) else (values,)


def _one(value: Numbers) -> float:
    (number,) = _each(value)
    return number


class Sum(Table):
    """What a joint does, where its column holds what others do as well.

    Args:
        quantity: q (its speeds and commanded angles too) or tau; joint: from 1.
        plus: joint -> factor of its column, as it is before any sum.
    """

    quantity: Literal["q", "tau"]
    joint: Annotated[int, Field(ge=1)]
    plus: dict[Annotated[int, Field(ge=1)], Number] = Field(min_length=1)

    @model_validator(mode="after")
    def _of_others(self) -> Self:
        if self.joint in self.plus:
            raise ValueError(f"joint {self.joint} plus itself, expected other joints")
        return self

    @property
    def signals(self) -> tuple[str, ...]:
        """Quantities of columns that are such sums."""
        return ("q", "qd", "q_ref") if self.quantity == "q" else ("tau",)


class ColumnMap(Table):
    """All columns that count; the others are kept aside."""

    time: TimeColumn | None = None
    columns: tuple[Column, ...] = Field(min_length=1)
    sums: tuple[Sum, ...] = ()

    def of(self, names: Collection[str]) -> list[Column]:
        """The entries of a file with these columns, one for each column."""
        found = []
        for column in self.columns:
            if not column.every_joint:
                found.append(column)
                continue
            there = next(j for j in count() if column.name_of(j + 1) not in names)
            found += [column.of_joint(j + 1) for j in range(column.joints or max(there, 1))]
        return found

    def named(self, names: Collection[str]) -> set[str]:
        """The columns that count, of a file with these, the time among them."""
        time = TimeColumn(column="time_s") if self.time is None else self.time
        stamps = {time.column} if time.pair is None else {time.pair.seconds, time.pair.beyond}
        return {column.file for column in self.of(names)} | {
            name for name in stamps if name is not None
        }

    @model_validator(mode="after")
    def _once(self) -> Self:
        for what, keys in (
            ("column", [c.file for c in self.columns]),
            ("quantity and joint", [f"{c.quantity} {c.joint}" for c in self.columns]),
            ("the sum for", [f"{s.quantity} {s.joint}" for s in self.sums]),
        ):
            doubled = sorted({key for key in keys if keys.count(key) > 1})
            if doubled:
                raise ValueError(f"{what} {doubled[0]!r} appears more than once")
        return self


@typed
def load_column_map(path: Path | str) -> ColumnMap:
    """Read a column map.

    Raises:
        InputError: no such file, not TOML, unknown or contradictory entries; all at once.
    """
    path = Path(path)
    try:
        what = "a column map (TOML)"
        text = bounded_text(path, what)
        return ColumnMap.model_validate(toml_tables(text, str(path), what))
    except ValidationError as error:
        wrong = explain(str(path), "column map", error, [ColumnMap, TimeColumn, Column])
        raise InputError(f"{wrong}\n  docs/logs.md says what a column map holds") from error
