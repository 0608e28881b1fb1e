"""`verification.json` of a C package: its keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table


class TargetEntry(Table):
    """What was measured on the emulated processor."""

    compiler: str
    flags: str
    instructions_min: int = Field(ge=1, description="of a step")
    instructions_max: int = Field(ge=1, description="of a step")
    estimated_cycles_min: int | None = Field(description="null: no published timing table")
    estimated_cycles_max: int | None
    repeatable: bool = Field(description="the same number of instructions a second time")
    stack_bytes: int = Field(ge=0)
    code_bytes: int = Field(ge=0)
    table_bytes: int = Field(ge=0)
    undefined_symbols: list[str]
    forbidden_symbols: list[str] = Field(
        description="double helpers in a float build, functions of the C library, the heap"
    )
    values_compared: int = Field(ge=0, description="with this computer's")
    values_different: int = Field(ge=0, description="in any bit")
    software_double: bool = Field(description="double precision without hardware for it")
    faults_held: bool = Field(description="wrong inputs: fault raised, last output repeated")


class VerificationFile(Table):
    """Whether a C package computes what its block says."""

    schema_version: Literal[1]
    passed: bool = Field(description="whether everything that could be checked holds")
    package: str = Field(description="its name")
    provenance: dict[str, str] = Field(description="what it was made from")
    target: str = Field(description="host, or the processor")
    real: Literal["float", "double"] = Field(description="its precision")
    sample_time_s: Positive
    states: int = Field(ge=0, description="random states that were compared")
    host_compiler: str = Field(description="empty: none was found")
    host_flags: str
    max_difference: dict[str, NotNegative] = Field(
        description="of each state and output, from the block in double, in its unit"
    )
    units: dict[str, str] = Field(description="of these differences")
    max_relative_difference: NotNegative | None = Field(description="null: nothing was compared")
    faults_held: bool | None = Field(description="null: nothing was tried")
    on_target: TargetEntry | None = Field(description="null on the host, or without its tools")
    missing: list[str] = Field(description="tools that were not there, and how to install them")
