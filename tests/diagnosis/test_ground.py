"""The candidates beside what is chosen, each judged once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_selection_steps import explanation, of

from irb2400_ctrl.diagnosis.comparison import ground as module
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.ground import Ground, named
from irb2400_ctrl.effects import LIBRARY

NAMES = [explanation(f"n{k}", joint=1 + k % 4, gain=float(k)) for k in range(9)]
LAWS = [explanation("unexplained", j, False, gain=50.0 + j) for j in (1, 2)]
WINDOWED = [explanation("w0", gain=99.0), explanation("w1", gain=98.0)]
REFUSED = {named(NAMES[3]), named(LAWS[0]), named(WINDOWED[0])}


class Told:
    """A ground whose candidates are plain numbers, and what was asked for."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        rattling: Any = None,
        on: Any = None,
        change: bool = False,
    ) -> None:
        self.between: list[str] = []
        self.on: list[Any] = []
        self.joints: list[set[int]] = []
        self.compared: list[str] = []
        self.judged: list[str] = []
        monkeypatch.setattr(
            module, "Windowing", lambda scan, start: SimpleNamespace(candidates=self._windowed)
        )
        scan = SimpleNamespace(
            rank=lambda start, chosen, on: self.on.append(on) or [*NAMES, *LAWS],
            between=lambda start, c: self.between.append(c.kind) or c,
        )
        comparison: Any = SimpleNamespace(
            start=None,
            chosen=(),
            scan=scan,
            compared=lambda c: self.compared.append(c.kind) or of(c, c.gain),
        )
        threshold: Any = SimpleNamespace(
            criteria=Criteria(),
            accepts=lambda c, one: self.judged.append(one.candidate.kind) or one.evidence > 90.0,
        )
        turns: Any = SimpleNamespace(
            # what the turns of the joints say counts too
            told=lambda a: of(NAMES[5], 1.5) if a.candidate is NAMES[5] else a
        )
        load_changes: Any = SimpleNamespace(
            rattles=lambda c, chosen: 10.0 * (c is rattling),
            told=lambda a, chosen: of(a.candidate, a.evidence + 10.0 * (a.candidate is rattling)),
        )
        self.ground = Ground(comparison, threshold, turns, load_changes, on, change=change)

    def _windowed(self, joints: Any) -> list[Any]:
        self.joints.append(set(joints))
        return WINDOWED

    def best(self, refused: Any = REFUSED) -> list[str]:
        return [a.candidate.kind for a in self.ground.alternatives(refused)]


def test_what_is_far_ahead_of_all_other_names_needs_no_look_at_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def ahead(name: Any, *ranked: Any) -> list[str]:
        told = Told(monkeypatch)
        told.ground.comparison.scan.rank = lambda *_: list(ranked)
        return [a.candidate.kind for a in told.ground.far_ahead(named(name))]

    ripple = explanation("ripple", 3, gain=90.0)
    second = explanation("ripple", 3, gain=80.0)
    near = explanation("payload", None, gain=46.0)
    far = explanation("payload", None, gain=44.0)
    law = explanation("unexplained", 3, False, gain=95.0)
    # a flexible law never takes the place of a name
    assert ahead(ripple, law, ripple, second, far) == ["ripple", "payload"]
    assert ahead(ripple, ripple, near) == []
    assert ahead(near, ripple, far) == []
    assert ahead(ripple, law) == []
    assert ahead(ripple) == []
    assert ahead(ripple, ripple) == ["ripple"]


def test_a_spring_over_a_short_travel_may_be_a_slow_ripple(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    asked: list[int] = []
    slow = explanation("gear_ripple", 3, gain=70.0)
    monkeypatch.setattr(
        module, "slow_ripple", lambda scan, start, joint: asked.append(joint) or slow
    )
    (found,) = told.ground.passing(explanation("cable_spring", 3))
    assert (found.candidate, asked) == (slow, [3])
    assert told.ground.passing(explanation("payload", None)) == []
    assert told.ground.passing(explanation("balancer", 2)) == []
    assert asked == [3]


@pytest.mark.parametrize(("change", "first"), [(False, "link_inertia"), (True, "payload")])
@pytest.mark.parametrize("ahead", [0.5, 6.9])
def test_what_changed_from_one_day_to_another_is_the_load_before_it_is_a_link(
    monkeypatch: pytest.MonkeyPatch, change: bool, first: str, ahead: float
) -> None:
    """25 kg on axis 6 were "link 5 is heavier" (0.80): a load there is as well a mass of link 5."""
    told = Told(monkeypatch, change=change)
    link = LIBRARY["link_inertia"].of(5, mass_kg=25.0)
    load = LIBRARY["payload"].of(None, mass_kg=25.0)
    told.ground.comparison.scan.rank = lambda *_: [
        explanation("link_inertia", 5, gain=500.0 + ahead, effects=(link,)),
        explanation("payload", None, gain=500.0, effects=(load,)),
    ]
    assert told.best()[0] == first


def test_alternatives_are_the_best_of_the_scan_that_were_not_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch)
    # the best of joint 4 is among them, as a number of a joint's friction counts from 6 nats on
    assert told.best() == ["w1", "unexplained", "n7", "n6", "n4", "n2", "n5", "n1", "n0"]
    assert told.between == ["n0", "n1", "n2", "n4", "n5", "n6", "n7", "unexplained"]
    assert told.joints == [{1, 2, 3}]
    # play that the neighbours feel is among them, wherever the scan has it, and has their word
    best = Told(monkeypatch, NAMES[8]).best()
    assert best == ["w1", "unexplained", "n8", "n7", "n6", "n4", "n2", "n5", "n1", "n0"]
    told = Told(monkeypatch, NAMES[2])
    assert told.best()[:4] == ["w1", "unexplained", "n2", "n7"]
    assert told.between == ["n0", "n1", "n2", "n4", "n5", "n6", "n7", "unexplained"]


def test_the_scan_is_asked_for_what_acts_on_these_joints(monkeypatch: pytest.MonkeyPatch) -> None:
    there = np.array([False, True, False])
    told = Told(monkeypatch, on=there)
    told.best()
    assert told.on == [there]


def test_what_was_judged_is_not_judged_again_once_a_name_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch)
    assert told.best(())[:3] == ["w0", "w1", "unexplained"]
    seen = list(told.compared)
    first = told.ground.alternatives()[0]
    assert told.ground.accepts(first)
    assert told.ground.accepts(first)
    assert told.judged == ["w0"]
    assert told.best(REFUSED)[0] == "w1"
    # which come in the place of the refused one, and for its joint
    assert told.compared == [*seen, "n6", "n7"]
    assert told.joints == [{1, 2, 3}]
    # where the best names sit on other joints these are looked at
    told.best({named(NAMES[0])})
    assert told.joints == [{1, 2, 3}, {2, 3, 4}]


def test_laws_without_a_name_are_one_for_each_joint() -> None:
    assert named(explanation("a", 2, name="a of 2")) == ("a", 2, "a of 2")
    assert named(explanation("unexplained", 2, False, name="q")) == ("unexplained", 2, "")


@pytest.mark.parametrize(
    ("name", "said"),
    [("n1", ["n2"]), ("n1, part of the time", ["n2"]), ("n1 of every joint", ["n2", "n1"])],
)
def test_what_all_joints_do_not_have_none_of_them_has(
    monkeypatch: pytest.MonkeyPatch, name: str, said: list[str]
) -> None:
    """A liquid at the tool was a delay of the arm, then of two of its joints, each so
    (0.94, third plant 20261841 outside 5); offsets of every joint have a size each, and one may
    be left."""
    told = Told(monkeypatch)
    refused = {named(explanation("n1", None, name=name))}
    assert [kind for kind in told.best(refused) if kind in ("n1", "n2")] == said
