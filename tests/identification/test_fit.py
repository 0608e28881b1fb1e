"""What the fit takes on beside bodies, friction, offsets and rotors."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.fit import Fit, fit
from irb2400_ctrl.identification.fitting.moments import Recording, recordings
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
    return model, recordings([motion], [np.zeros_like(motion.tau)])


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


def test_a_rotor_beside_a_reading_is_none(lacking: Lacking) -> None:
    """Only their difference is told: the smallest pair, not an inertia that nobody measured."""
    found = fit(*lacking, READINGS)
    layout = ColumnLayout(6, READINGS)
    assert found.theta[layout.drive("rotor")][3:].max() < 1e-3
    assert found.theta[layout.extra(READINGS[0])][0] > 0.5 * LACKS[3]
