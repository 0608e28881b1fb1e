"""The diagnosis with one rule of its search left out: whether that rule matters on fresh arms.

python -m benchmarks.naming run OUT.jsonl --by diagnosis,without_once --count 6
python -m benchmarks.naming differ OUT.jsonl
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

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
    "shows_moving": ((THRESHOLD, "_shows_moving", lambda *_: True),),
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
    kept = [(where, name, getattr(where, name)) for where, name, _ in RULES[rule]]
    for where, name, instead in RULES[rule]:
        setattr(where, name, instead)
    try:
        yield
    finally:
        for where, name, before in kept:
            setattr(where, name, before)


def without(rule: str, robot: Robot, log: Log) -> Said:
    """`diagnosis` without a rule."""
    with left_out(rule):
        return diagnosis(robot, log)


WITHOUT = {f"without_{rule}": partial(without, rule) for rule in RULES}


def differences(lines: list[dict[str, Any]]) -> str:
    """Arms on which another giver says other names than the diagnosis, as lines of text; at the end
    on how many."""
    usual = {(x["case"], x["seed"]): x for x in lines if x["by"] == "diagnosis"}
    said = []
    for giver in sorted({x["by"] for x in lines} - {"diagnosis"}):
        of_giver = [x for x in lines if x["by"] == giver and (x["case"], x["seed"]) in usual]
        other = [x for x in of_giver if _told(x) != _told(usual[x["case"], x["seed"]])]
        for line in other:
            before = usual[line["case"], line["seed"]]
            there = [(t["kind"], t["joint"]) for t in line["truth"]]
            said.append(f"{giver} {line['case']}: {there}: {_told(before)} -> {_told(line)}")
        said.append(f"{giver}: other names on {len(other)} of {len(of_giver)} arms")
    return "\n".join(said)


def _told(line: dict[str, Any]) -> list[str]:
    names = [f"{n['kind']} {n['joint'] or ''}".strip() for n in line.get("names", [])]
    return [*sorted(names), str(line.get("verdict", "refused"))]
