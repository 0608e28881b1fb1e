"""Names of a package that are imported when they are first used (PEP 562)."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Callable, Mapping
from typing import Any


def lazily(package: str, places: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package.

    Args:
        package: its `__name__`.
        places: name -> module below the package that holds it, "" for a module of that name.
    """

    def __getattr__(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module = importlib.import_module(f"{package}.{places[name] or name}")
        found = getattr(module, name) if places[name] else module
        # the next use finds it without a detour
        setattr(sys.modules[package], name, found)
        return found

    return __getattr__


def no_longer_promised(package: str, places: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package whose names were promised in 0.2 and go with 0.4, with a
    `DeprecationWarning` that says where they are.

    Args:
        package: its `__name__`.
        places: name -> module below the package that holds it, with a colon and its name there
            where that is another.
    """

    def __getattr__(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        place, _, called = places[name].partition(":")
        warnings.warn(
            f"{package}.{name} is no longer promised and goes with version 0.4; it is "
            f"{called or name} of {package}.{place}",
            DeprecationWarning,
            stacklevel=2,
        )
        return getattr(importlib.import_module(f"{package}.{place}"), called or name)

    return __getattr__
