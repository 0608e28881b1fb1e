"""Every promised function with three and more arguments says what each of them is."""

from __future__ import annotations

import inspect
import re
import types
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import irb2400_ctrl as irb


def promised() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Functions of every package's `__all__`, and methods of its classes."""
    for room in irb.__all__:
        package = getattr(irb, room)
        if not isinstance(package, types.ModuleType):
            continue
        for name in getattr(package, "__all__", ()):
            found = getattr(package, name)
            if inspect.isfunction(found):
                yield f"{room}.{name}", found
            elif inspect.isclass(found):
                for own, member in vars(found).items():
                    if inspect.isfunction(member) and not own.startswith("_"):
                        yield f"{room}.{name}.{own}", member


def unsaid(function: Callable[..., Any]) -> list[str]:
    """Arguments that its section does not name."""
    arguments = list(inspect.signature(function).parameters.values())
    arguments = [one for one in arguments if one.name not in {"self", "cls"}]
    if len(arguments) < 3:
        return []
    text = inspect.getdoc(function) or ""
    section = re.search(r"^Args:\n((?:    .*\n?|\n)+)", text, re.MULTILINE)
    said = section[1] if section else ""
    return [one.name for one in arguments if not re.search(rf"\b{one.name}\b", said)]


FUNCTIONS = dict(promised())


def test_there_are_many() -> None:
    assert sum(len(inspect.signature(one).parameters) > 2 for one in FUNCTIONS.values()) > 50


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_argument_is_said(name: str) -> None:
    assert unsaid(FUNCTIONS[name]) == []


def test_what_is_not_said_is_found() -> None:
    def f(a: float, b: float, c: float) -> None:
        """First.

        Args:
            a, b: lengths [m].
        """

    assert unsaid(f) == ["c"]
    f.__doc__ = "First."
    assert unsaid(f) == ["a", "b", "c"]
