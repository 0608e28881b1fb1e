"""An effect in words: all that its class says of itself, for whoever meets its name in a report.

Everything comes from the effect's own frozen values, so a user's own effect explains itself too.
"""

from __future__ import annotations

import inspect
import re
import shlex
import textwrap
from typing import Any

from irb2400_ctrl.effects import LIBRARY, Ambiguity, Effect, effect_class
from irb2400_ctrl.effects.base import COMMON

PLACES = {
    "force": "on the arm, as a force",
    "parameters": "on the arm's own parameters (mass, centre of mass, inertia)",
    "measurement": "in the measuring chain; the arm itself is not changed",
    "transmission": "in the transmission, between a motor and its link",
}
CHAIN = {
    "torque": "what is added to the torque",
    "angle": "the encoder's angle",
    "reading": "the drive's reading of the torque",
    "clock": "the clock of the reading",
}
SEARCH = {
    "between_grid": "a diagnosis tries it on a grid of numbers, and finer between the best of them",
    "repeats": "one joint may have several",
    "on_every_joint": "all joints at once are tried too",
    "comes_and_goes": "it may come and go within a record",
    "usual": "every robot has it and most files leave it out",
    "nothing_at_turns": "told from a constant torque by the turns of the joint, where it passes "
    "through nothing",
    "turns_over_in": "a diagnosis names it only where it is wider than what contacts hold over, "
    "measured at the turns of all joints",
    "at_usual_load": "its coefficient is told for the load that the joint usually carries",
    "beside": "felt on one of its joints alone it is named only beside another kind",
    "rattles": "at the wrist also told by what the neighbours feel as the load changes sides",
}
"""words for what an effect may say in its `search`"""
UNIT = re.compile(r"\s*\[([^\[\]]*)\]\s*$")
WIDTH = 92


def explain(kind: str) -> dict[str, Any]:
    """All that is said of an effect, under JSON names.

    Raises:
        InputError: no such kind; lists those that there are.
    """
    effect = effect_class(kind.strip().lower().replace("-", "_").replace(" ", "_"))
    return {
        "kind": _kind(effect),
        "sentence": effect.sentence,
        "law": inspect.cleandoc(effect.__doc__ or "").replace("`", ""),
        "acts": effect.acts,
        "acts_where": _where(effect),
        "on": "the whole arm" if effect.whole_arm else "one joint",
        "parameters": _parameters(effect),
        "states": list(effect.states),
        "group": effect.ambiguity.group,
        "look_alikes": _look_alikes(effect),
        "in_diagnosis": effect.search.in_diagnosis,
        "remarks": _remarks(effect),
    }


def overview() -> list[dict[str, str]]:
    """Every kind with its sentence, in the order of the kinds."""
    return [
        {"kind": kind, "sentence": effect.sentence, "acts": effect.acts}
        for kind, effect in LIBRARY.items()
    ]


def _kind(effect: type[Effect]) -> str:
    return str(effect.model_fields["kind"].default)


def _where(effect: type[Effect]) -> str:
    place = PLACES[effect.acts]
    return f"{place}: {CHAIN[effect.chain]}" if effect.acts == "measurement" else place


def _parameters(effect: type[Effect]) -> list[dict[str, Any]]:
    """Its own fields; the unit is what ends the description in brackets."""
    found = []
    for name, field in effect.model_fields.items():
        if name in COMMON:
            continue
        description = field.description or ""
        unit = UNIT.search(description)
        default = None if field.is_required() else field.get_default(call_default_factory=True)
        found.append(
            {
                "name": name,
                "unit": unit[1] if unit else None,
                "meaning": UNIT.sub("", description),
                "required": field.is_required(),
                "default": default,
                "usual": effect.example.get(name, default),
            }
        )
    return found


def _names(own: Ambiguity, other: type[Effect]) -> bool:
    """Whether one of these words says of an effect that it is taken for it."""
    return (
        own.group == other.ambiguity.group
        or _kind(other) in own.passing
        or _kind(other) in own.lookalikes
    )


def _look_alikes(effect: type[Effect]) -> list[dict[str, Any]]:
    """Who is taken for it, whoever of the two says so, and how they are told apart."""
    own = effect.ambiguity
    found = []
    for kind, other in LIBRARY.items():
        # whoever names the other says what separates them
        says = [
            words
            for words, named in ((own, other), (other.ambiguity, effect))
            if _names(words, named)
        ]
        if other is effect or not says:
            continue
        found.append(
            {
                "kind": kind,
                "sentence": other.sentence,
                "told_apart_by": _joined(words.splits for words in says),
                "measure_else": _joined(words.measure_else for words in says),
                "this_is_its_limit": kind in own.limit_of,
            }
        )
    return found


def _joined(texts: Any) -> str:
    return "; ".join(text for text in dict.fromkeys(texts) if text)


def _remarks(effect: type[Effect]) -> list[str]:
    """What else is special about it, and about looking for it."""
    search = effect.search
    words = []
    if effect.ambiguity.change_of:
        words.append(f"it is a change of the base's {', '.join(effect.ambiguity.change_of)}")
    if effect.ambiguity.on_another_link:
        words.append("the same kind on another link looks alike")
    if not search.in_diagnosis:
        return [*words, "a diagnosis does not try it"]
    words += [text for name, text in SEARCH.items() if getattr(search, name)]
    if search.device:
        words.append(f"of the flaws of one {search.device} a log tells one only")
    return words


def overview_lines(found: list[dict[str, str]]) -> list[str]:
    """The list for a terminal."""
    width = max(len(one["kind"]) for one in found)
    return [f"{one['kind']:<{width}}  {one['sentence']}" for one in found]


def excite_line(kind: str, robot: str | None = None) -> str:
    """The command that plans the motion which separates an effect from its look-alikes."""
    of = "" if robot is None else f" --robot {shlex.quote(robot)}"
    return f"irb2400 excite --for {kind}{of} --out next"


def lines(found: dict[str, Any], robot: str | None = None) -> list[str]:
    """An explanation for a terminal; `robot` as of `excite_line`."""
    text = [
        f"{found['kind']}: {found['sentence']}",
        "",
        *found["law"].splitlines(),
        "",
        f"acts {found['acts_where']}; on {found['on']}",
    ]
    if found["states"]:
        text.append(f"internal states: {', '.join(found['states'])}")
    text.append("parameters:")
    for one in found["parameters"]:
        unit = f" [{one['unit']}]" if one["unit"] else ""
        usual = "" if one["usual"] is None else f"; for example {as_in_a_file(one['usual'])}"
        text += _wrapped(f"{one['name']}{unit}: {one['meaning']}{usual}", "  ")
    text.append(f"look-alikes (ambiguity group {found['group']}):")
    for one in found["look_alikes"]:
        text += _wrapped(f"{one['kind']}: {one['sentence']}", "  ")
        if one["this_is_its_limit"]:
            text += _wrapped("this effect is a limit of it: only simplicity speaks for it", "    ")
        if one["told_apart_by"]:
            text += _wrapped(f"told apart by: {one['told_apart_by']}", "    ")
        if one["measure_else"]:
            text += _wrapped(f"where no motion helps: {one['measure_else']}", "    ")
    if not found["look_alikes"]:
        text.append("  none known")
    if found["in_diagnosis"]:
        text += _wrapped(f"a motion that separates them: {excite_line(found['kind'], robot)}", "")
    return [*text, *(f"note: {words}" for words in found["remarks"])]


def as_in_a_file(value: Any) -> str:
    """A value of a parameter as a robot file writes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _wrapped(text: str, indent: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=indent + "    ")
