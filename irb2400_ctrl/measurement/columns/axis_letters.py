"""Axes that are called by letters: S, L, U, R, B, T from the base to the flange (Yaskawa), and E,
which turns the lower arm of an arm of seven."""

from __future__ import annotations

import re
from collections.abc import Iterable

SIX = "SLURBT"
SEVEN = "SLEURBT"
_LETTER = re.compile(r"(?<![A-Za-z0-9])[SLEURBT](?![A-Za-z0-9])")


def lettered(names: Iterable[str]) -> dict[tuple[str, str], list[str]]:
    """What stands before and behind the letters of names that all axes have, and these names in the
    order of the axes."""
    forms: dict[tuple[str, str], dict[str, str]] = {}
    for name in names:
        for found in _LETTER.finditer(name):
            form = name[: found.start()], name[found.end() :]
            forms.setdefault(form, {})[found[0]] = name
    return {
        form: [of_axes[axis] for axis in (SEVEN if "E" in of_axes else SIX)]
        for form, of_axes in forms.items()
        if of_axes.keys() >= set(SIX)
    }


def numbered(names: Iterable[str]) -> dict[str, str]:
    """Every name, and the same with `J1`… in the place of such a letter."""
    told = {name: name for name in names}
    for (before, behind), of_axes in lettered(told).items():
        told |= {name: f"{before}J{j}{behind}" for j, name in enumerate(of_axes, 1)}
    return told
