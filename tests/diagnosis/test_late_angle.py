"""The angle of a joint is recorded late, and what a robot with that should show."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names
from diagnosis.test_parts import BASES, motion
from plant_logs import case_of, diagnosed

from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.ground import Ground
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque, predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.time_delay import TimeDelay

BARE: Any = (
    RegressorColumns((3,), np.ones((4, 1, 1))),
    None,
    Score(0.0, np.ones(1), np.zeros(0)),
)
"""columns and score of a candidate of which neither is asked"""


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
    case = case_of(20261701, f"{suite}/{number}")
    found = diagnosed(case)
    assert set(names(found)) == {(t.kind, t.joint) for t in case.truth}
    effect: Any = next(f.effect for f in found.findings if f.effect.kind == "time_delay")
    assert (effect.joint, effect.of_angle) == (joint, True)
    assert effect.delay_s == pytest.approx(delay, abs=3e-4)


@pytest.mark.parametrize(
    ("kind", "at", "gain", "beside", "chosen", "lags"),
    [
        # a soft axis 4 was an angle 16 ms late at 0.97, of which the spring alone said 324 nats
        ("elastic_joint", 4, 324.0, 22.1, False, True),
        # an angle 7 ms late was a spring of 504 nats, which beside it says nothing
        ("elastic_joint", 4, 504.0, 21.9, False, False),
        ("transmission_backlash", 4, 22.1, 22.1, False, True),
        ("elastic_joint", 4, 21.9, 22.1, False, False),
        ("elastic_joint", 4, 0.0, 0.0, True, True),
        ("elastic_joint", 3, 324.0, 324.0, False, False),
        ("elastic_joint", 3, 324.0, 324.0, True, False),
        ("torque_offset", 4, 324.0, 324.0, False, False),
    ],
)
def test_a_link_behind_a_spring_is_no_late_angle(
    kind: str, at: int, gain: float, beside: float, chosen: bool, lags: bool
) -> None:
    effects = (LIBRARY[kind].of(at, **LIBRARY[kind].example),)
    other = Candidate(kind, at, kind, (), effects, *BARE)

    def beside_lateness(candidate: Candidate, columns: Any) -> float:
        assert columns.shape == (4, 6, 1)
        assert columns[:, 3].any()
        return beside

    comparison: Any = SimpleNamespace(
        chosen=[other] if chosen else [],
        gain=lambda one: one.evidence,
        gain_beside=beside_lateness,
        n=6,
    )
    ground: Any = SimpleNamespace(
        comparison=comparison, threshold=SimpleNamespace(criteria=Criteria())
    )

    def said(of_angle: bool) -> bool:
        delay = TimeDelay(joint=4, delay_s=0.016, of_angle=of_angle)
        candidate = Candidate("time_delay", 4, "time_delay", (), (delay,), *BARE)
        late = Alternative(candidate, 100.0, 100.0)
        every = [late] if chosen else [late, Alternative(other, gain, gain)]
        return Ground.lags_on_a_spring(ground, late, every)

    assert said(of_angle=True) == lags
    assert not said(of_angle=False)


def test_a_late_angle_has_a_joint() -> None:
    with pytest.raises(ValueError, match="of_angle: found no joint; expected the joint whose"):
        TimeDelay(delay_s=0.004, of_angle=True)
