"""Logs that are not of one arm with one load."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine

import irb2400_ctrl as irb

ROBOT = possible_robot()
SEEDS = (1, 2, 3)


@cache
def log(seed: int, load: float, stiffer: float = 1.0) -> irb.Log:
    """A motion of one arm, with a load at its flange, its viscous friction `stiffer` times."""
    machine = PossibleCase(ROBOT, 105, 12.0).machine
    lump = _lump(load, np.array([0.0, 0.0, 0.3]), 0.02)
    arm = replace(machine.arm, payload=lump) if load else machine.arm
    moved = PossibleCase(ROBOT, seed, 12.0)
    friction = machine.friction * [1.0, 1.0, stiffer, 1.0]
    moved.__dict__["machine"] = Machine(arm, friction, machine.servo)
    return log_of(moved, name=f"motion {seed}")


@pytest.mark.parametrize("odd", [None, 2])
def test_the_one_with_another_load_is_named(odd: int | None) -> None:
    logs = [log(seed, 30.0 if seed == odd else 0.0) for seed in SEEDS]
    notes = irb.identify(ROBOT, logs).notes
    said = [note for note in notes if "does not belong to the other logs" in note]
    assert [note.partition(" does")[0] for note in said] == (
        [] if odd is None else [f"motion {odd}"]
    )
    assert not any("disagree" in note for note in notes)


def test_of_two_that_disagree_neither_is_blamed() -> None:
    notes = irb.identify(ROBOT, [log(1, 0.0), log(2, 30.0)]).notes
    (said,) = [note for note in notes if "disagree" in note]
    assert said.startswith("motion 1 and motion 2 disagree")


def test_a_cold_arm_is_no_other_arm() -> None:
    """Of an unchanged arm it was said that the first log, of a cold morning, did not belong."""
    notes = irb.identify(ROBOT, [log(1, 0.0, 1.5), log(2, 0.0), log(3, 0.0)]).notes
    assert not any("belong" in note or "disagree" in note for note in notes)
    (said,) = [
        note for note in notes if note.startswith("the friction of the logs is not the same")
    ]
    assert "motion" in said
