"""`identification.json`, `covariance.json` and `validation.json`: their keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irb2400_ctrl.formats.findings_file import ErrorsEntry
from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table

Triple = tuple[float, float, float]
Inertia = tuple[float, float, float, float, float, float]


class ExtraEntry(Table):
    """An effect whose numbers were fitted along."""

    kind: str = Field(description="of its numbers: `KIND_JOINT …` in `numbers`")
    joint: int | None = Field(description="counted from 1; null: the whole arm")
    effect: str | None = Field(
        default=None,
        description="in robot.toml: `irb2400 explain EFFECT` says what it is; null: friction",
    )
    ratios: tuple[float, float] | None = Field(
        default=None,
        description="turns of a motor per turn of the axis before and of the one before that [-]",
    )


class ScalarChangeEntry(Table):
    """A number in the file and as identified."""

    before: float
    after: float


class CentreChangeEntry(Table):
    """A centre of mass in the file and as identified."""

    before: Triple
    after: Triple


class InertiaChangeEntry(Table):
    """Inertia about the centre of mass, in the file and as identified."""

    before: Inertia
    after: Inertia


class MovedEntry(Table):
    """A link, the last one with the tool in it."""

    link: int = Field(ge=1, description="counted from 1")
    furthest: str = Field(description="its number that moved most")
    sigmas: float = Field(description="how far that moved, over what the file leaves open")
    mass_kg: ScalarChangeEntry
    com_m: CentreChangeEntry
    inertia_kgm2: InertiaChangeEntry
    not_the_files: bool = Field(description="whether it is another body than the file's")


class IdentifiedEntry(Table):
    """A number of the model."""

    value: float
    standard_error: NotNegative


class VerdictEntry(Table):
    """What the motions can tell of a number, before anything is fitted."""

    name: str
    verdict: Literal["identifiable", "weak", "not identifiable", "unknown"]
    error_over_size_that_matters: NotNegative | None = Field(description="null: it is not seen")
    stands_for: str = Field(description="the sum of numbers that it is; empty for one by itself")
    reason: str = Field(description="why it is not identifiable; empty where it is")
    motion_that_would_help: str


class FrictionErrorsEntry(Table):
    """Standard errors of a friction law; null where the runs do not show the number."""

    static_Nm: NotNegative | None
    coulomb_Nm: NotNegative | None
    viscous_Nms_rad: NotNegative | None
    stribeck_rad_s: NotNegative | None


class FrictionPointEntry(Table):
    """Friction at one constant speed, both ways (eq. 73)."""

    speed_rad_s: Positive
    friction_Nm: float
    standard_error_Nm: NotNegative


class FrictionRunsEntry(Table):
    """The law of a joint through its runs at constant speed (eq. 74); null: not shown by them."""

    joint: int = Field(ge=1, description="counted from 1")
    static_Nm: float | None
    coulomb_Nm: float | None
    viscous_Nms_rad: float | None
    stribeck_rad_s: float | None
    standard_errors: FrictionErrorsEntry
    left_out_rad_s: list[float] = Field(description="runs that stick and slip")
    points: list[FrictionPointEntry]


class SensedErrorsEntry(Table):
    """Standard errors of the body."""

    mass_kg: NotNegative
    com_m: list[NotNegative]
    inertia_about_flange_kgm2: list[NotNegative]


class ForceSensorEntry(Table):
    """The body that a force sensor carries."""

    mass_kg: Positive
    com_m: Triple = Field(description="centre of mass, in the flange")
    inertia_kgm2: Inertia = Field(description="about the centre of mass")
    standard_errors: SensedErrorsEntry
    sensor_zero: list[float] = Field(description="force [N], torque [Nm] that it shows unloaded")


class GainsEntry(Table):
    """Factors of the torque channels, a number a joint."""

    source: Literal["known load", "other joints", "robot file"] = Field(
        default="known load",
        description="known load: weighed; other joints: over the middle one, of the bodies that "
        "all feel; robot file: as it states them",
    )
    gain: list[float] = Field(description="reported over true torque")
    standard_error: list[float | None]
    known: list[bool] = Field(description="whether the standard error is at most 0.05")


class LateEntry(Table):
    """A log whose torques were recorded later than its angles."""

    name: str = Field(description="of the log")
    delay_s: float = Field(description="how much later; below zero: earlier")
    standard_error_s: NotNegative


class ModelsEntry(Table):
    """A log against the models."""

    before: ErrorsEntry = Field(description="the robot as given")
    fitted: ErrorsEntry = Field(description="the robot identified from all logs")
    unseen: ErrorsEntry = Field(description="a fit that had not seen the stretch it predicts")
    plain: ErrorsEntry = Field(description="plain least squares on the same stretches")


class IdentifiedLogEntry(Table):
    """A log that was used or judged."""

    name: str
    role: Literal["identification", "validation"]
    error: ModelsEntry


class IdentificationFile(Table):
    """Numbers of an arm from its logs."""

    schema_version: Literal[1]
    robot: str = Field(description="its name")
    motion_from: Literal["angle", "speed"] = Field(
        description="column that speed and acceleration were taken from"
    )
    notes: list[str] = Field(description="what a reader should know, in words")
    of_bodies: list[str] = Field(
        default_factory=list,
        description="whether the file's are borne out, in words; empty in files from before that",
    )
    extras: list[ExtraEntry] = Field(description="effects that were fitted along")
    residual_Nm: list[NotNegative] = Field(description="rms torque that is left of each joint")
    samples_per_independent_one: float = Field(ge=1, description="samples that say the same thing")
    moved: list[MovedEntry] = Field(description="every link")
    numbers: dict[str, IdentifiedEntry] = Field(description="Ixx_3, Fc_2, …; SI")
    identifiability: list[VerdictEntry]
    friction_runs: list[FrictionRunsEntry] = Field(description="empty without such runs")
    force_sensor: ForceSensorEntry | None = Field(description="null without its columns")
    late_torques: list[LateEntry] = Field(
        default_factory=list, description="logs whose torques were taken earlier"
    )
    gains: GainsEntry | None = Field(description="null: all are taken to read alike")
    logs: list[IdentifiedLogEntry]


class CovarianceFile(Table):
    """How surely the numbers of identification.json are known, together."""

    schema_version: Literal[1]
    names: list[str] = Field(description="of the numbers, as in identification.json")
    covariance: list[list[float]] = Field(description="a row a number, in their units")


class ValidatedLogEntry(Table):
    """A log that was predicted."""

    name: str
    error: ErrorsEntry
    remarks: list[str] = Field(description="what to know of how it was recorded")


class ValidationFile(Table):
    """Modelled against measured torque (eqs. 75-77)."""

    schema_version: Literal[1]
    robot: str = Field(description="its name")
    log: str = Field(description="names of the logs")
    samples: list[int] = Field(description="of each joint that count")
    error: ErrorsEntry = Field(description="over all logs")
    logs: list[ValidatedLogEntry]
