"""Joints by words that are neither the robot's names nor numbers: `Base pos [rad]`, `Shoulder pos
[rad]`… beside `Base torque [Nm]`…."""

from __future__ import annotations

import re
from collections.abc import Iterable

FEWEST = 4
_CUT = re.compile(r"[ _./:-]")
Form = tuple[str, str]


def worded(names: Iterable[str], joints: int | None) -> dict[Form, list[str]]:
    """What stands before and behind such words, and the names in the order of the file: forms of
    which another one has the same words. Words in the order of the alphabet tell none of joints.
    """
    forms: dict[Form, dict[str, str]] = {}
    for name in names:
        for cut in _CUT.finditer(name):
            forms.setdefault(("", name[cut.start() :]), {})[name[: cut.start()]] = name
            forms.setdefault((name[: cut.end()], ""), {})[name[cut.end() :]] = name
    words = {form: tuple(of_words) for form, of_words in forms.items()}
    found = list(words.values())
    return {
        form: list(of_words.values())
        for form, of_words in forms.items()
        if (len(of_words) == joints if joints else len(of_words) >= FEWEST)
        and found.count(words[form]) > 1
        and list(words[form]) != sorted(words[form])
    }
