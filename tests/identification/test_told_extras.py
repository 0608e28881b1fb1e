"""What the extras of an identification are called, in its report, its files and its notes."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra, columns
from irb2400_ctrl.identification.fitting.told_extras import KINDS, extra_json, said_of
from irb2400_ctrl.identification.identified_robot import _extra_effects, fit_base


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_an_extra_has_a_name_and_a_unit(kind: str) -> None:
    numbers = KINDS[kind].numbers
    assert len(numbers) == Extra(kind, 5).size
    assert all(number.endswith("]") for number in numbers)
    written = _extra_effects(Extra(kind, 4), np.full(len(numbers), 0.1))
    effect = KINDS[kind].effect
    assert [one.kind for one in written] == ([] if effect is None else [effect])


@pytest.mark.parametrize("kind", ["coupling", "far_coupling"])
def test_numbers_of_gears_say_which_joint_they_act_on(kind: str) -> None:
    """The label said "qdd here" of what acts here by the other's acceleration."""
    extra = Extra(kind, 4)
    other = extra.touches[1]
    layout = ColumnLayout(6, (extra,))
    model = irb.Model(fit_base(irb.load_robot("irb2400"))[0])
    rest = np.zeros((1, 6))
    for mover in (3, other):
        speed = np.eye(6)[[mover]]
        found = columns(model, layout, rest, speed, speed)[0, :, layout.extra(extra)]
        for number, column in zip(KINDS[kind].numbers, found.T, strict=True):
            acts_on = 3 if number.startswith("here, by the other's") else other
            moved_by = other if acts_on == 3 else 3
            expected = np.eye(6)[acts_on] if mover == moved_by else np.zeros(6)
            np.testing.assert_allclose(column, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("joint", "ratios", "turning"),
    [
        (5, (-1.06, 0.0), "-1.06 times joint 4"),
        (6, (0.02, 0.5), "+0.50 times joint 4"),
        (6, (1.0, -0.7), "+1.00 times joint 5 and -0.70 times joint 4"),
    ],
)
def test_a_motor_says_what_turns_it_and_how_far(
    joint: int, ratios: tuple[float, float], turning: str
) -> None:
    extra = Extra("motor", joint, ratios)
    assert said_of(extra) == f"has a motor that turns along with {turning} (gears of a wrist)"
    told = extra_json(extra)
    assert told == {
        "kind": "motor",
        "joint": joint,
        "effect": "geared_motor",
        "ratios": list(ratios),
    }
    assert extra_json(Extra("power", 2))["ratios"] is None
