"""A gain multiplies what the robot's numbers say after they moved, not as the file gives them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, ROBOT, motion
from independent_plant import Case, Effect
from plant_logs import of_second_plant

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.effect_parameters import parameters_of
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.estimation.fit import Fitter
from irb2400_ctrl.diagnosis.estimation.held_out import HeldOut
from irb2400_ctrl.diagnosis.estimation.through_chain import shown_of, slope_of_shown
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log

GAIN = 0.7
MOVED = 1.5
"""of the base's column"""


def test_a_gain_is_found_beside_numbers_that_are_far_off() -> None:
    """Of a Panda, whose friction the file does not give, axis 5 was told a gain of 0.6 with 39 % of
    its torque left, where 12 % are without it."""
    m = motion()
    # dry friction of joint 5 that the file lacks, as large as its torque
    column = np.zeros((len(m.time), m.n, 1))
    column[:, 4, 0] = 3.0 * np.tanh(m.qd[:, 4] / 0.05)
    given = predicted_torque(ROBOT, m)
    truth = given + MOVED * column[:, :, 0]
    truth[:, 4] *= GAIN
    rng = np.random.default_rng(4)
    read = truth + 0.05 * rng.standard_normal(truth.shape)
    m = replace(m, tau=read, tau_smooth=read)
    effect = LIBRARY["torque_gain"].of(5, gain=0.95)
    nothing = RegressorColumns((4,), np.zeros((m.rows, 1, 1)))
    score = Score(0.0, np.zeros(1), np.zeros(0))
    candidate = Candidate("torque_gain", 5, "", (), (effect,), nothing, None, score)
    Z = m.filtered(column)
    fit = Fitter(ROBOT, BASES, m, Z, np.zeros((m.rows, m.n), dtype=bool)).fit([candidate])
    assert fit.effects[0].coefficients() == pytest.approx((GAIN - 1.0,), abs=0.01)
    assert fit.z == pytest.approx([MOVED], abs=0.02)
    # what it leaves is what the robot with these numbers leaves
    told = given + fit.z[0] * column[:, :, 0]
    told[:, 4] = fit.effects[0].reported(m.time, told)[:, 4]
    left = m.filtered(read - told)[:, 4]
    # but for what its discrepancy takes
    np.testing.assert_allclose(fit.residual[:, 4], left, atol=0.01)
    assert np.std(left) < 0.03


def test_by_how_much_a_reading_grows() -> None:
    rows: Any = SimpleNamespace(row_time=np.array([0.0, 1.0, 2.0]), rows=3, n=3)
    gain = LIBRARY["torque_gain"].of(2, gain=0.8, windows_s=((0.5, 1.5),))
    offset = LIBRARY["torque_offset"].of(1, offset_Nm=5.0)
    shown = shown_of([gain, offset, gain], rows)
    expected = np.ones((3, 3))
    expected[1, 1] = 0.64
    np.testing.assert_allclose(shown, expected, atol=1e-12)
    (parameter,) = [p for p in parameters_of(gain, 0) if p.name == "gain"]
    slope = slope_of_shown(gain, parameter, rows)
    np.testing.assert_allclose(slope, (expected != 1.0) * 1.0, atol=1e-9)
    (parameter,) = parameters_of(offset, 0)
    assert not slope_of_shown(offset, parameter, rows).any()


def test_unseen_rows_are_told_with_the_gain_of_numbers_that_moved() -> None:
    """Sample by sample the robot's file holds gain times (given + moved)."""
    m = motion()
    column = np.zeros((len(m.time), m.n, 1))
    column[:, 4, 0] = 3.0 * np.tanh(m.qd[:, 4] / 0.05)
    truth = predicted_torque(ROBOT, m) + MOVED * column[:, :, 0]
    truth[:, 4] *= GAIN
    read = truth + 0.05 * np.random.default_rng(4).standard_normal(truth.shape)
    m = replace(m, tau=read, tau_smooth=read)
    effect = LIBRARY["torque_gain"].of(5, gain=0.75)
    nothing = RegressorColumns((4,), np.zeros((m.rows, 1, 1)))
    score = Score(0.0, np.zeros(1), np.zeros(0))
    chosen = [Candidate("torque_gain", 5, "", (), (effect,), nothing, None, score)]
    plain: Any = SimpleNamespace(
        torque=lambda b, rows: m.recorded_rows(column)[rows] @ b,
        samples=column,
    )
    calm = np.zeros((m.rows, m.n), dtype=bool)
    fitter = Fitter(ROBOT, BASES, m, m.filtered(column), calm, 1, plain)
    held_out = HeldOut(fitter, chosen, fitter.fit(chosen))
    told = held_out._told(held_out.fit, held_out._found)[:, 4]
    assert np.sqrt(np.mean(told**2)) < 0.1


def test_unseen_rows_are_told_with_the_departures_that_were_fitted() -> None:
    """Of what no file keeps a fit takes that which the law cannot give, and so does what is told
    sample by sample: else a term in tau |tau| is there twice."""
    m = motion()
    calm = np.zeros((m.rows, m.n), dtype=bool)
    fitter = Fitter(ROBOT, BASES, m, m.filtered(np.zeros((len(m.time), m.n, 1))), calm)
    effect = LIBRARY["torque_gain"].of(2, gain=1.1)
    fitted, told = (fitter.departures(effect, filtered=one)[:, 1, 0] for one in (True, False))
    law = fitter.placed(effect)[:, 1, 0]
    assert abs(law @ fitted) < 1e-9 * np.linalg.norm(law) * np.linalg.norm(fitted)
    # the filter changes a slow torque little
    assert np.corrcoef(fitted, told)[0, 1] > 0.98
    plain = fitter.placed(effect, discrepancy=True, filtered=False)[:, 1, 0]
    assert np.linalg.norm(plain) > 2.0 * np.linalg.norm(told)


@pytest.mark.slow
def test_a_gain_of_an_axis_that_bears_its_weight_is_named() -> None:
    """It was worth 166 nats on unseen rows and -652 by what was told: a mass of the parallelogram
    was there instead."""
    found = of_second_plant(20263580, "pairs/2")
    assert {(f.effect.kind, f.effect.joint) for f in found.findings} == {
        ("torque_gain", 3),
        ("cable_spring", 6),
    }


def test_a_gain_is_told_as_it_is_without_what_no_file_keeps() -> None:
    """Beside a term in tau |tau|, which axis 2 under its weight can hardly tell from the torque, it
    was 0.830 with errors of 0.003 for 0.85, and the robot with it wrong by 7.0 Nm."""
    logs = [
        Log(one.time, one.q, one.tau, q_ref=one.q_ref)
        for one in Case(
            7, (Effect("torque_gain", 2, 0.15),), duration=16.0, validation_duration=8.0
        ).simulate()
    ]
    found = diagnose(ROBOT, *logs)
    (name,) = found.findings
    assert name.effect.parameters()["gain"] == pytest.approx(0.85, abs=0.009)
    assert found.identification.error_after.rmse[1] < 1.3 * found.identification.noise_floor[1]
    assert found.validation is not None
    assert found.validation.error_after.rmse[1] < 0.12 * found.validation.error_before.rmse[1]
