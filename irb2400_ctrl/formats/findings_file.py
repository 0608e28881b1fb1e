"""`findings.json`: its keys."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from irb2400_ctrl.robot.numbers import NotNegative
from irb2400_ctrl.table import Table

List = Literal["lacks", "special", "changed"]
_LIST = (
    "lacks: every robot has it and the file does not state it; special: of this arm; changed: "
    "since the reference"
)


class ErrorsEntry(Table):
    """Errors of the predicted torque (eqs. 75-77), a number a joint."""

    mae_Nm: list[NotNegative] = Field(description="mean of the absolute error")
    rmse_Nm: list[NotNegative] = Field(description="root of the mean square error")
    rmse_over_mean_percent: list[NotNegative] = Field(
        description="that over the mean absolute torque"
    )


class LogErrorsEntry(Table):
    """A log with the robot as given, with the numbers that explain it best without further
    effects, and with what was found."""

    before: ErrorsEntry
    recalibrated: ErrorsEntry
    after: ErrorsEntry


class AllErrorsEntry(Table):
    """Errors before and after."""

    identification: LogErrorsEntry = Field(description="on the log it was found on")
    validation: LogErrorsEntry | None = None
    validation_noise_floor_Nm: list[NotNegative] | None = Field(
        default=None, description="the same of the validation log"
    )
    noise_floor_Nm: list[NotNegative] = Field(
        description="what a perfect model would leave of each joint"
    )
    sample_noise_Nm: list[NotNegative] | None = None


class BodyErrorsEntry(Table):
    """Standard errors of a body."""

    mass_kg: float
    com_m: list[float]


class BodyEntry(Table):
    """A body that was found."""

    mass_kg: float
    com_m: list[float] = Field(description="centre of mass")
    radius_of_gyration_m: float
    standard_errors: BodyErrorsEntry


class BodiesEntry(Table):
    """A body beside an uncertain arm, and beside the arm of the file."""

    robust: BodyEntry
    given_bodies: BodyEntry


class EffectEntry(Table):
    """An effect that the robot has and its model lacked."""

    kind: str = Field(description="`irb2400 explain KIND` says what it is")
    joint: int | None = Field(description="counted from 1; null: the whole arm")
    which: List = Field(alias="list", description=_LIST)
    parameters: dict[str, Any] = Field(description="as in a robot file; the unit is in the name")
    standard_errors: dict[str, Any] = Field(description="of the parameters")
    confidence: float = Field(ge=0, le=1, description="probability that kind and joint are right")
    alternatives: list[str] = Field(description="kinds that the log cannot exclude")
    sentence: str = Field(description="in words")
    measure_next: str = Field(description="what would exclude the alternatives; empty without any")
    log_evidence: float = Field(description="gain of the explanation [nats]")
    margin: float = Field(description="over the best other explanation [nats]")
    validation_gain_percent: float | None = None
    share_of_torque: list[NotNegative] = Field(description="rms over that of each joint's torque")
    body: BodiesEntry | None = None


class NumberEntry(Table):
    """A number of the model that this arm has otherwise, or that its file lacks."""

    which: List = Field(alias="list", description=_LIST)
    place: str = Field(description="joint 2, link 3, tool")
    name: str = Field(description="with its unit")
    before: float | None = Field(description="null: the file does not state it")
    after: float
    standard_error: float = Field(description="of after")
    sigmas: float = Field(description="the change over what the file leaves open")


class UnexplainedEntry(Table):
    """A torque that no effect of the library makes."""

    joint: int = Field(ge=1, description="counted from 1")
    depends_on: list[str] = Field(description="signals, such as q4 or qd4")
    rmse_Nm: NotNegative = Field(description="its size")
    confidence: float = Field(ge=0, le=1, description="that it is there")
    description: str = Field(description="in words")


class BeforeAfterEntry(Table):
    """Of one of several logs."""

    before: ErrorsEntry
    after: ErrorsEntry


class LogEntry(Table):
    """A log that was used or judged."""

    log: str
    used: bool = Field(description="whether effects were looked for on it")
    starts_s: float | None = Field(description="in the joined record; null where it is not in it")
    error: BeforeAfterEntry


class LeftOutEntry(Table):
    """A log that could not be used."""

    log: str
    why: str


class ProblemEntry(Table):
    """Why a log was not understood."""

    kind: str
    says: str = Field(description="in words")
    fits: dict[str, Any] = Field(description="what would fit")
    joints: list[int] | None = None


class ReferenceEntry(Table):
    """What the reference's logs showed already."""

    logs: list[LogEntry]
    left_out: list[LeftOutEntry]
    effects: list[EffectEntry]
    unexplained: list[UnexplainedEntry]
    numbers: list[NumberEntry]


class FindingsFile(Table):
    """What a log shows that the model lacks."""

    schema_version: Literal[2]
    verdict: Literal["explained", "nothing_missing", "unexplained", "log_not_understood"]
    log_problem: ProblemEntry | None = None
    effects: list[EffectEntry]
    numbers: list[NumberEntry]
    recalibrated: dict[str, Any] = Field(description="terms with new values, a value a joint; SI")
    unexplained: list[UnexplainedEntry]
    beyond_noise: list[int] = Field(description="joints on which more than noise is left")
    taken_up: list[int] = Field(
        default_factory=list,
        description="joints that are not as the reference, or the arm's identified file, has them, "
        "by numbers that it leaves open",
    )
    error: AllErrorsEntry
    not_excited: list[int] = Field(description="joints that hardly moved: nothing is said of them")
    weak: list[str] = Field(description="why the answer is weaker than usual")
    against: Literal["reference", "file"] = Field(description="what the log was held against")
    reference: ReferenceEntry | None = None
    log: str = Field(description="the log it was found on")
    logs: list[LogEntry]
    left_out: list[LeftOutEntry]
    validation_log: str | None = Field(description="the other motion; null without one")
