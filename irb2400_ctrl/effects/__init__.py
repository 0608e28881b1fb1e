"""Physical effects that the base model may lack, one file each; users' own beside them."""

from __future__ import annotations

import importlib
import pkgutil
from typing import Annotated, Any

from pydantic import BeforeValidator, SerializeAsAny

from irb2400_ctrl.effects import registry
from irb2400_ctrl.effects.ambiguity import Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.registry import load_effects, users_files
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.transmission import Transmission
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed

# a file in this folder is enough: its classes register themselves
for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

LIBRARY: dict[str, type[Effect]] = registry.LIBRARY
"""kind -> class, the library's own and the user's, in the order of the kinds"""


@typed
def effect_class(kind: object) -> type[Effect]:
    """The class of a kind.

    Raises:
        InputError: not defined; lists what is.
    """
    found: type[Effect] = registry.effect_class(kind)
    return found


def _of_its_kind(value: Any) -> Any:
    """A table of a file as the effect that its `kind` names."""
    if not isinstance(value, dict):
        return value
    try:
        return effect_class(value.get("kind")).model_validate(value)
    except InputError as error:
        raise ValueError(str(error)) from error


AnyEffect = Annotated[SerializeAsAny[Effect], BeforeValidator(_of_its_kind)]
"""what a robot file may hold under [[effects]]: any kind of `LIBRARY`"""

__all__ = [
    "LIBRARY",
    "Ambiguity",
    "AnyEffect",
    "Drawing",
    "Effect",
    "Prior",
    "Search",
    "Signals",
    "Transmission",
    "effect_class",
    "load_effects",
    "users_files",
]
