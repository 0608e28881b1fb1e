"""What is dropped at the end makes room; what a refused flexible law beats is not said."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_selection_steps import bare, explanation, fitter_of, of

from irb2400_ctrl.diagnosis.comparison import selection as module
from irb2400_ctrl.diagnosis.comparison.selection import Selection, named
from irb2400_ctrl.diagnosis.comparison.step import Step


def test_what_a_dropped_explanation_had_stood_in_for_is_looked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Offsets of every joint, of which two were left once an encoder's zero was found, were dropped
    at the end, and the offset of axis 1, 346 standard deviations, with them."""
    offers = [explanation(kind) for kind in ("every joint", "zero", "joint 1")]
    searched: list[list[str]] = []

    def next_step(self: Any, chosen: Any, fit: Any, alone: bool = False) -> Step | None:
        stands_in = any(c.kind == "every joint" for c in chosen)
        left = [c for c in offers if named(c) not in self.refused and c not in chosen]
        left = [c for c in left if not (stands_in and c.kind == "joint 1")]
        searched.append([c.kind for c in chosen])
        return Step(left[0], 30.0, ()) if left else None

    def bears_out(steps: Any, fit: Any, place: int) -> bool:
        several = any(s.candidate.kind == "zero" for s in steps)
        return not (several and steps[place].candidate.kind == "every joint")

    monkeypatch.setattr(Selection, "next_step", next_step)
    monkeypatch.setattr(Selection, "_rather_wider", lambda self, step, fit: None)
    monkeypatch.setattr(Selection, "_exchanged", lambda self, steps: steps)
    acceptance = SimpleNamespace(
        bears_out=bears_out,
        clear=lambda steps, fit, place: [True],
        gains=lambda steps, fit: [np.array([float(k)]) for k in range(len(steps))],
    )
    selection = bare(fitter=fitter_of(), acceptance=acceptance)
    steps, fit = selection.run()
    assert [(s.candidate.kind, s.validation_gain) for s in steps] == [
        ("zero", 0.0),
        ("joint 1", 1.0),
    ]
    assert fit.of == ["zero", "joint 1"]
    assert selection.refused == {named(offers[0])}


@pytest.mark.parametrize(
    ("law", "said"),
    # over twice as much: no second effect of the joint makes up for it
    [(200.1, "other joint"), (199.9, "name")],
)
def test_a_name_that_a_refused_law_of_its_joint_beats_is_not_said(
    law: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    flexible = explanation("unexplained", known=False)
    name = of(explanation("name", order=(), effects=()), 100.0)
    other = of(explanation("other joint", 2), 50.0)

    def made(scan: Any, reversal: Any, y: Any, Z: Any) -> Any:
        return SimpleNamespace(
            gain=lambda one: one.evidence,
            polished=lambda one: one,
            compared=lambda candidate: of(candidate, law),
            start=None,
        )

    monkeypatch.setattr(module, "Comparison", made)
    monkeypatch.setattr(Selection, "alternatives", lambda self, c, chosen=(): [name, other])
    threshold = SimpleNamespace(
        accepts=lambda c, one, chosen: True,
        said_by_less=lambda c, one, every: False,
        best=lambda c, every, chosen: every[0],
        least_gain=lambda c, one, chosen: 22.0,
    )
    scan = SimpleNamespace(rank=lambda problem, chosen: [flexible, name.candidate])
    selection = bare(scan=scan, fitter=fitter_of(), threshold=threshold, refused={named(flexible)})
    step = selection.next_step([], SimpleNamespace(y=None, Z=None))
    assert step.candidate.kind == said
    # a law that was not refused has been weighed already
    unrefused = bare(scan=scan, fitter=fitter_of(), threshold=threshold)
    assert unrefused.next_step([], SimpleNamespace(y=None, Z=None)).candidate.kind == "name"


@pytest.mark.parametrize(
    ("rest", "said"),
    [
        # a tool that sloshes says 148 nats on joint 3 that no name says: less than half of it is
        # no delay of joint 6
        ((3, 148.0), ["large", "flexible"]),
        ((3, 59.0), ["large", "small", "flexible"]),
        # of a joint with a larger name it is what that has left, and of the whole arm a share
        ((1, 148.0), ["large", "small", "flexible"]),
        ((None, 148.0), ["large", "flexible"]),
    ],
)
def test_where_much_is_not_understood_a_little_shows_nothing(
    rest: tuple[int | None, float], said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    joint, gain = rest
    seen: list[Any] = []

    def alternatives(self: Any, c: Any, chosen: Any = (), refused: Any = None) -> list[Any]:
        seen.append(refused)
        return [of(explanation("rest", joint), gain), of(explanation("less", 3), 10.0)]

    monkeypatch.setattr(
        module, "Comparison", lambda *given: SimpleNamespace(gain=lambda one: one.evidence)
    )
    monkeypatch.setattr(Selection, "alternatives", alternatives)
    needed = {"rest": 22.0, "less": 22.0}
    selection = bare(
        scan=None,
        fitter=fitter_of(),
        refused={("rest", 3, "rest")},
        threshold=SimpleNamespace(
            left_by=lambda c, chosen, joint: 0.0,
            least_gain=lambda c, one, chosen: needed[one.candidate.kind],
        ),
    )
    steps = [
        Step(explanation("large", 1), 900.0, ()),
        Step(explanation("small", 6), 30.0, ()),
        Step(explanation("flexible", 2, known=False), 30.0, ()),
    ]
    kept, fit = Selection._weighty(
        selection, steps, selection.fitter.fit([s.candidate for s in steps])
    )
    assert [s.candidate.kind for s in kept] == said
    assert fit.of == said
    # what unseen rows did not bear out is there all the same
    assert seen == [()]
    # nor does what itself would not count
    needed["rest"] = 148.1
    assert Selection._weighty(selection, steps, fit)[0] == steps
    needed["rest"] = 22.0
    selection.threshold.left_by = lambda c, chosen, joint: 100.0
    kept, fit = Selection._weighty(selection, steps, fit)
    assert kept == steps
    assert Selection._weighty(selection, [], fit) == ([], fit)
