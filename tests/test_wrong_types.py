"""What is of another type is refused by every promised function: what was found, what to give."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl import codegen, controllers, excitation, planners, watch
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs import egm
from irb2400_ctrl.planners.programs.egm import EgmFollower
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_plan
from irb2400_ctrl.typed import MADE_BY, typed

ROOMS = [
    importlib.import_module(found.name)
    for found in pkgutil.iter_modules(irb.__path__, "irb2400_ctrl.")
    # what reads a file for the others, and walks over expressions for them
    if found.ispkg and found.name.rpartition(".")[2] not in ("cli", "reading", "symbolic")
]
NOUNS = (
    irb.Model,
    irb.Trajectory,
    controllers.Timing,
    codegen.Field,
    codegen.Package,
    excitation.Budget,
    EgmFollower,
    planners.LinkOptions,
    planners.MotionLimits,
    planners.RapidOptions,
    planners.ToolPath,
    watch.Watch,
)
OF_ANYTHING = {"effect_class"}
"""refuses in its own words: it is asked for whatever a file says"""


class Stranger:
    """What no function takes."""


def verbs() -> Iterator[tuple[str, Callable[..., Any]]]:
    for room in [*ROOMS, planners.builders]:
        for name in getattr(room, "__all__", vars(room)):
            found = getattr(room, name)
            home = room.__name__ if room is planners.builders else "irb2400_ctrl"
            its_own = getattr(found, "__module__", "").startswith(home)
            if name[0] != "_" and its_own and inspect.isfunction(inspect.unwrap(found)):
                yield name, found
    for noun in NOUNS:
        yield noun.__name__, noun


VERBS = {name: found for name, found in verbs() if inspect.signature(found).parameters}


@pytest.mark.parametrize("name", sorted(set(VERBS) - OF_ANYTHING))
def test_a_stranger_is_refused_by_the_name_of_the_argument(name: str) -> None:
    parameters = inspect.signature(VERBS[name]).parameters.values()
    needed = [p.name for p in parameters if p.default is p.empty and p.kind not in (2, 4)]
    first = (needed or [next(iter(parameters)).name])[0]
    with pytest.raises(InputError, match=rf"^{first}: found a Stranger, expected "):
        VERBS[name](**{argument: Stranger() for argument in needed or [first]})


ARM = irb.load_robot("irb2400")
MODEL = irb.Model(ARM)
ZERO = np.zeros(6)
MOTION = irb.trajectory.from_angles([0.0, 0.5, 1.0], np.outer([0.0, 0.1, 0.2], np.ones(6)))
LINE = planners.builders.line((1.0, 0.0, 0.9), (1.0, 0.04, 0.9), feed=0.05)
RIPPLE = irb.effects.LIBRARY["gear_ripple"]
WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "a name": (lambda: irb.plan_path("irb2400", LINE), r"^robot: found 'irb2400', .*load_robot\("),
    "a file": (lambda: irb.plan_path(ARM, "a.apt"), r"^path: found 'a.apt', .*read_path\("),
    "a robot for its model": (
        lambda: planners.joint_move(ARM, ZERO, ZERO),
        r"^model: found a Robot, expected a Model \(`Model\(robot\)`\)",
    ),
    "a class": (lambda: irb.Model(irb.Robot), "^robot: found the class Robot itself"),
    "nothing": (lambda: irb.read_log(None), "^path: found None, expected a path$"),
    "a word for a choice": (
        lambda: irb.plan_path(ARM, LINE, free_tool_rotation="no"),
        "^free_tool_rotation: found 'no', expected True or False$",
    ),
    "one that is none": (
        lambda: irb.plan_path(ARM, LINE, timing="fast"),
        "^timing: found 'fast', expected certified or toppra$",
    ),
    "one among logs": (
        lambda: irb.identify(ARM, ["a.csv"]),
        r"^logs: found a list of str, expected a Log .* or several$",
    ),
    "options in a dict": (
        lambda: irb.simulate(ARM, MOTION, "pid", sensors={"rate_Hz": 1}),
        r"^sensors: found a dict, expected Sensors\(encoder_step_rad, ",
    ),
    "no number": (
        lambda: irb.controllers.guarded(
            irb.controllers.controller("pid", ARM), ARM, start_time=np.nan
        ),
        "^start_time: found nan, expected a number",
    ),
    "half a step": (lambda: irb.simulate(ARM, MOTION, "pid", seed=0.5), "^seed: found 0.5"),
    "a list of gains": (
        lambda: irb.simulate(ARM, MOTION, "pid", gains=[1]),
        "^gains: found a list",
    ),
    "no effect": (lambda: ARM.with_effects(None), r"^Robot: found effects.0 = None"),
    "an axis too many": (
        lambda: ARM.with_effects(RIPPLE.of(9, amplitude_Nm=5.0, order=12.0)),
        "^Robot: effects: gear_ripple on joint 9",
    ),
    "a field without its unit": (
        lambda: RIPPLE.of(4, amplitude=5.0, order=12.0),
        "^GearRipple: found no amplitude_Nm .*it has .*amplitude_Nm",
    ),
    "friction of no joint": (lambda: ARM.with_unknown_friction([7]), r"^of: found \[7\]"),
    "limits of another arm": (
        lambda: irb.plan_path(ARM, LINE, limits=planners.MotionLimits(*np.ones((3, 7)))),
        r"^limits: found qd_max of shape \(7,\), expected \(6,\)",
    ),
    "a curve of numbers": (
        lambda: planners.builders.curve(lambda t: t),
        r"^curve: position\(t\) has shape \(65,\)",
    ),
    "a seed in words": (
        lambda: MODEL.inverse_kinematics_branches(np.eye(4)[None], "home"),
        "^seed: found 'home'",
    ),
    "a torque in words": (
        lambda: MODEL.forward_dynamics(ZERO, ZERO, ["a"] * 6, wrench=ZERO),
        "^tau: found",
    ),
    "a place in words": (lambda: MODEL.smallest_singular_value("home"), "^q: found 'home'"),
    "a motion for what follows it": (lambda: egm.stream(MOTION), "^follower: found a Trajectory"),
    "a motion for its plan": (lambda: rapid_of_plan(MOTION), "^plan: found a Trajectory"),
    "several functions": (lambda: MODEL.function(["gravity"]), "^name: found a list of str"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_was_found_and_how_to_come_by_the_other_is_said(name: str) -> None:
    call, says = WRONG[name]
    with pytest.raises(InputError, match=says):
        call()


def test_what_numpy_takes_for_numbers_passes() -> None:
    rows = np.asfortranarray(np.outer([0.0, 0.1, 0.2], np.ones(6)))
    rows.setflags(write=False)
    motion = irb.trajectory.from_angles((0, 1, 2), rows)
    assert irb.simulate(ARM, motion, "pid", rate=np.int64(100), hold=np.float32(0.5)).seed == 0
    assert planners.joint_move(MODEL, [0] * 6, np.ones(6, dtype=int), rate=np.float32(250)).q.any()


def test_how_one_comes_by_a_type_names_what_there_is() -> None:
    for kind, how in MADE_BY.items():
        first, *rest = re.findall(r"[\w.]+", how)[0].split(".")
        named = [getattr(room, first) for room in [irb, *ROOMS] if hasattr(room, first)]
        fields = {f.name for f in dataclasses.fields(planners.Plan)}
        assert named or (first == "plan" and set(rest) <= fields), how
        assert any(hasattr(room, kind) for room in [irb, *ROOMS]) or kind == "PathDynamics", kind


def test_no_number_among_numbers_is_shown() -> None:
    """It was "found a tuple of float, int"."""
    with pytest.raises(InputError, match=r"^centre: found \(0.95, 0, nan\), expected a sequence"):
        irb.planners.builders.circle((0.95, 0, float("nan")), 0.15, feed=0.1)


def test_a_missing_argument_is_said_in_the_words_of_python() -> None:
    with pytest.raises(TypeError, match=r"plan_path\(\) missing 1 required .*'path'"):
        irb.plan_path(ARM)


def test_an_annotation_may_be_anything() -> None:
    @typed
    def held(
        a: Any, b: type[Path] | None = None, *c: int, d: tuple[float, ...] = (), **e: str
    ) -> int:
        return len(c)

    assert held(3, Path, "x", d=[1, 2], f=3) == 1
    with pytest.raises(
        InputError, match=r"^d: found a list of str, expected a sequence of a number"
    ):
        held(3, d=["x"])


def test_a_field_that_is_refused_is_a_value_error_as_well() -> None:
    """As pydantic's own refusal, which scripts catch."""
    for refused in (
        lambda: RIPPLE.of(4, amplitude=5.0),
        lambda: ARM.model_copy(update={"toool": 1}),
    ):
        with pytest.raises(ValueError, match=r"^\w+: found ") as caught:
            refused()
        assert isinstance(caught.value, irb.errors.InputError)
