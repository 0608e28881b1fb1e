"""The diagnosis with one rule of its search left out: whether that rule matters on fresh arms.

python -m benchmarks.naming run OUT.jsonl --by without_each --count 6
python -m benchmarks.naming differ OUT.jsonl

A rule that answers all along as what is put in its place has nothing to do on that arm, and is not
left out there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import wraps
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.naming.givers import Said, diagnosis
from irb2400_ctrl.diagnosis.comparison import (
    acceptance,
    criteria,
    ground,
    possible,
    selection,
    step,
)
from irb2400_ctrl.diagnosis.comparison.at_load_changes import AtLoadChanges
from irb2400_ctrl.diagnosis.comparison.at_reversals import AtReversals
from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.comparison.own_friction import OwnFriction
from irb2400_ctrl.diagnosis.estimation import reversals
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

Put = tuple[Any, str, Callable[..., Any]]
THRESHOLD = criteria.Threshold
SELECTION = selection.Selection
GROUND = ground.Ground
ACCEPTANCE = acceptance.Acceptance
RULES: dict[str, tuple[Put, ...]] = {
    "wider": ((selection, "rather_wider", lambda *_: None),),
    "borne_out_again": ((SELECTION, "_borne_out", lambda _, steps, fit: (steps, fit)),),
    "weighty": ((SELECTION, "_weighty", lambda _, steps, fit: (steps, fit)),),
    "doubted": ((SELECTION, "_doubted", lambda *_: False),),
    "lags_on_a_spring": ((GROUND, "lags_on_a_spring", lambda *_: False),),
    "first_of_two": ((SELECTION, "_first_of_two", lambda _, ground, law, every: law),),
    "said_by_less": ((THRESHOLD, "said_by_less", lambda *_: False),),
    "once": ((THRESHOLD, "_once", lambda *_: False),),
    "new": ((THRESHOLD, "_new", lambda self, *_: np.ones(self.n, dtype=bool)),),
    "leaves_little": ((THRESHOLD, "_leaves_little", lambda *_: False),),
    "once_more": ((criteria, "_once_more", lambda *_: False),),
    "one_moment": (
        (criteria, "of_one_moment", lambda *_: False),
        (step, "of_one_moment", lambda *_: False),
    ),
    "leftover": ((StepComparison, "leftover", lambda *_: None),),
    "usual": ((acceptance, "usual", lambda *_: True),),
    "can_be_taken_off": ((possible, "can_be_taken_off", lambda *_: True),),
    "can_be_put_on": ((possible, "can_be_put_on", lambda *_: True),),
    "within_reach": ((possible, "within_reach", lambda *_: True),),
    "relaxes_within_reach": ((possible, "relaxes_within_reach", lambda *_: True),),
    "in_time": ((possible, "in_time", lambda *_: True),),
    "small_enough": ((possible, "small_enough", lambda *_: True),),
    "larger_one_way": ((possible, "larger_one_way", lambda *_: True),),
    "shaken": ((acceptance, "shaken", lambda *_: False),),
    "of_its_law": ((ACCEPTANCE, "_of_its_law", lambda *_: True),),
    "swings_so": ((ACCEPTANCE, "_swings_so", lambda *_: True),),
    "without_its_other": ((selection, "without_its_other", lambda _: None),),
    "own_friction": ((OwnFriction, "counted", lambda _, torque, usual: usual),),
    "clock": ((criteria, "of_the_clock", lambda *_: False),),
    "quick_turns": ((reversals, "left_by_a_loop", lambda *_: 1.0),),
    "stands_clear": (
        (ACCEPTANCE, "clear", lambda _, steps, fit, k: [True] * len(steps[k].candidate.effects)),
    ),
    "of_one_size": ((ACCEPTANCE, "_of_one_size", lambda *_: True),),
    "turns": ((AtReversals, "told", lambda _, alternative: alternative),),
    "load_changes": ((AtLoadChanges, "told", lambda _, alternative, chosen: alternative),),
}
"""what is put in the place of each"""


@contextmanager
def left_out(rule: str) -> Iterator[None]:
    """The search without a rule."""
    with ExitStack() as put:
        for where, name, instead in RULES[rule]:
            put.enter_context(patch.object(where, name, instead))
        yield


@contextmanager
def watched() -> Iterator[set[str]]:
    """The rules that answer otherwise than what would be put in their place."""
    acting: set[str] = set()
    with ExitStack() as put:
        for rule, places in RULES.items():
            for where, name, instead in places:
                kept = _watching(rule, getattr(where, name), instead, acting)
                put.enter_context(patch.object(where, name, kept))
        yield acting


def _watching(
    rule: str, kept: Callable[..., Any], instead: Callable[..., Any], acting: set[str]
) -> Callable[..., Any]:
    """A rule that adds its name to `acting` where its answer is not `instead`."""

    @wraps(kept)
    def answered(*given: Any, **named: Any) -> Any:
        answer = kept(*given, **named)
        if not _same(answer, instead(*given, **named)):
            acting.add(rule)
        return answer

    return answered


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other))
    return one is other or (isinstance(one, bool | float | str) and one == other)


def without_each(robot: Robot, log: Log) -> Said:
    """`diagnosis`, and names and verdict without each rule that has something to do."""
    with watched() as acting:
        said = diagnosis(robot, log)
    without = {}
    for rule in sorted(acting):
        with left_out(rule):
            without[rule] = _told(diagnosis(robot, log))
    return {**said, "without": without}


def differences(lines: list[dict[str, Any]]) -> str:
    """Arms on which another answer is given without a rule, as lines of text; at the end a line per
    rule: on how many it acts."""
    arms = [x for x in lines if "without" in x]
    said = []
    counts = []
    for rule in RULES:
        acts = [x for x in arms if rule in x["without"]]
        other = [x for x in acts if x["without"][rule] != _told(x)]
        for x in other:
            there = [(t["kind"], t["joint"]) for t in x["truth"]]
            said.append(f"{rule} {x['case']}: {there}: {_told(x)} -> {x['without'][rule]}")
        on = f"acts on {len(acts)} of {len(arms)} arms, other names on {len(other)}"
        counts.append(f"{rule}: {on}")
    return "\n".join([*said, *counts])


def _told(line: dict[str, Any]) -> list[str]:
    names = [f"{n['kind']} {n['joint'] or ''}".strip() for n in line.get("names", [])]
    return [*sorted(names), str(line.get("verdict", "refused"))]
