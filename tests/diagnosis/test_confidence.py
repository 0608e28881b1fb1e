"""What a finding is worth, at the edges of its table and of what counts as an alternative."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from irb2400_ctrl.diagnosis.comparison.confidence import (
    alternatives,
    confidence,
    of_name,
    says_little,
)
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.effects import LIBRARY


def tried(kind: str, joint: int, evidence: float, known: bool = True) -> Any:
    return SimpleNamespace(
        candidate=SimpleNamespace(kind=kind, joint=joint, known=known, effects=()),
        evidence=evidence,
    )


def step(kind: str, gain: float, *others: Any, known: bool = True) -> Step:
    """An explanation found with evidence zero, and others beside it."""
    own = tried(kind, 2, 0.0, known)
    return Step(own.candidate, gain, (own, *others))


@pytest.mark.parametrize(
    ("margin", "share"),
    [(0, 0.48), (3, 0.76), (30, 0.89), (100, 0.935), (300, 0.96), (1000, 0.98), (1e5, 0.99)],
)
def test_the_table_is_what_was_measured(margin: float, share: float) -> None:
    found = step("gear_ripple", 1e9, tried("payload", 2, -float(margin)))
    assert confidence(found) == pytest.approx(share)
    assert confidence(step("gear_ripple", float(margin))) == pytest.approx(share)


def test_beside_a_lookalike_nothing_is_surer_than_it_proved() -> None:
    kind = next(kind for kind, effect in LIBRARY.items() if effect.ambiguity.lookalikes)
    assert confidence(step(kind, 1e9)) == 0.75
    assert confidence(step(kind, 0.0)) == pytest.approx(0.48)
    assert confidence(step(kind, 1e9, known=False)) == pytest.approx(0.99)


def test_a_law_of_the_angle_beside_a_slow_ripple_is_none_to_be_sure_of() -> None:
    """Eleven springs were told of arms whose gears have ripples of two or three periods a turn, at
    0.93 at most; one was there."""
    ripple = tried("gear_ripple", 2, -300.0)
    assert confidence(step("cable_spring", 5000.0, ripple)) == 0.5
    assert confidence(step("cable_spring", 5000.0)) > 0.98
    assert confidence(step("cable_spring", 5000.0, tried("gear_ripple", 3, -300.0))) > 0.95
    assert confidence(step("cable_spring", 5000.0, tried("payload", 2, -300.0))) > 0.95
    assert confidence(step("load_friction", 5000.0, ripple)) > 0.95
    # one that is far behind is no alternative
    assert confidence(step("cable_spring", 5000.0, tried("gear_ripple", 2, -400.0))) > 0.95
    assert confidence(step("cable_spring", 0.0, tried("gear_ripple", 2, 0.0))) < 0.5


@pytest.mark.parametrize(
    ("kind", "gain", "share", "little"),
    [
        ("torque_gain", 44.0, 0.09, True),
        ("torque_gain", 46.0, 0.09, False),
        ("torque_gain", 44.0, 0.11, False),
        ("process_force", -3.0, 0.01, True),
        ("gear_ripple", 5.0, 0.01, False),
        ("rotor_inertia", 5.0, 0.01, False),
        ("torque_offset", 5.0, 0.01, False),
        # with a course of their own
        ("viscous_warmup", 5.0, 0.01, False),
        ("base_tilt", 5.0, 0.01, False),
        ("wrist_coupling", 5.0, 0.01, False),
        ("hysteresis", 5.0, 0.01, False),
    ],
)
def test_a_name_that_says_little_is_none_to_be_sure_of(
    kind: str, gain: float, share: float, little: bool
) -> None:
    """A gain of 1.14 of one half of a recording (0.87), which the other has not, takes 15 % off its
    joint's error; a torque that a recorder filters was a delay of one joint (0.91) by 4 %."""
    model = LIBRARY[kind]
    joint = None if model.whole_arm else 3
    effect = model.of(joint, **model.example)
    assert says_little(effect, gain, share) == little
    found = step(kind, 5000.0)
    assert of_name(found, effect, gain, share) == (0.5 if little else confidence(found))
    assert of_name(found, effect, None, share) == confidence(found) > 0.5


def test_a_delay_of_all_torques_is_no_detail() -> None:
    """Nine of nine on two plants are there, two of 16 ms of them at 0.5."""
    assert says_little(LIBRARY["time_delay"].of(3, delay_s=0.01), 4.0, 0.05)
    assert not says_little(LIBRARY["time_delay"].of(None, delay_s=0.01), 4.0, 0.05)


def test_alternatives_are_near_or_of_the_same_group() -> None:
    own, mate = group_mates()
    other = next(
        kind
        for kind, effect in LIBRARY.items()
        if effect.ambiguity.group != LIBRARY[own].ambiguity.group
    )
    always = LIBRARY[own].ambiguity.lookalikes
    # 12 nats and 6 % of the gain
    for evidence, named in ((-17.9, (other,)), (-18.0, ()), (1.0, (other,))):
        found = alternatives(step(own, 100.0, tried(other, 2, evidence)))
        assert found == tuple(dict.fromkeys((*named, *always)))
    # of the same group within 40 % of it
    for evidence, named in ((-39.9, (mate,)), (-40.0, ())):
        found = alternatives(step(own, 100.0, tried(mate, 2, evidence)))
        assert found == tuple(dict.fromkeys((*named, *always)))
    # not the same kind elsewhere, and no law without a name
    unnamed = (tried(own, 3, -1.0), tried("smooth", 2, -1.0, known=False))
    assert alternatives(step(own, 100.0, *unnamed)) == always


def group_mates() -> tuple[str, str]:
    """Two kinds of one group, the first without look-alikes."""
    for kind, effect in LIBRARY.items():
        for other, mate in LIBRARY.items():
            same = effect.ambiguity.group == mate.ambiguity.group
            if other != kind and same and not effect.ambiguity.lookalikes:
                return kind, other
    raise AssertionError("no group of two")
