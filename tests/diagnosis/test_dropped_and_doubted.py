"""What is dropped at the end makes room; what a refused flexible law beats is not said."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_selection_steps import RATHER_WIDER, bare, explanation, fitter_of, of

from irb2400_ctrl.diagnosis.comparison.ground import named
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step


def test_what_a_dropped_explanation_had_stood_in_for_is_looked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Offsets of every joint, of which two were left once an encoder's zero was found, were dropped
    at the end, and the offset of axis 1, 346 standard deviations, with them."""
    offers = [explanation(kind) for kind in ("every joint", "zero", "joint 1")]
    searched: list[list[str]] = []

    def next_step(self: Any, ground: Any, alone: bool = False) -> Step | None:
        chosen = ground.comparison.chosen
        stands_in = any(c.kind == "every joint" for c in chosen)
        left = [c for c in offers if named(c) not in self.refused and c not in chosen]
        left = [c for c in left if not (stands_in and c.kind == "joint 1")]
        searched.append([c.kind for c in chosen])
        return Step(left[0], 30.0, ()) if left else None

    def bears_out(steps: Any, fit: Any, place: int, **_: Any) -> bool:
        several = any(s.candidate.kind == "zero" for s in steps)
        return not (several and steps[place].candidate.kind == "every joint")

    monkeypatch.setattr(Selection, "next_step", next_step)
    monkeypatch.setattr(RATHER_WIDER, lambda *given: None)
    monkeypatch.setattr(Selection, "_exchanged", lambda self, steps, gone=(): steps)
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


def test_what_was_chosen_beside_a_dropped_one_is_held_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bend of friction that came beside a spring let dry friction push the spring out; unseen
    rows refused the bend, and dry friction, which says nothing alone, was left at 0.94."""
    spring, bend, dry = (explanation(kind) for kind in ("spring", "bend", "dry friction"))
    best = {(): spring, ("spring",): bend, ("bend",): dry}

    def next_step(self: Any, ground: Any, alone: bool = False) -> Step | None:
        offer = best.get(tuple(c.kind for c in ground.comparison.chosen))
        return None if offer is None or named(offer) in self.refused else Step(offer, 30.0, ())

    monkeypatch.setattr(Selection, "next_step", next_step)
    monkeypatch.setattr(RATHER_WIDER, lambda *given: None)
    acceptance = SimpleNamespace(
        bears_out=lambda steps, fit, place, all_found=False: (
            not (all_found and steps[place].candidate.kind == "bend")
        ),
        clear=lambda steps, fit, place: [True],
        gains=lambda steps, fit: [np.zeros(1) for _ in steps],
    )
    selection = bare(fitter=fitter_of(), acceptance=acceptance)
    steps, _ = selection.run()
    assert [s.candidate.kind for s in steps] == ["spring"]
    assert selection.refused == {named(bend)}


def next_of(name: Any, laws: Any, refused: Any) -> str:
    """What comes next where a name of 100 nats and a smaller one of another joint are best beside
    flexible laws, each with what it gains."""
    gains = {id(law): gain for law, gain in laws}
    comparison = SimpleNamespace(
        gain=lambda one: one.evidence,
        polished=lambda one: one,
        compared=lambda candidate: of(candidate, gains[id(candidate)]),
    )
    every = [of(name, 100.0), of(explanation("other joint", 2), 50.0)]
    ground: Any = SimpleNamespace(
        comparison=comparison,
        alternatives=lambda refused: every,
        accepts=lambda one: True,
        lags_on_a_spring=lambda one, every: False,
        passing=lambda law: [],
        ranked=[*(law for law, _ in laws), name],
    )
    threshold = SimpleNamespace(
        said_by_less=lambda c, one, every: False,
        best=lambda c, every: every[0],
        least_gain=lambda c, one: 22.0,
    )
    selection = bare(threshold=threshold, refused={named(law) for law in refused})
    return str(selection.next_step(ground).candidate.kind)


@pytest.mark.parametrize(
    ("law", "said"),
    # over twice as much: no second effect of the joint makes up for it
    [(200.1, "other joint"), (199.9, "name")],
)
def test_a_name_that_a_refused_law_of_its_joint_beats_is_not_said(law: float, said: str) -> None:
    flexible = explanation("unexplained", known=False)
    name = explanation("name", order=(), effects=())
    assert next_of(name, [(flexible, law)], [flexible]) == said
    # a law that was not refused has been weighed already
    assert next_of(name, [(flexible, law)], []) == "name"


def test_a_name_of_the_whole_arm_is_held_against_the_laws_of_all_joints() -> None:
    """A liquid at the tool was a delay of all joints at 0.92: laws of the angles of three joints,
    which unseen rows did not bear out, gained four times as much."""
    name = explanation("name", order=(), effects=())
    name.joint = None
    laws = [(explanation("unexplained", j, known=False), 70.0) for j in (1, 2, 3)]
    refused = [law for law, _ in laws]
    assert next_of(name, laws, refused) == "other joint"
    # of a joint the best of its laws counts, not their sum
    more = (explanation("unexplained", 2, known=False), 69.0)
    assert next_of(name, [*laws[:2], more], refused) == "name"
    assert next_of(name, laws, refused[:2]) == "name"
    # those of other joints say nothing of a name of one
    assert next_of(explanation("name", 4), laws, refused) == "name"


@pytest.mark.parametrize(
    ("rest", "said", "nameless"),
    [
        # a tool that sloshes says 148 nats on joint 3 that no name says: less than half of it is
        # no delay of joint 6
        ((3, 148.0), ["large", "flexible"], 3),
        ((3, 59.0), ["large", "small", "flexible"], None),
        # of a joint with a larger name it is what that has left, and of the whole arm a share
        ((1, 148.0), ["large", "small", "flexible"], None),
        ((None, 148.0), ["large", "flexible"], 5),
        # what a flexible law says already is told by it
        ((2, 148.0), ["large", "flexible"], None),
    ],
)
def test_where_much_is_not_understood_a_little_shows_nothing(
    rest: tuple[int | None, float], said: list[str], nameless: int | None
) -> None:
    joint, gain = rest
    seen: list[Any] = []

    def alternatives(refused: Any = ()) -> list[Any]:
        seen.append(refused)
        return [of(explanation("rest", joint), gain), of(explanation("less", 3), 10.0)]

    comparison = SimpleNamespace(gain=lambda one: one.evidence)
    ground = SimpleNamespace(comparison=comparison, alternatives=alternatives)
    needed = {"rest": 22.0, "less": 22.0}
    selection = bare(
        fitter=fitter_of(),
        refused={("rest", 3, "rest")},
        _beside=lambda chosen: ground,
        threshold=SimpleNamespace(
            left_by=lambda c, joint: 0.0,
            least_gain=lambda c, one: needed[one.candidate.kind],
            matters=lambda c, one: np.array([True]),
            most_on=lambda candidate: candidate.joint or 5,
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
    assert selection.nameless == nameless
    remarks = Selection.remarks.fget(selection)  # type: ignore[attr-defined]
    assert [f"joint {nameless}: what is left there" in one for one in remarks] == [True] * len(
        remarks
    )
    assert len(remarks) == (nameless is not None)
    # what unseen rows did not bear out is there all the same
    assert seen == [()]
    # what is too small for its name has one all the same
    selection.nameless = None
    selection.threshold.matters = lambda c, one: np.array([False])
    assert Selection._weighty(selection, steps, fit)[0] == kept
    assert selection.nameless is None
    # nor does what itself would not count
    needed["rest"] = 148.1
    assert Selection._weighty(selection, steps, fit)[0] == steps
    needed["rest"] = 22.0
    selection.threshold.left_by = lambda c, joint: 100.0
    kept, fit = Selection._weighty(selection, steps, fit)
    assert kept == steps
    assert Selection._weighty(selection, [], fit) == ([], fit)
