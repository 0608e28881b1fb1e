"""A search goes on while there is more to find, and judges again what is near alone."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from diagnosis.test_selection_steps import RATHER_WIDER, bare, beside, explanation, fitter_of, of

from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step


def searched(kinds: list[str | None], limit: int = 20) -> list[str]:
    """What a search ends with, to which these steps are offered, one look after the other."""
    offered = iter(kinds)

    def next_step(ground: Any) -> Any:
        kind = next(offered)
        return kind and Step(explanation(kind), 30.0, ())

    selection = bare(
        fitter=fitter_of(),
        acceptance=SimpleNamespace(bears_out=lambda *_: True),
        next_step=next_step,
        _goes_on=lambda steps: len(steps) < limit,
        _clear=lambda steps, place: (steps, None),
        _exchanged=lambda steps: [s for s in steps if s.candidate.kind != "falls out"],
    )
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(RATHER_WIDER, lambda *given: None)
        return [s.candidate.kind for s in selection._searched([])[0]]


def test_a_second_ripple_of_a_joint_does_not_end_the_search() -> None:
    """It did: beside two of a joint a missing load of 2 kg was a delay."""
    found = searched(["rotor", "ripple", "ripple", "payload", None])
    assert found == ["rotor", "ripple", "ripple", "payload"]


def test_what_comes_and_goes_ends_the_search() -> None:
    assert searched(["rotor", "ripple", "falls out", "never asked for"]) == ["rotor", "ripple"]


def test_what_nothing_comes_near_is_judged_again_without_a_look_at_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks: list[list[str]] = []
    near: list[Any] = [of(explanation("ripple"), 90.0), of(explanation("payload", None), 40.0)]
    said: list[Any] = []

    def next_step(self: Any, ground: Any, alone: bool = False, among: Any = ()) -> Any:
        looks.append([one.candidate.kind for one in among])
        return said.pop(0)

    monkeypatch.setattr(Selection, "next_step", next_step)
    ground: Any = beside([])
    ground.far_ahead = lambda name: near
    ripple = Step(explanation("ripple"), 90.0, ())
    other = Step(explanation("other"), 95.0, ())

    def again(*steps: Any) -> Any:
        looks.clear()
        said[:] = steps
        return bare()._again(explanation("ripple"), ground)

    assert again(ripple) is ripple
    assert looks == [["ripple", "payload"]]
    # where it does not count, or another does, all are judged
    assert again(None, other) is other
    assert again(other, None) is None
    assert looks == [["ripple", "payload"], []]
    near.clear()
    assert again(other) is other
    assert looks == [[]]


def test_a_judgement_of_a_few_is_no_look() -> None:
    ground: Any = beside([])
    ground.comparison.gain = lambda one: one.evidence
    ground.comparison.polished = lambda one: one
    ground.accepts = lambda one: True
    ground.alternatives = lambda refused: []
    threshold = SimpleNamespace(
        said_by_less=lambda *_: False,
        best=lambda c, every: every[0],
        least_gain=lambda c, one: 22.0,
    )
    selection = bare(threshold=threshold)
    one = of(explanation("ripple"), 90.0)
    assert selection.next_step(ground, among=[one]).candidate.kind == "ripple"
    assert selection.looks == 0
    assert selection.next_step(ground) is None
    assert selection.looks == 1
