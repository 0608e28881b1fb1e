"""The angle of a joint is recorded late, and what a robot with that should show."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names
from diagnosis.test_parts import BASES, motion
from third_plant.case import Case
from third_plant.suites import plan

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque, predicted_torque
from irb2400_ctrl.effects.time_delay import TimeDelay
from irb2400_ctrl.measurement import Log


@pytest.mark.parametrize("joint", [1, 2, 4])
def test_a_late_angle_is_the_law_on_all_joints_to_first_order(joint: int) -> None:
    """Held against the model at the angles of that time; the jumps of the joint's own dry friction,
    which no first order has, are left out."""
    m = motion()
    late = TimeDelay(joint=joint, delay_s=5e-4, of_angle=True)
    shown = predicted_torque(ROBOT.with_effects(late), m) - predicted_torque(ROBOT, m)
    law = effect_torque(BASES, late, m)
    calm = np.abs(m.qd[:, joint - 1]) > 0.1
    calm &= np.convolve(~calm, np.ones(61), "same") < 0.5
    calm[-5:] = False  # what comes after the record is not known
    size = np.sqrt(np.mean(shown[calm] ** 2, axis=0))
    error = np.sqrt(np.mean((shown - law)[calm] ** 2, axis=0))
    assert calm.sum() > 500
    assert (size > 1e-4).sum() >= 3
    assert (error < 0.05 * size + 1e-6).all()


def test_the_rates_of_all_joints_are_that_of_the_torque() -> None:
    signals = BASES.signals
    rates = signals.symbol("tau_rates"), signals.symbol("tau_rate")
    assert [one.shape for one in rates] == [(6, 6), (6, 1)]
    m = motion()
    numbers = signals.numbers(["tau_rates", "tau_rate"], m)[len(signals.scalars) :]
    whole = np.zeros((6, len(m.time)))
    for row, number in zip(rates[0].sparsity().row(), numbers, strict=False):
        whole[row] += number
    np.testing.assert_allclose(whole, numbers[-6:], atol=1e-6 * np.abs(whole).max())


@pytest.mark.parametrize(
    ("suite", "number", "delay", "joint"),
    [("single", 10, 0.0057, 5), pytest.param("pairs", 8, 0.0071, 3, marks=pytest.mark.slow)],
)
def test_an_angle_that_is_late_is_named(suite: str, number: int, delay: float, joint: int) -> None:
    """It moves the torques of all joints; the delay of its own torque did not explain that."""
    (arm,) = (one for one in plan(20261701) if (one.suite, one.number) == (suite, number))
    case = Case(arm)
    seen = case.identification()
    found = diagnose(ROBOT, Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref))
    assert set(names(found)) == {(t.kind, t.joint) for t in case.truth}
    effect: Any = next(f.effect for f in found.findings if f.effect.kind == "time_delay")
    assert (effect.joint, effect.of_angle) == (joint, True)
    assert effect.delay_s == pytest.approx(delay, abs=3e-4)
