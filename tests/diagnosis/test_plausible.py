"""What diagnosis refuses to name, and how sure it lets itself be."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.estimation.candidate import plausible
from irb2400_ctrl.diagnosis.estimation.effect_parameters import moved, parameters_of
from irb2400_ctrl.effects import LIBRARY


@pytest.mark.parametrize(
    ("joint", "delay", "named"),
    [
        (None, 0.0005, False),
        (None, 0.001, True),
        (None, -0.001, False),
        (None, -0.002, False),
        (None, -0.004, True),
        (1, 0.001, False),
        (1, 0.003, True),
    ],
)
def test_a_delay_below_the_truth_of_the_time_stamps_is_not_named(
    joint: int | None, delay: float, named: bool
) -> None:
    there = {} if joint is None else {"of_angle": False}
    assert (plausible("time_delay", joint, np.array([delay]), there) is not None) == named


@pytest.mark.parametrize(
    ("delay", "named"), [(0.002, False), (0.004, True), (-0.001, False), (-0.004, False)]
)
def test_a_late_angle_looks_like_a_torque_ahead_of_it(delay: float, named: bool) -> None:
    """The misfit of a torque that is held from sample to sample is the other way round, and liquids
    at the tool were angles ahead of their time."""
    late = plausible("time_delay", 2, np.array([delay]), {"of_angle": True})
    assert (late is not None) == named


@pytest.mark.parametrize(
    ("swing", "twist", "named"),
    [(1.0, 1.0, True), (0.7, 0.9, True), (0.0, 0.8, False), (0.01, 0.5, False), (0.2, 0.1, True)],
)
def test_what_twists_and_does_not_swing_is_no_spring(
    swing: float, twist: float, named: bool
) -> None:
    """Play of axis 1 was 0.0 and 0.8, a liquid at the tool 0.0 and 0.2."""
    there = {"stiffness_Nm_rad": 1e5, "damping_ratio": 0.04}
    spring = plausible("elastic_joint", 1, np.array([swing, twist]), there)
    assert (spring is not None) == named


def test_bounds_of_the_physics_hold() -> None:
    assert plausible("rotor_inertia", 1, np.array([-1.0]), {}) is None
    assert plausible("rotor_inertia", 1, np.array([1.0]), {}) is not None


def test_what_repeats_less_than_four_times_a_turn_is_no_ripple() -> None:
    """A fit that follows the order down arrives at a balancer (0.59 on axis 2 of a KR300)."""
    size = np.array([3.0, 4.0])
    assert plausible("gear_ripple", 2, size, {"order": 4.0}) is not None
    assert plausible("gear_ripple", 2, size, {"order": 3.4}) is None
    ripple = LIBRARY["gear_ripple"].of(2, amplitude_Nm=5.0, order=4.0)
    order = next(p for p in parameters_of(ripple, 0) if p.name == "order")
    (kept,) = moved([ripple], [order], np.array([-3.0]), 30.0) or ()
    assert kept.order > 3.5


def test_a_loop_on_top_of_more_dry_friction_is_a_hysteresis_and_a_small_one_is_not() -> None:
    """Slip at many travels turns over steeply at first: as much again, of 15 Nm at up to 12 mrad
    of axis 2 as much again and a half, seems to be dry friction."""
    width = {"width_rad": 0.028}
    assert plausible("hysteresis", 5, np.array([2.4, -2.1]), width) is not None
    assert plausible("hysteresis", 2, np.array([6.6, -10.65]), width) is not None
    assert plausible("hysteresis", 5, np.array([2.4, -6.1]), width) is None


def test_a_time_constant_stays_within_the_record() -> None:
    """Grease that warms at two rates would end beyond it, and be refused."""
    warm = LIBRARY["viscous_warmup"].of(1, viscous_Nms_rad=5.0, time_constant_s=28.0)
    constant = next(p for p in parameters_of(warm, 0) if p.name == "time_constant_s")
    (kept,) = moved([warm], [constant], np.array([20.0]), 30.0) or ()
    assert kept.time_constant_s == 30.0
