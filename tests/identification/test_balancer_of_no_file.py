"""A balancer that no file names is none of the arm's bodies."""

from __future__ import annotations

import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.effects import Effect

import irb2400_ctrl as irb
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting.choice import Choice


def identified(share: float) -> Identification:
    """An arm whose file is right but for a balancer on axis 2."""
    case = PossibleCase(possible_robot(), 71001, 30.0, Effect("balancer", 2, share))
    return irb.identify(possible_robot(), log_of(case))


def test_a_link_that_would_weigh_seven_times_as_much_is_a_balancer() -> None:
    """Link 2 took it in, 7.5 times as heavy as in the file, and drives "read their torque without
    part of what accelerates it"."""
    found = identified(0.6)
    assert [(extra.kind, extra.joint) for extra in found.layout.extras] == [("balancer", 2)]
    assert "joint 2 has a balancer that the file does not name" in found.notes
    assert not [one for one in found.moved if one.alarms]


def test_bodies_in_the_place_of_a_balancer_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of bodies that went far, and less absurdly, that a balancer would leave them was not said."""
    monkeypatch.setattr(Choice, "_absurd", lambda self, trial: False)
    found = identified(0.3)
    assert any(one.alarms and one.link == 2 for one in found.moved)
    (said,) = [note for note in found.notes if note.startswith("a balancer on joint 2, which")]
    assert "leave its bodies as they are" in said
