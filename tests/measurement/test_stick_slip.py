"""Stretches in which a joint sticks and slips are left out; others are not."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion import standstill
from irb2400_ctrl.measurement.prepared_log import prepare

TIME = np.arange(0.0, 12.0, 0.004)


def between(start: float, stop: float) -> np.ndarray:
    return (start < TIME) & (stop > TIME)


CHATTER = between(4.0, 6.0)


def slowly(chatter: np.ndarray) -> np.ndarray:
    """Which samples of a slow joint are known whose torque jumps where it chatters; and when."""
    draw = np.random.default_rng(4)
    tau = np.full((len(TIME), 6), 20.0) + draw.normal(0.0, 0.3, (len(TIME), 6))
    tau[chatter, 0] += 8.0 * draw.choice([-1.0, 1.0], chatter.sum())
    motion = prepare(Log(TIME, np.outer(0.05 * TIME, np.ones(6)), tau, name="drawn"))
    return np.column_stack([motion.time, motion.known[:, 0]])


def test_a_joint_turns_at_the_sample_before_it_goes_back() -> None:
    speed = np.array([[0.5, 0.5], [0.2, 0.5], [-0.2, 1e-6], [-0.5, 0.5]])
    told = standstill.turning(speed)
    assert told[:, 0].tolist() == [False, True, False, False]
    assert told[:, 1].tolist() == [False, False, True, False]


def test_a_short_burst_stays_known() -> None:
    assert slowly(between(5.0, 5.2))[:, 1].all()


def test_a_joint_that_slips_nearly_all_the_time_is_left_out() -> None:
    time, there = slowly(between(0.0, 10.2)).T
    assert not there[time < 9.8].any()
    assert there[time > 10.5].all()


def known(speed: float, jump: float) -> np.ndarray:
    """Share of known samples within the stretch, of a joint at a steady speed whose torque there
    jumps from sample to sample; and elsewhere."""
    draw = np.random.default_rng(4)
    q = np.outer(speed * TIME, np.ones(6)) + 0.2 * np.sin(0.5 * TIME)[:, None] * [0, 1, 1, 1, 1, 1]
    tau = 20.0 + draw.normal(0.0, 0.3, (len(TIME), 6))
    tau[CHATTER, 0] += jump * draw.choice([-1.0, 1.0], CHATTER.sum())
    motion = prepare(Log(TIME, q, tau, name="drawn"))
    inside = (motion.time > 4.3) & (motion.time < 5.7)
    outside = (motion.time < 3.0) | (motion.time > 7.0)
    return np.array([motion.known[inside, 0].mean(), motion.known[outside, 0].mean()])


@pytest.mark.parametrize(
    ("speed", "jump", "expected"),
    [
        (0.05, 8.0, (0.0, 1.0)),  # sticks and slips
        (0.05, 0.0, (1.0, 1.0)),  # creeps without a jump
        (0.30, 8.0, (1.0, 1.0)),  # too fast to stick: a fault that is to be found
    ],
)
def test_only_jumping_torque_of_a_slow_joint_is_left_out(speed, jump, expected) -> None:
    assert known(speed, jump) == pytest.approx(expected)


def test_the_rows_of_the_fit_leave_it_out_too() -> None:
    draw = np.random.default_rng(4)
    tau = np.full((len(TIME), 6), 20.0) + draw.normal(0.0, 0.3, (len(TIME), 6))
    tau[CHATTER, 0] += 8.0 * draw.choice([-1.0, 1.0], CHATTER.sum())
    motion = prepare(Log(TIME, np.outer(0.05 * TIME, np.ones(6)), tau, name="drawn"))
    inside = (motion.row_time > 4.3) & (motion.row_time < 5.7)
    assert not motion.row_known[inside, 0].any()
    assert motion.row_known[inside, 1].all()


def turning(swing: float, commanded: bool = False) -> np.ndarray:
    """Which rows of two joints are known around a turn at 6 s, where the first swings by `swing`
    [rad] and back within what its angles are smoothed over, as a poor servo does when its dry
    friction turns over."""
    smooth = -0.5 * np.cos(2.0 * (TIME - 6.0))
    after = TIME - 6.0
    swinging = swing * np.exp(-((after / 0.04) ** 2)) * np.sin(2 * np.pi * 12.0 * after)
    q = np.column_stack([smooth + swinging, *[smooth] * 5])
    tau = 20.0 + np.random.default_rng(4).normal(0.0, 0.3, (len(TIME), 6))
    motion = prepare(Log(TIME, q, tau, q_ref=q if commanded else None, name="drawn"))
    there = np.abs(motion.row_time - 6.0) < 0.06
    return motion.row_known[there][:, :2]


def test_between_turns_that_the_smoothing_does_not_tell_apart_nothing_is_known() -> None:
    """A sound UR10e was told a hysteresis of axis 5 at 0.95 from it."""
    swung = turning(0.005)
    assert not swung[:, 0].any()
    assert swung[:, 1].all()
    # what a single turn does is seen, and a command is known without smoothing
    assert turning(0.0).all()
    assert turning(0.005, commanded=True).all()
