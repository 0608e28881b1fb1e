"""What is of another type is refused by every promised function: what was found, what to give."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import irb2400_ctrl as irb
from irb2400_ctrl import codegen, controllers, excitation, planners, watch
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm import EgmFollower

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
