"""A name that counts only beside a second one goes where that does not come."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from diagnosis.test_selection_steps import RATHER_WIDER, bare, explanation, fitter_of

from irb2400_ctrl.diagnosis.comparison.ground import named
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step


@pytest.mark.parametrize(("joint", "kept"), [(1, ["first", "other"]), (2, ["other"])])
def test_the_first_of_two_goes_where_the_other_one_does_not_come(
    joint: int, kept: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An offset of joint 1 beside a tilted base counted only with a friction there, which the fit
    refused; it was said alone, at 0.90, and is nothing."""
    first = explanation("first", 1)
    other = explanation("other", joint)
    accept = {"bears_out": lambda *_, **__: True, "clear": lambda *_: [True]}
    acceptance = SimpleNamespace(**accept, gains=lambda steps, fit: [0.0] * len(steps))
    selection = bare(fitter=fitter_of(), refused=set(), acceptance=acceptance)

    def next_step(self: Any, ground: Any, alone: bool = False) -> Step | None:
        chosen = ground.comparison.chosen
        for offer in (Step(first, 30.0, (), one_of_two=True), Step(other, 20.0, ())):
            if offer.candidate not in chosen and named(offer.candidate) not in self.refused:
                return offer
        return None

    monkeypatch.setattr(Selection, "next_step", next_step)
    monkeypatch.setattr(Selection, "_exchanged", lambda self, steps, gone=(): steps)
    monkeypatch.setattr(RATHER_WIDER, lambda *given: None)
    steps, fit = selection.run()
    assert [s.candidate.kind for s in steps] == kept
    assert fit.of == kept
