"""A clock that is late tells what the robot's numbers say after they moved late, too: with friction
that a file lacks a delay of 40 ms made a rotor half as large (53 standard errors off, at 0.98)."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, ROBOT, motion

from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.effect_parameters import parameters_of
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.estimation.fit import Fitter
from irb2400_ctrl.diagnosis.estimation.held_out import HeldOut
from irb2400_ctrl.diagnosis.estimation.through_chain import (
    MovedBase,
    delayed,
    slope_of_delayed,
)
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY

DELAY = 0.024
MOVED = 1.5
"""of the base's column"""


def fitted(joint: int | None) -> tuple[Any, Any, Any]:
    """Friction of joints 1 and 5 that the file lacks, and a delay; fit, fitter, chosen."""
    m = motion()
    column = np.zeros((len(m.time), m.n, 1))
    for j, size in ((0, 90.0), (4, 6.0)):
        column[:, j, 0] = size * np.tanh(m.qd[:, j] / 0.05)
    truth = predicted_torque(ROBOT, m) + MOVED * column[:, :, 0]
    late = LIBRARY["time_delay"].of(joint, delay_s=DELAY)
    read = late.reported(m.time, truth)
    read = read + 0.05 * np.random.default_rng(4).standard_normal(truth.shape)
    m = replace(m, tau=read, tau_smooth=read)
    start = LIBRARY["time_delay"].of(joint, delay_s=0.5 * DELAY)
    nothing = RegressorColumns((4,), np.zeros((m.rows, 1, 1)))
    score = Score(0.0, np.zeros(1), np.zeros(0))
    chosen = [Candidate("time_delay", joint, "", (), (start,), nothing, None, score)]
    plain: Any = SimpleNamespace(
        torque=lambda b, rows: m.recorded_rows(column)[rows] @ b, samples=column
    )
    calm = np.zeros((m.rows, m.n), dtype=bool)
    fitter = Fitter(ROBOT, BASES, m, m.filtered(column), calm, 1, plain)
    return fitter.fit(chosen), fitter, chosen


@pytest.mark.parametrize("joint", [None, 5])
def test_a_delay_is_found_beside_numbers_that_are_far_off(joint: int | None) -> None:
    fit, fitter, chosen = fitted(joint)
    assert fit.effects[0].delay_s == pytest.approx(DELAY, abs=2e-4)
    assert fit.z == pytest.approx([MOVED], abs=0.01)
    assert np.sqrt(np.mean(fit.residual**2)) < 0.05
    # and so are unseen rows, sample by sample
    held_out = HeldOut(fitter, chosen, fit)
    told = held_out._told(fit, held_out._found)
    assert np.sqrt(np.mean(told[:, 4] ** 2)) < 0.1


def test_what_clocks_change() -> None:
    m = motion()
    torque = np.sin(2.0 * m.time)[:, None] * np.arange(1.0, 7.0)
    late = LIBRARY["time_delay"].of(3, delay_s=0.02)
    offset = LIBRARY["torque_offset"].of(3, offset_Nm=5.0)
    found = delayed([late, offset], torque, m)
    assert not found[:, [0, 1, 3, 4, 5]].any()
    inside = m.time > m.time[0] + 0.02
    expected = 3.0 * (np.sin(2.0 * (m.time - 0.02)) - np.sin(2.0 * m.time))
    np.testing.assert_allclose(found[inside, 2], expected[inside], atol=1e-4)
    (parameter,) = [p for p in parameters_of(late, 0) if p.name == "delay_s"]
    slope = slope_of_delayed(late, parameter, torque, m)
    rate = m.filtered(-6.0 * np.cos(2.0 * (m.time - 0.02))[:, None] * np.ones(6))
    np.testing.assert_allclose(slope[5:-5, 2], rate[5:-5, 2], atol=0.02)


def test_a_base_of_which_no_samples_are_known_is_told_in_time() -> None:
    m = motion()
    rows = np.ones((m.rows, m.n))
    late = LIBRARY["time_delay"].of(None, delay_s=0.02)
    assert not MovedBase(m, rows, None).later([late]).any()
    assert not MovedBase(m, rows, np.ones(m.q.shape)).later([]).any()
    (parameter,) = [p for p in parameters_of(late, 0) if p.name == "delay_s"]
    assert not MovedBase(m, rows, None).slope(late, parameter).any()
