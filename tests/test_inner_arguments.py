"""Inner functions with three and more arguments that do not say what each of them is: ever fewer.

What the packages promise is held whole by `test_argument_sections.py`; here are all others whose
names do not begin with an underscore. A method that says nothing of its own says what the one it
overrides says.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from test_argument_sections import unsaid

import irb2400_ctrl as irb

LEFT = 190
"""functions of all that still do not; write the number down whenever it falls"""


def functions() -> Iterator[tuple[str, Callable[..., Any]]]:
    """All that is defined under a public name; commands apart: their options say it."""
    for found in pkgutil.walk_packages(irb.__path__, "irb2400_ctrl."):
        parts = found.name.split(".")
        if any(part.startswith("_") for part in parts) or parts[1] == "cli":
            continue
        module = importlib.import_module(found.name)
        for name, thing in vars(module).items():
            if name.startswith("_") or getattr(thing, "__module__", "") != found.name:
                continue
            if inspect.isfunction(thing):
                yield f"{found.name}.{name}", thing
            elif inspect.isclass(thing):
                for own, member in vars(thing).items():
                    inner = getattr(member, "__func__", member)
                    if inspect.isfunction(inner) and not own.startswith("_"):
                        yield f"{found.name}.{name}.{own}", inner


@cache
def silent() -> list[str]:
    return sorted({name for name, one in functions() if unsaid(one)})


def test_ever_fewer_functions_keep_their_arguments_to_themselves() -> None:
    count = len(silent())
    assert count <= LEFT, f"{count} now: say the arguments of what was added to {silent()}"
    # a number that is too large would let new ones in
    assert count == LEFT, f"{count} are left, fewer than {LEFT}: write it down here"


def test_most_of_them_are_looked_at() -> None:
    many = [name for name, one in functions() if len(inspect.signature(one).parameters) > 2]
    assert len(many) > 400
