"""`Study`: what a sweep varies and how often, read from a TOML file with all of its problems
reported at once."""

from __future__ import annotations

import hashlib
import json
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    Field,
    PrivateAttr,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import CONTROLLERS, controller
from irb2400_ctrl.controllers.origin import other_arm
from irb2400_ctrl.controllers.parts import with_gains
from irb2400_ctrl.controllers.sampling import loop_remark
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.plausibility import plausibility
from irb2400_ctrl.reading import bounded_text, toml_tables
from irb2400_ctrl.robot import Robot, load_robot, robot_names
from irb2400_ctrl.simulation import Actuators, Sensors
from irb2400_ctrl.simulation.loop_request import controller_parameters
from irb2400_ctrl.sweep.motions import RandomPoses, StudyMotion
from irb2400_ctrl.sweep.quantities import FORMS, Deviations, EffectDraw, PayloadSpread, Spread
from irb2400_ctrl.table import Table
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import did_you_mean


def _robot(value: object, info: ValidationInfo) -> object:
    """The robot of a name or of a file relative to the study."""
    if not isinstance(value, str):
        return value
    folder = (info.context or {}).get("folder", Path())
    try:
        return load_robot(value if value in robot_names() else folder / value)
    except InputError as error:
        raise ValueError(str(error)) from error


AnyRobot = Annotated[Robot, BeforeValidator(_robot)]


class Control(Table):
    """A controller to compare: structure, wishes, gains, and the robot it believes in."""

    controller: str
    name: str = ""
    """how tables and figures call it; the controller's name if absent"""
    design: dict[str, float | tuple[float, ...]] = Field(default={})
    """wishes: bandwidth, damping …"""
    gains: dict[str, float | tuple[float, ...]] = Field(default={})
    """values of the controller's parameters"""
    knows: AnyRobot | None = None
    """robot that the controller is made from; the study's if absent"""

    @field_validator("controller")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in CONTROLLERS:
            raise ValueError(f"no controller {name!r}; expected one of {', '.join(CONTROLLERS)}")
        return name

    @property
    def label(self) -> str:
        """Name in tables and figures."""
        return self.name or self.controller

    def block(self, robot: Robot, rate: float) -> Block:
        """The controller as a block; InputError says what does not fit."""
        return controller(self.controller, self.knows or robot, 1.0 / rate, **self.design)

    def remarks(self, robot: Robot, rate: float) -> list[str]:
        """Of a law that is another arm's; what `codegen` says of a loop that is unstable on the arm
        that the controller knows."""

        def build(sample_time: float) -> Block:
            return with_gains(self.block(robot, 1.0 / sample_time), **self.gains)

        strange = other_arm(self.block(robot, rate), robot) if self.knows else ""
        said = (strange, loop_remark(self.knows or robot, build, 1.0 / rate))
        return [f"{self.label}: {remark}" for remark in said if remark]

    def problems(self, robot: Robot, rate: float) -> list[str]:
        """What does not fit."""
        try:
            block = self.block(robot, rate)
        except InputError as error:
            return [str(error)]
        found = []
        for name, value in self.gains.items():
            try:
                controller_parameters(block, {name: value})
            except InputError as error:
                found.append(str(error))
        return found


class SensorNoise(Table):
    """SensorNoise of the measuring chain, drawn for each plant; it is in the logs, not in the loop
    (as in `simulate`)."""

    torque_Nm: Spread = 0.0


class Study(Table):
    """A sweep: `draws` plants, each under every controller on every motion at every speed."""

    schema_version: Literal[1] = 1
    name: str = Field(min_length=1)
    robot: AnyRobot
    draws: int = Field(ge=1, le=1_000_000)
    seed: int = Field(ge=0)
    rate_Hz: float = Field(default=1000.0, gt=0)
    substeps: int | None = Field(default=None, ge=1, le=100)
    """time steps of the plant per period of the controllers; as `simulate` takes them if absent"""
    logs: bool = False
    """keep the log of every case, as the robot's data stream would give it"""
    plant: Deviations = Deviations()
    effects: tuple[EffectDraw, ...] = ()
    payload: PayloadSpread | None = None
    noise: SensorNoise = SensorNoise()
    sensors: Sensors = Sensors()
    actuators: Actuators = Actuators()
    controllers: tuple[Control, ...] = Field(min_length=1)
    motions: tuple[StudyMotion, ...] = Field(min_length=1)
    _text: str = PrivateAttr(default="")

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        problems = []
        for what, names in (
            ("controllers", [c.label for c in self.controllers]),
            ("motions", [m.name for m in self.motions]),
        ):
            doubles = sorted({name for name in names if names.count(name) > 1})
            problems += [
                f"{what}: two are called {name!r}; give each a name of its own" for name in doubles
            ]
        try:
            self.sensors.streamed(self.rate_Hz)
        except InputError as error:
            problems.append(str(error))
        for i, control in enumerate(self.controllers):
            problems += [
                f"controllers[{i + 1}]: {p}" for p in control.problems(self.robot, self.rate_Hz)
            ]
        for i, motion in enumerate(self.motions):
            problems += [f"motions[{i + 1}]: {p}" for p in motion.problems(self.robot)]
        for i, effect in enumerate(self.effects):
            problems += [f"effects[{i + 1}]: {p}" for p in effect.problems(self.robot.n)]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    @property
    def remarks(self) -> list[str]:
        """Controllers that are another arm's, or whose loop is unstable: their errors do not speak
        of the gains. A payload in grams or millimetres: its errors speak of nothing else."""
        found = [r for c in self.controllers for r in c.remarks(self.robot, self.rate_Hz)]
        if self.payload is not None:
            usual = plausibility(self.robot)
            loaded = plausibility(self.robot.with_effects(self.payload.largest))
            found += [f"payload (in kg and m): {note}" for note in loaded if note not in usual]
        return found

    @property
    def text(self) -> str:
        """The file as it was written."""
        return self._text

    @property
    def cases(self) -> int:
        """Number of runs."""
        return self.draws * len(self.controllers) * sum(len(m.speeds) for m in self.motions)

    @cached_property
    def fingerprint(self) -> str:
        """Changes with anything that results depend on, files it refers to included; not with
        comments."""
        # the derived model holds robots in full; trajectories are read into arrays
        parts = [self.model_dump_json().encode(), *(m.data() for m in self.motions)]
        return hashlib.sha256(b"\0".join(parts)).hexdigest()


@typed
def load_study(path: Path | str) -> Study:
    """Read a study; files that it names are relative to it.

    Raises:
        InputError: no such file, not TOML, or not a valid study; one line per problem.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"no study file {path}; expected a TOML file (see docs/sweep.md)")
    text = bounded_text(path, "a study (TOML)")
    try:
        tables = toml_tables(text, str(path), "a study (TOML)")
        study = Study.model_validate(tables, context={"folder": path.parent})
    except ValidationError as error:
        raise InputError(
            f"{path} is not a valid study:\n  " + "\n  ".join(_explain(error))
        ) from error
    study._text = text
    return study


def changed_keys(before: str, after: str) -> list[str]:
    """Top-level keys in which two study texts differ."""
    old = toml_tables(before, "the study before", "a study (TOML)")
    new = toml_tables(after, "the study", "a study (TOML)")
    missing = object()
    return [
        key
        for key in dict.fromkeys([*old, *new])
        if _json(old.get(key, missing)) != _json(new.get(key, missing))
    ]


def _json(value: object) -> str:
    return json.dumps(value, sort_keys=True, default=str)


def _explain(error: ValidationError) -> list[str]:
    lines = []
    items = error.errors()
    for item in items:
        if item["type"] == "too_short" and any(
            i["loc"][: len(item["loc"])] == item["loc"] and i is not item for i in items
        ):
            # the entries are there, but with problems of their own
            continue
        parts = [
            p
            for p in item["loc"]
            if p not in FORMS and not (isinstance(p, str) and _is_type_tag(p))
        ]
        place = "".join(f"[{p + 1}]" if isinstance(p, int) else f".{p}" for p in parts).lstrip(".")
        message = item["msg"].removeprefix("Value error, ")
        if item["type"] == "extra_forbidden":
            message = f"unknown key{did_you_mean(item['loc'][-1], _keys())}"
        elif item["type"] != "value_error" and not isinstance(
            item["input"], dict | list | BaseModel
        ):
            message += f", found {item['input']!r}"
        lines += [f"{place}: {line}" if place else line for line in message.splitlines()]
    return list(dict.fromkeys(lines))


def _is_type_tag(part: str) -> bool:
    # pydantic names the members of a union in the path: float, tuple[...], function-after[...]
    return part in {"float", "int"} or "[" in part


def _keys() -> list[str]:
    tables: list[type[BaseModel]] = [
        Study,
        Control,
        SensorNoise,
        Deviations,
        PayloadSpread,
        EffectDraw,
        StudyMotion,
        RandomPoses,
    ]
    tables += [Sensors, Actuators]
    return sorted({key for table in tables for key in table.model_fields})
