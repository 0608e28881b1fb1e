"""What the fit takes on beside bodies, friction, offsets and rotors."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from identification.given_columns import fit_with

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting import fit as fit_module
from irb2400_ctrl.identification.fitting.choice import PINNED
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.estimate import DOUBT, FitProblem
from irb2400_ctrl.identification.fitting.fit import NEGATIVE, _signed_rotors, _unread, fit
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import (
    Recording,
    faster_half,
    moments,
    recordings,
)
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base

LOG = Path(str(files("irb2400_ctrl") / "data" / "arm" / "identification.csv.gz"))
LACKS = np.array([0.0, 0.0, 0.0, 0.6, 0.6, 0.4])
"""[kg m2] of what accelerates each joint is not in its reading"""
READINGS = tuple(Extra("reading", joint) for joint in (4, 5, 6))


Lacking = tuple[irb.Model, list[Recording]]


@pytest.fixture(scope="module")
def lacking() -> Lacking:
    """Torques of which three joints lack what accelerates their drives."""
    model = irb.Model(fit_base(irb.load_robot("irb2400"))[0])
    motion = motion_of(irb.read_log(LOG), "angle")
    motion = replace(motion, tau=motion.tau - LACKS * motion.qdd)
    return model, recordings([motion])


def readings_of(found: Fit) -> tuple[Extra, ...]:
    """Extras of that kind alone: friction at low speed is none of the question."""
    return tuple(extra for extra in found.layout.extras if extra.kind == "reading")


def test_drives_that_lack_accelerating_torque_are_found(lacking: Lacking) -> None:
    """All of them: one alone is paid by the joints beside it, and was refused on a real arm."""
    assert readings_of(fit(*lacking)) == READINGS


def test_a_sound_arm_reads_all_of_its_torque(lacking: Lacking) -> None:
    """Rotors of nearly zero are below it as often as above."""
    model, (part,) = lacking
    whole = replace(part.motion, tau=part.motion.tau + LACKS * part.motion.qdd)
    assert readings_of(fit(model, [replace(part, motion=whole)])) == ()


def test_friction_that_is_late_to_turn_is_no_reading(lacking: Lacking) -> None:
    """It lacks torque at reversals, where accelerations are largest; where the joint is fast it
    lacks none."""
    model, (part,) = lacking
    m = part.motion
    tau = m.tau + LACKS * m.qdd
    state = 0.0
    for k, step in enumerate(np.diff(m.q[:, 1], prepend=m.q[0, 1])):
        state = np.clip(state + step / 0.05, -1.0, 1.0)
        tau[k, 1] += 20.0 * (state - np.sign(m.qd[k, 1]))
    late = [replace(part, motion=replace(m, tau=tau))]
    bare = fit_with(model, late)
    fast = moments(model, bare.layout, faster_half(late)).summed()
    values, errors = _signed_rotors(bare, bare.sums.summed())
    assert values[1] < -NEGATIVE * errors[1]
    assert len(_unread(bare, lambda: fast)) == 0
    # the same where it is as much in motion
    assert 1 in _unread(bare, bare.sums.summed)
    assert readings_of(fit(model, late)) == ()


@pytest.mark.parametrize(
    ("whole", "fast", "unread"),
    [
        # below zero by 4 and 1.5 standard errors, and as far in motion
        ([-0.4, -0.15, 0.1], [-0.35, 0.0, 0.0], [0, 1]),
        # not clearly in motion; clearly, but half of it
        ([-0.31, -0.15, 0.1], [-0.19, 0.0, 0.0], []),
        ([-0.8, -0.15, 0.1], [-0.40, 0.0, 0.0], []),
        # one that is clear in motion, beside one that is not clear of all samples
        ([-0.4, -0.25, 0.1], [0.0, -0.25, 0.0], []),
        ([-0.29, 0.1, 0.1], [-0.29, 0.0, 0.0], []),
    ],
)
def test_what_a_drive_does_not_read_it_lacks_in_motion(
    monkeypatch: pytest.MonkeyPatch, whole: list[float], fast: list[float], unread: list[int]
) -> None:
    error = np.full(3, 0.1)
    monkeypatch.setattr(fit_module, "_signed_rotors", lambda base, data: (np.array(data), error))
    base: Any = SimpleNamespace(sums=SimpleNamespace(summed=lambda: whole))
    given: Any = lambda: fast  # noqa: E731
    assert _unread(base, given).tolist() == unread


def test_a_rotor_beside_a_reading_is_none(lacking: Lacking) -> None:
    """Only their difference is told: the smallest pair, not an inertia that nobody measured."""
    found = fit_with(*lacking, *READINGS)
    layout = ColumnLayout(6, READINGS)
    assert found.theta[layout.drive("rotor")][3:].max() < 1e-3
    assert found.theta[layout.extra(READINGS[0])][0] > 0.5 * LACKS[3]


def bent(lacking: Lacking, coefficient: float) -> Lacking:
    """The whole torque, and on joint 2 friction that goes with the root of speed."""
    model, (part,) = lacking
    qd = part.motion.qd[:, 1]
    tau = part.motion.tau + LACKS * part.motion.qdd
    tau[:, 1] += coefficient * np.sign(qd) * np.sqrt(np.abs(qd))
    return model, [replace(part, motion=replace(part.motion, tau=tau))]


def test_friction_that_bends_with_speed_is_found(lacking: Lacking) -> None:
    """On four joints of a real arm it left a fifth more than with its own column."""
    found = fit(*bent(lacking, 200.0))
    extra = Extra("power", 2)
    assert extra in found.layout.extras
    assert found.theta[found.layout.extra(extra)][0] == pytest.approx(200.0, rel=0.3)


@pytest.mark.parametrize("coefficient", [0.0, -60.0])
def test_friction_that_no_joint_has_is_not(lacking: Lacking, coefficient: float) -> None:
    """In proportion to speed, or less of it the faster at first: a joint's play with the motion."""
    kinds = {extra.kind for extra in fit(*bent(lacking, coefficient)).layout.extras}
    assert "power" not in kinds


def test_numbers_are_halfway_to_those_of_wider_bodies(lacking: Lacking) -> None:
    """Of widths as probable as those found; a real arm was left 1.14 times the better baseline."""
    found = fit_with(*lacking, *READINGS)
    positive = found.layout.positive()
    drives = found.prior.drives.copy()
    drives[found.layout.drive("rotor").start - found.layout.inertial + np.arange(3, 6)] *= PINNED
    held = replace(found.prior, drives=drives)
    problem = FitProblem(found.weighted.summed(), held, found.correlation, positive)
    ends = [problem.estimate(kappa=width * found.numbers.kappa).theta for width in (1.0, DOUBT)]
    size = np.abs(ends[1] - ends[0]).max()
    assert size > 0.1
    np.testing.assert_allclose(found.theta, np.mean(ends, axis=0), rtol=0, atol=0.05 * size)
