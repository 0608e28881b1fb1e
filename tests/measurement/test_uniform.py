"""Resampling, filters, derivatives, servo response."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.commanded import followed, used_angles
from irb2400_ctrl.measurement.uniform import (
    LowPass,
    _covered,
    derivative_margin,
    derivatives,
    polished,
    resample,
    smoothed,
    widened,
)


def log_at(time: np.ndarray, lag: float = 0.0) -> Log:
    def motion(t: np.ndarray) -> np.ndarray:
        return np.sin(2.0 * t[:, None] + np.arange(6)) + 0.1 * np.sin(9.0 * t[:, None])

    return Log(
        time, motion(time - lag), np.cos(time[:, None] * np.arange(1, 7)), q_ref=motion(time)
    )


@pytest.mark.parametrize("rate", [50.0, 100.0, 250.0, 500.0, 1000.0])
def test_any_rate_comes_to_the_same_motion(rate: float) -> None:
    log = resample(log_at(np.arange(0.0, 8.0, 1 / rate)))
    exact = log_at(log.time)
    assert 200.0 <= log.rate <= 250.0 + 1e-9
    assert log.valid.all()
    inside = slice(20, -20)
    np.testing.assert_allclose(log.q[inside], exact.q[inside], atol=3e-5)


def test_an_even_log_is_taken_as_it_stands() -> None:
    """Stamps that are printed coarsely are no reason to make samples of one's own."""
    even = np.arange(0.0, 8.0, 0.004)
    shaken = even + np.random.default_rng(0).uniform(-1e-4, 1e-4, len(even))
    shaken[[0, -1]] = even[[0, -1]]
    log = log_at(shaken)
    found = resample(log, rate=250.0)
    np.testing.assert_array_equal(found.q, log.q)
    np.testing.assert_array_equal(found.tau, log.tau)


def test_a_mask_is_widened_to_both_sides() -> None:
    mask = np.arange(9) == 4
    assert np.flatnonzero(widened(mask, 2)).tolist() == [2, 3, 4, 5, 6]
    assert widened(mask, 0).tolist() == mask.tolist()
    assert not widened(mask & False, 2).any()


def test_jitter_and_lost_samples_are_bridged_and_gaps_are_marked() -> None:
    rng = np.random.default_rng(1)
    time = np.arange(0.0, 10.0, 0.004)
    time = time + np.append(0.0, rng.uniform(-0.001, 0.001, len(time) - 1))
    keep = rng.uniform(size=len(time)) > 0.02
    keep[(time > 4.0) & (time < 4.5)] = False
    keep[[0, -1]] = True
    log = resample(log_at(time[keep]), rate=250.0)
    hole = (log.time > 4.02) & (log.time < 4.48)
    assert not log.valid[hole].any()
    assert log.valid[(log.time < 3.95) | (log.time > 4.55)].mean() > 0.999
    np.testing.assert_allclose(log.q[log.valid], log_at(log.time).q[log.valid], atol=1e-5)


def test_differences_converge_with_fourth_order() -> None:
    errors = []
    for step in (0.008, 0.004):
        t = np.arange(0.0, 4.0, step)
        _, d1, d2, *_ = derivatives(np.sin(12.0 * t)[:, None], step)
        inside = slice(20, -20)
        errors.append(
            [
                np.abs(d1[inside, 0] - 12 * np.cos(12 * t[inside])).max(),
                np.abs(d2[inside, 0] + 144 * np.sin(12 * t[inside])).max(),
            ]
        )
    np.testing.assert_allclose(np.array(errors[0]) / errors[1], 16.0, rtol=0.15)


@pytest.mark.parametrize("smooth", [smoothed, polished])
def test_smoothing_has_no_phase_and_unit_gain_at_rest(smooth) -> None:
    t = np.arange(0.0, 4.0, 0.004)
    slow = np.sin(2 * np.pi * 0.5 * t)[:, None]
    margin = derivative_margin(0.004)
    np.testing.assert_allclose(smooth(slow, 0.004)[margin:-margin], slow[margin:-margin], atol=2e-3)
    np.testing.assert_allclose(smooth(np.ones((500, 2)), 0.004), 1.0, atol=1e-12)


def test_low_pass_passes_the_slow_and_stops_the_fast() -> None:
    low_pass = LowPass(10.0, 0.004)
    t = np.arange(0.0, 10.0, 0.004)
    for frequency, low, high in ((1.0, 0.99, 1.01), (30.0, 0.0, 0.01)):
        out = low_pass(np.sin(2 * np.pi * frequency * t))
        kept = low_pass.instants(np.sin(2 * np.pi * frequency * t))
        assert len(out) == len(kept)
        gain = np.abs(out).max()
        assert low <= gain <= high
        if low:
            np.testing.assert_allclose(out, kept, atol=0.01)


def test_servo_response_is_found() -> None:
    log = resample(log_at(np.arange(0.0, 20.0, 0.004), lag=0.017))
    error = (followed(log) - log.q)[100:]
    assert np.abs(error).max() < 2e-4 * np.abs(log.q_ref - log.q).max()


@pytest.mark.parametrize(("lag", "found"), [(26, True), (34, False)])
def test_a_servo_is_followed_however_late_up_to_120_ms(lag: int, found: bool) -> None:
    told = np.cumsum(np.random.default_rng(1).standard_normal((3000, 2)), axis=0)
    late = Log(0.004 * np.arange(2900), told[100 - lag : -lag], 0.0 * told[100:], None, told[100:])
    error = (followed(resample(late)) - late.q)[100:]
    assert (np.abs(error).max() < 1e-3) == found


def test_the_commanded_motion_is_blended_in_over_the_first_200_ms() -> None:
    log = log_at(np.arange(0.0, 20.0, 0.004), lag=0.02)
    noise = 1e-4 * np.random.default_rng(1).standard_normal(log.q.shape)
    noisy = replace(log, q=log.q + noise)
    q, commanded, _ = used_angles(resample(noisy), noisy)
    assert commanded
    # how the servo answers is not known of the first 120 ms
    np.testing.assert_array_equal(q[:30], noisy.q[:30])
    measured = 1.0 - np.arange(30, 50) / 50
    for part, share in ((slice(30, 50), measured), (slice(50, None), 0.0 * log.q[50:, 0])):
        off = q[part] - log.q[part] - share[:, None] * noise[part]
        assert np.abs(off).max() < 0.1 * np.abs(noise).max()


def test_the_filter_takes_signals_of_any_shape_and_none() -> None:
    low_pass = LowPass(10.0, 0.004)
    signal = np.random.default_rng(2).normal(size=(500, 2, 3))
    found = low_pass(signal)
    assert found.shape == (len(low_pass.instants(signal)), 2, 3)
    np.testing.assert_array_equal(found[:, 1, 2], low_pass(signal[:, 1, 2]))
    assert low_pass(np.zeros((500, 0))).shape == (len(found), 0)


@pytest.mark.parametrize(("cutoff", "kept"), [(5.0, 20), (10.0, 10), (60.0, 1), (200.0, 1)])
def test_as_many_samples_are_kept_as_the_cut_off_needs(cutoff: float, kept: int) -> None:
    assert LowPass(cutoff=cutoff, step=0.004).keep == kept


@pytest.mark.parametrize("smooth", [smoothed, polished])
@pytest.mark.parametrize(("step", "half"), [(0.004, 10), (0.02, 4)])
def test_a_sample_reaches_forty_milliseconds_or_four_samples(smooth, step, half) -> None:
    impulse = np.zeros(101)
    impulse[50] = 1.0
    (reached,) = np.nonzero(np.abs(smooth(impulse, step)) > 1e-12)
    assert reached.min() >= 50 - half
    assert reached.max() <= 50 + half
    assert reached.max() - reached.min() >= 2 * half - 2


@pytest.mark.parametrize(("gap", "bridged"), [(0.049, True), (0.052, False)])
def test_two_and_a_half_samples_of_a_slow_log_are_bridged(gap: float, bridged: bool) -> None:
    """At 50 Hz, whose samples lie farther apart than the gap that a fast log may have."""
    before = 0.02 * np.arange(400)
    time = np.concatenate([before, before[-1] + gap + before])
    q = np.tile(np.sin(time)[:, None], 6)
    log = Log(time=time, q=q, qd=None, tau=q, q_ref=None)
    found = resample(log)
    middle = np.abs(found.time - (before[-1] + gap / 2)) < 0.01
    assert found.valid[middle].all() == bridged
    assert found.valid[~(np.abs(found.time - (before[-1] + gap / 2)) < 0.06)].all()


@pytest.mark.parametrize(("step", "half"), [(0.004, 10), (0.002, 20), (0.02, 4)])
def test_smoothing_reaches_forty_milliseconds_to_both_sides(step: float, half: int) -> None:
    """Four samples at least; a constant stays, and nothing is moved in time."""
    impulse = np.zeros((101, 1))
    impulse[50] = 1.0
    found = smoothed(impulse, step)[:, 0]
    np.testing.assert_array_equal(np.flatnonzero(found), range(50 - half, 51 + half))
    np.testing.assert_allclose(found, found[::-1], atol=1e-15)
    np.testing.assert_allclose(found.sum(), 1.0)


def test_in_a_gap_only_what_lies_on_its_ends_is_covered() -> None:
    """A second without samples; a quarter of a step beside a sample is on it."""
    step = 0.004
    time = step * np.concatenate([np.arange(100), 350 + np.arange(100)])
    log = Log(time, np.zeros((200, 1)), np.zeros((200, 1)))
    begin = time[99]
    end = time[100]
    asked = [begin - 0.4 * step, begin + 0.2 * step, begin + 0.3 * step, end - 0.3 * step]
    asked += [end - 0.2 * step, end + 0.4 * step]
    assert _covered(log, np.array(asked), step).tolist() == [True, True, False, False, True, True]
