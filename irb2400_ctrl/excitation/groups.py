"""Ambiguity groups of the library: whose members look alike, and where each can sit.

What is said about a group stands with its effects (`effects.ambiguity`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from irb2400_ctrl.effects import LIBRARY, Ambiguity
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.wording import did_you_mean

Place = tuple[str, int | None]
"""kind of an effect and its joint (from 1; None: the whole arm)"""


@dataclass(frozen=True)
class AmbiguityGroup:
    """Effects that are hard to tell apart.

    Args:
        name; kinds: of the members; passing: kinds of other groups that pass for a member.
        splits: the experiment that tells them apart, in words; measure_else: where a motion does
            not.
        motions: names of the pieces that its motion is drawn from; empty: all.
    """

    name: str
    kinds: tuple[str, ...]
    passing: tuple[str, ...]
    splits: str
    measure_else: str
    motions: tuple[str, ...]

    def members(self, n: int, joint: int | None = None) -> list[Place]:
        """Places of the members on an arm of n joints; with `joint` only those there or on the
        whole arm."""
        return [
            p
            for kind in self.kinds
            for p in places(kind, n)
            if joint is None or p[1] in (joint, None)
        ]

    def rivals(self, place: Place, n: int) -> list[Place]:
        """What could be meant instead of a member."""
        others = [p for name in (*self.kinds, *self.passing) for p in places(name, n) if p != place]
        return [p for p in others if _alike(place, p)]


def _alike(one: Place, other: Place) -> bool:
    own = LIBRARY[one[0]].ambiguity
    if own.on_another_link and LIBRARY[other[0]].ambiguity.on_another_link:
        return True
    if other[0] in own.limit_of:
        return False
    return one[0] != other[0] and (one[1] == other[1] or None in (one[1], other[1]))


def places(kind: str, n: int) -> list[Place]:
    """Where an effect can sit on an arm of n joints; a delay of one joint is looked at joint by
    joint only."""
    joints: Sequence[int | None] = LIBRARY[kind].joints(n)
    if any(j is not None for j in joints):
        joints = [j for j in joints if j is not None]
    return [(kind, j) for j in joints if j is None or j <= n]


def groups() -> dict[str, AmbiguityGroup]:
    """All ambiguity groups by name, of the effects that a diagnosis tries."""
    members: dict[str, dict[str, Ambiguity]] = {}
    for kind, effect in LIBRARY.items():
        # what no diagnosis names needs no motion that tells it apart
        if not effect.search.in_diagnosis:
            continue
        members.setdefault(effect.ambiguity.group, {})[kind] = effect.ambiguity
    return {
        name: AmbiguityGroup(
            name,
            tuple(found),
            tuple(_each(kind for said in found.values() for kind in said.passing)),
            "; ".join(_each(said.splits for said in found.values())),
            "; ".join(_each(said.measure_else for said in found.values())),
            tuple(_each(motion for said in found.values() for motion in said.motions)),
        )
        for name, found in sorted(members.items())
    }


def _each(texts: Iterable[str]) -> list[str]:
    """What is said, once each."""
    return [text for text in dict.fromkeys(texts) if text]


def group_called(name: str) -> AmbiguityGroup:
    """The group of this name, or the one an effect of this name belongs to.

    Raises:
        InputError: neither; lists the groups.
    """
    known = groups()
    plain = name.strip().lower().replace("_", " ").replace("-", " ")
    if plain in known:
        return known[plain]
    kind = plain.replace(" ", "_")
    if kind in LIBRARY and LIBRARY[kind].search.in_diagnosis:
        return known[LIBRARY[kind].ambiguity.group]
    kinds = [kind for group in known.values() for kind in group.kinds]
    near = did_you_mean(kind, kinds) or did_you_mean(plain, known)
    raise InputError(
        f"found no ambiguity group {name!r}{near or ';'} expected one of {', '.join(known)}, or "
        "an effect of one (`irb2400 explain` lists them)"
    )
