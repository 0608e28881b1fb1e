"""Arguments held against the types that a function states: another one is refused by its name."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping
from functools import wraps
from numbers import Integral, Real
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from irb2400_ctrl.errors import InputError

Callee = TypeVar("Callee", bound=Callable[..., Any])

MADE_BY = {
    "Block": '`controller("pid", robot)`; a law in plain Python: docs/control.md',
    "CamProgram": '`read_program("part.apt")`',
    "Cell": '`load_cell("cell.toml")`',
    "Certificate": "`plan.certificate`",
    "Diagnosis": "`diagnose(robot, log)`",
    "Identification": "`identify(robot, logs)`",
    "Log": '`read_log("log.csv")`',
    "Model": "`Model(robot)`",
    "MotionLimits": "`MotionLimits.of(robot)`",
    "PathDynamics": "`path_dynamics(robot)`",
    "Plan": "`plan_path(robot, path)`",
    "Robot": '`load_robot("irb2400")`, which takes the path of a robot file, too',
    "Simulation": '`simulate(robot, trajectory, "pid")`',
    "Study": '`load_study("study.toml")`',
    "ToolPath": '`read_path("part.apt")`, or one of `builders`',
    "Trajectory": "`plan.trajectory`, or `from_angles(time, q)`",
}
"""type -> how one comes by it; of others it is said what they are made of"""


class _Numbers:
    """Stands for the types of arrays in annotations: whatever numpy takes for numbers."""


_ARRAYS = {"Array": _Numbers, "ArrayLike": _Numbers}
_WORDS: dict[object, str] = {
    _Numbers: "numbers",
    bool: "True or False",
    float: "a number",
    int: "a whole number",
    NoneType: "None",
    str: "text",
    Path: "a path",
}
_SHOWN = (str, bytes, bool, int, float, np.number, os.PathLike, NoneType)


def typed(made: Callee) -> Callee:
    """The function, or the class, which refuses what is of none of the types that it states.

    Held are the project's types, numbers, arrays, text, paths, literals, and lists of these; what
    nothing can be asked of (`Any`, a protocol) passes. Shapes, signs and units are for the function
    itself.

    Raises:
        InputError: when called, by the argument's name: what was found, what was expected.
    """
    if isinstance(made, type):
        made.__init__ = typed(made.__init__)  # type: ignore[misc]
        return made
    signature = inspect.signature(made)
    stated: dict[str, Any] = {}

    @wraps(made)
    def called(*args: Any, **kwargs: Any) -> Any:
        # only now: an annotation may name what stands further down in its module
        stated.update(stated or _stated(made, signature))
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError:
            # Python's own words name the function
            return made(*args, **kwargs)
        for name, value in given.items():
            if name in stated and not _fits(value, stated[name]):
                expected = _in_words(stated[name])
                raise InputError(f"{name}: found {_found(value)}, expected {expected}")
        return made(*args, **kwargs)

    return called  # type: ignore[return-value]


def _stated(made: Callable[..., Any], signature: inspect.Signature) -> dict[str, Any]:
    """The annotation of each argument, resolved; without those that stand for any number of them"""
    hints = get_type_hints(made, localns=_ARRAYS)
    several = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    single = [p.name for p in signature.parameters.values() if p.kind not in several]
    return {name: hints[name] for name in single if name in hints}


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value is what a resolved annotation says."""
    origin = get_origin(kind)
    parts = get_args(kind)
    if origin in (Union, UnionType):
        return any(_fits(value, part) for part in parts)
    if origin is Literal:
        return isinstance(value, str) and value in parts
    if kind is _Numbers or origin is np.ndarray:
        return _are_numbers(value)
    if kind in (float, int, bool):
        return _is_number(value, kind)
    if kind is Path:
        return isinstance(value, os.PathLike)
    if origin is Callable:
        return callable(value)
    if inspect.isclass(origin):
        return _holds(value, origin, parts)
    if kind is Any or not inspect.isclass(kind) or getattr(kind, "_is_protocol", False):
        return True
    return isinstance(value, kind)


def _is_number(value: Any, kind: type) -> bool:
    """Whether a value is one number of that kind; NaN is none."""
    value = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
    if kind is bool or isinstance(value, bool | np.bool_):
        return kind is bool and isinstance(value, bool | np.bool_)
    return isinstance(value, Integral if kind is int else Real) and bool(value == value)


def _are_numbers(value: Any) -> bool:
    """Whether numpy takes it for numbers, as it does None."""
    try:
        np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return False
    return value is not None


def _holds(value: Any, origin: type, parts: tuple[Any, ...]) -> bool:
    """Whether a value is that container; a list or an array may stand for any sequence."""
    if isinstance(value, str | bytes):
        return False
    if not isinstance(value, list | tuple) or issubclass(origin, Mapping):
        return isinstance(value, origin | np.ndarray)
    one = {part for part in parts if part is not Ellipsis}
    return len(one) != 1 or all(_fits(v, next(iter(one))) for v in value)


def _found(value: Any) -> str:
    """A value in words: itself where it is short, otherwise what it is."""
    if isinstance(value, _SHOWN):
        return f"{value!r:.60}"
    if isinstance(value, type):
        return f"the class {value.__name__} itself"
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    if isinstance(value, list | tuple) and any(v != v for v in value if isinstance(v, float)):
        return f"{value!r:.60}"
    inside = sorted({type(v).__name__ for v in value}) if isinstance(value, list | tuple) else ()
    return f"a {type(value).__name__}" + (f" of {', '.join(inside)}" if inside else "")


def _in_words(kind: Any) -> str:
    """A resolved annotation in words, and how one comes by what it names."""
    origin = get_origin(kind)
    parts = [part for part in get_args(kind) if part is not Ellipsis]
    if origin in (Union, UnionType):
        if Path in parts:
            parts.remove(str)
        several = [p for p in parts if len(get_args(p)) == 1 and get_args(p)[0] in parts]
        named = [_in_words(part) for part in parts if part not in several]
        return " or ".join(named + ["several"] * bool(several))
    if origin is Literal:
        return " or ".join(parts)
    if origin is np.ndarray:
        return _WORDS[_Numbers]
    if origin in (Callable, Mapping):
        return "a function" if origin is Callable else "a dict"
    if origin is not None:
        return f"a sequence of {', '.join(dict.fromkeys(map(_in_words, parts)))}"
    if kind in _WORDS:
        return _WORDS[kind]
    name = getattr(kind, "__name__", str(kind))
    if name in MADE_BY:
        return f"a {name} ({MADE_BY[name]})"
    return f"{name}({', '.join(getattr(kind, '__annotations__', ()))})"
