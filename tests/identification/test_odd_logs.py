"""Logs that are not of one arm with one load."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.odd_logs import odd_logs

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


@pytest.mark.parametrize(("load", "said"), [(0.0, False), (0.3, True)])
def test_a_light_load_on_one_of_four_is_said(load: float, said: bool) -> None:
    """It leaves no joint twice what it leaves alone."""
    logs = [log(seed, load if seed == 3 else 0.0) for seed in (1, 2, 3, 4)]
    notes = [note for note in irb.identify(ROBOT, logs).notes if "of the logs" in note]
    assert [note.partition(" beside")[0].partition(" ±")[0] for note in notes] == (
        ["the load of the logs is not the same: motion 3 has +0.3"] if said else []
    )


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


LAYOUT = ColumnLayout(2)
LAST = 10
OFFSET = LAYOUT.drive("offset").start + 1
BLOCKS = 6


def said_of(
    *numbers: np.ndarray, samples: int = 200, noise: float = 1.0, like_offset: float = 0.0
) -> str:
    """What is said of logs of random motions, each with numbers (p,) of its own.

    Args:
        numbers: of each log; samples: of each of its `BLOCKS` blocks; noise: of the torques [Nm].
        like_offset: how much of a mass at the last link shows as an offset of its joint.
    """
    rng = np.random.default_rng(0)
    blocks = []
    for theta in numbers:
        for _ in range(BLOCKS):
            rows = rng.standard_normal((LAYOUT.n, samples, LAYOUT.count))
            rows[:, :, LAST] += like_offset * (rows[:, :, OFFSET] - rows[:, :, LAST])
            tau = rows @ theta + noise * rng.standard_normal((LAYOUT.n, samples))
            H = np.swapaxes(rows, 1, 2) @ rows
            g = np.einsum("nmp,nm->np", rows, tau)
            blocks.append((H, g, (tau**2).sum(axis=1), np.full(LAYOUT.n, float(samples))))
    found: Any = SimpleNamespace(
        layout=LAYOUT,
        sums=Moments(*map(np.array, zip(*blocks, strict=True))),
        samples=np.ones(LAYOUT.n),
    )
    parts: Any = [
        SimpleNamespace(
            block=BLOCKS * k + np.arange(BLOCKS), motion=SimpleNamespace(name=f"log {k + 1}")
        )
        for k in range(len(numbers))
    ]
    return " ".join(odd_logs(found, parts))


def with_change(place: int, by: float) -> np.ndarray:
    """Numbers of an arm of which one is another."""
    theta = np.ones(LAYOUT.count)
    theta[place] += by
    return theta


ARM = with_change(0, 0.0)


@pytest.mark.parametrize("term", ["coulomb", "viscous"])
def test_either_friction_may_be_of_another_day(term: str) -> None:
    other = with_change(LAYOUT.drive(term).start, 5.0)
    assert said_of(other, ARM, ARM).startswith("the friction of the logs is not the same")
    assert said_of(with_change(0, 5.0), ARM, ARM).startswith("log 1 does not belong")


def test_the_zero_of_a_torque_is_no_other_arm() -> None:
    """Of an arm whose channel of joint 2 had another zero in one log: "of another arm, load or
    mounting?"."""
    said = said_of(ARM, with_change(LAYOUT.drive("offset").start + 1, 9.0), ARM)
    assert said.startswith("the zeros of the torques are not the same in all logs")
    assert "of log 2 leaves" in said


def test_how_far_logs_may_differ() -> None:
    assert "belong" in said_of(with_change(0, 4.0), ARM, ARM)
    assert not said_of(with_change(0, 2.0), ARM, ARM)


def test_where_the_others_differ_too_none_is_named() -> None:
    said = said_of(with_change(0, 9.0), with_change(0, -9.0), ARM, ARM)
    assert said.startswith("the logs disagree")


@pytest.mark.parametrize(("by", "named"), [(1.6, True), (2.4, False)])
def test_the_others_agree_about_as_well_as_each_with_itself(by: float, named: bool) -> None:
    said = said_of(with_change(0, 30.0), with_change(0, by), ARM, ARM)
    assert ("log 1 does not belong" in said) == named


def test_a_few_samples_accuse_nobody() -> None:
    assert said_of(with_change(0, 30.0), ARM, ARM, samples=17)
    assert not said_of(with_change(0, 30.0), ARM, ARM, samples=16)


def test_what_a_simulation_leaves_is_no_disagreement() -> None:
    assert said_of(with_change(0, 0.1), ARM, ARM, noise=1e-6)
    assert not said_of(with_change(0, 1e-4), ARM, ARM, noise=1e-6)


@pytest.mark.parametrize(("like_offset", "said"), [(0.0, True), (0.97, False)])
def test_a_load_is_named_where_a_zero_explains_the_logs_less(
    like_offset: float, said: bool
) -> None:
    found = said_of(with_change(LAST, 1.2), ARM, ARM, ARM, like_offset=like_offset)
    assert ("the load of the logs is not the same: log 1 has" in found) == said
