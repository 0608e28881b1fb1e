"""A log that moves a joint at one speed does not say how its friction bends with speed."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import motion

import irb2400_ctrl as irb
from irb2400_ctrl.identification.fitting.choice import Choice
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.moments import moments, recordings

PHASE = np.linspace(0.0, 2.0 * np.pi, 400)
WAY = np.sign(np.sin(PHASE))


@pytest.mark.parametrize(
    ("speed", "apart"),
    [
        (0.4 * WAY, False),
        (0.4 * WAY + 0.06 * np.sin(7.0 * PHASE), False),
        (0.3 * WAY + 0.1, True),
        (0.4 * np.sin(PHASE), True),
    ],
)
def test_speeds_of_a_joint(speed: np.ndarray, apart: bool) -> None:
    """Three arms that were moved at one speed got a friction that left 1.2 times as much of others
    of their recordings as none of it."""
    robot = irb.load_robot("irb2400")
    extra = Extra("power", 2)
    layout = ColumnLayout(robot.n, (extra,))
    m = motion()
    qd = np.ones((len(m.time), robot.n))
    qd[:, 1] = np.resize(speed, len(m.time))
    sums = moments(irb.Model(robot), layout, recordings([replace(m, qd=qd)]))
    choice: Any = SimpleNamespace(sums=sums, whole=layout)
    assert Choice._speeds_apart(choice, extra) == apart
