"""The recorded speed stands in for differentiated angles where these came at other instants than
their stamps say, and nowhere else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.measurement.motion.commanded import used_angles
from irb2400_ctrl.measurement.motion.recorded_speed import polled
from irb2400_ctrl.measurement.prepared_log import UNEVEN, PreparedLog, prepare
from irb2400_ctrl.measurement.uniform import resample, smoothed
from irb2400_ctrl.wording import numbered

STEP = 0.001
STAMPS = np.arange(0.0, 8.0, STEP)


def angles(time: np.ndarray, order: int = 0) -> np.ndarray:
    """Three joints, or a derivative of them."""
    turned = np.pi / 2 * order
    slow = 1.7**order * np.sin(1.7 * time[:, None] + np.arange(3) + turned)
    return np.asarray(slow + 0.2 * 5.0**order * np.sin(5.0 * time[:, None] + turned))


def polled_at(seed: int = 0) -> np.ndarray:
    """Instants of the samples that a host found: now and then one too old or too new."""
    late = np.random.default_rng(seed).choice([-1, 0, 1], size=len(STAMPS), p=[0.05, 0.9, 0.05])
    return STAMPS + STEP * late


def log_of(true: np.ndarray, speed: Callable[[np.ndarray], np.ndarray] | None) -> Log:
    qd = None if speed is None else speed(true)
    tau = np.random.default_rng(3).standard_normal((len(true), 3))
    return Log(STAMPS, angles(true), tau, qd=qd)


def as_it_is(time: np.ndarray) -> np.ndarray:
    noise = 5e-4 * np.random.default_rng(7).standard_normal((len(time), 3))
    return angles(time, 1) + noise


def off(motion: PreparedLog) -> float:
    return float(np.sqrt(np.mean((motion.qdd - angles(motion.time, 2)) ** 2)))


def test_of_a_polled_robot_the_recorded_speed_is_taken() -> None:
    true = polled_at()
    by_angle, by_speed = (prepare(log_of(true, speed)) for speed in (None, as_it_is))
    assert (by_angle.by_speed, by_speed.by_speed) == (False, True)
    # its noise is what is left: smoothed, 0.07 rad/s2
    assert off(by_speed) < 0.1 < 0.3 * off(by_angle)
    np.testing.assert_array_equal(by_speed.q, by_angle.q)
    assert by_speed.qdddd.shape == by_speed.q.shape
    assert by_speed.remarks == (UNEVEN,)
    assert by_angle.remarks == ()


@pytest.mark.parametrize(("noise", "taken"), [(0.022, True), (0.0265, False)])
def test_a_speed_must_be_twice_as_calm(noise: float, taken: bool) -> None:
    rough = noise * np.random.default_rng(7).standard_normal((len(STAMPS), 3))
    assert prepare(log_of(polled_at(), lambda time: angles(time, 1) + rough)).by_speed == taken


def test_of_several_logs_one_is_enough_to_say_so() -> None:
    logs = [log_of(STAMPS, as_it_is), log_of(polled_at(), as_it_is)]
    assert prepare_together(logs).by_speed
    assert not prepare_together(logs[:1] * 2).by_speed


@pytest.mark.parametrize(
    "speed",
    [
        # in degrees; a twentieth and more; late by a filter; one joint dead; of the other direction
        lambda time: np.degrees(as_it_is(time)),
        lambda time: 1.06 * as_it_is(time),
        lambda time: as_it_is(time - 0.012),
        lambda time: as_it_is(time) * [1.0, 1.0, 0.0],
        lambda time: as_it_is(time) * [1.0, -1.0, 1.0],
        lambda time: as_it_is(time) * [1.0, 1.0, 1.13],
        # of another zero
        lambda time: as_it_is(time) + np.array([0.0, 0.3, 0.0]),
        # through a real filter of 20 ms
        lambda time: lfilter([0.05], [1.0, -0.95], as_it_is(time), axis=0),
    ],
)
def test_a_speed_that_says_something_else_is_left_alone(
    speed: Callable[[np.ndarray], np.ndarray],
) -> None:
    assert not prepare(log_of(polled_at(), speed)).by_speed


def test_a_host_that_counts_too_little_time_is_no_other_speed() -> None:
    assert prepare(log_of(polled_at(), lambda time: 0.97 * as_it_is(time - 0.003))).by_speed


def test_evenly_sampled_angles_stay() -> None:
    assert not prepare(log_of(STAMPS, as_it_is)).by_speed


def test_a_calm_speed_alone_is_no_reason() -> None:
    """Coarse angles are rough as well: without rows read twice a filtered or commanded speed would
    be taken."""
    even = log_of(STAMPS, as_it_is)
    coarse = replace(even, q=np.round(even.q / 3.5e-4) * 3.5e-4)
    assert not prepare(coarse).by_speed
    # nor are rows that repeat because nothing has moved by a digit
    assert not polled(replace(even, q=np.round(even.q / 1e-2) * 1e-2))
    assert polled(log_of(polled_at(), as_it_is))


def test_a_gap_changes_nothing() -> None:
    for true, taken in ((polled_at(), True), (STAMPS, False)):
        log = log_of(true, as_it_is)
        rows = (STAMPS < 3.0) | (STAMPS > 3.6)
        assert log.qd is not None
        cut = Log(log.time[rows], log.q[rows], log.tau[rows], qd=log.qd[rows])
        assert prepare(cut).by_speed == taken


def test_a_joint_that_rests_has_no_speed() -> None:
    log = log_of(polled_at(), as_it_is)
    assert log.qd is not None
    resting = log.q * [1.0, 1.0, 0.0]
    assert prepare(replace(log, q=resting, qd=log.qd * [1.0, 1.0, 0.0])).by_speed
    stuck = log.qd * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.2]
    assert not prepare(replace(log, q=resting, qd=stuck)).by_speed


def test_a_commanded_motion_stays() -> None:
    true = polled_at()
    log = log_of(true, as_it_is)
    with_reference = Log(log.time, angles(STAMPS), log.tau, qd=log.qd, q_ref=angles(STAMPS))
    motion = prepare(with_reference)
    assert motion.instrumented
    assert not motion.by_speed
    assert not motion.from_measured


@pytest.mark.parametrize(("share", "commanded"), [(1.3, True), (1.7, False)])
def test_of_a_slow_log_half_as_much_again_as_noise_is_motion(share: float, commanded: bool) -> None:
    """What the smoothing leaves of the noise on samples at 50 Hz is no lag of a servo."""
    time = np.arange(0.0, 20.0, 0.02)
    noise = 1e-4 * np.random.default_rng(5).standard_normal((len(time), 1))
    grid = resample(Log(time, noise, noise))
    left = smoothed(grid.q, grid.step).std() * np.sqrt(2.0 * (share**2 - 1.0))
    log = Log(time, noise + left * np.sin(3.0 * time[:, None]), noise, q_ref=0.0 * noise)
    assert used_angles(resample(log), log)[1] == commanded


def test_it_is_said_why_the_motion_is_the_measured_one() -> None:
    true = polled_at()
    log = log_of(true, as_it_is)
    (said,) = prepare(log).from_measured
    assert said.startswith("no commanded motion (q_ref)")
    other = replace(log, q_ref=angles(STAMPS)[:, ::-1])
    (said,) = prepare(other).from_measured
    assert said.startswith("not as commanded (q_ref): joint 1; ")
    # of several logs the joints of each
    third = replace(log, q_ref=angles(STAMPS)[:, [0, 1, 0]] ** 2)
    one = prepare(third).disobeying
    assert one
    assert one != prepare(other).disobeying
    both = prepare_together([other, third])
    assert both.disobeying == tuple(sorted({1, *one}))
    names = numbered("joint", both.disobeying)
    assert names.startswith("joints 1")
    assert both.from_measured[0].startswith(f"not as commanded (q_ref): {names}; ")


def test_an_arm_that_rests_has_no_speed_to_compare() -> None:
    still = np.zeros((len(STAMPS), 3))
    assert not prepare(Log(STAMPS, still, still + 1.0, qd=still)).by_speed
