"""Measured angles are smoothed as strongly as their noise asks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.angle_smoothing import angle_smoothing
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.measurement.uniform import SMOOTHING, resample

SPEEDS = np.array([1.3, 2.1, 3.0, 4.4, 6.0, 9.0])
"""[rad/s] of the fastest part of each joint's motion"""


def log_of(rate: float, digit: float, seconds: float = 20.0, noise: float = 0.0) -> Log:
    """A motion below 1.5 Hz, its angles in digits [rad]."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    q = exact(t)[0] + noise * np.random.default_rng(1).standard_normal((len(t), 6))
    tau = 10.0 * np.cos(np.outer(t, SPEEDS)) + np.random.default_rng(2).normal(size=q.shape)
    return Log(t, q if digit == 0.0 else digit * np.round(q / digit), tau)


def exact(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles and accelerations."""
    phase = np.outer(t, SPEEDS)
    slow = np.outer(t, 0.4 * SPEEDS)
    q = 0.4 * np.sin(phase) + 0.6 * np.cos(slow)
    return q, -(SPEEDS**2) * (0.4 * np.sin(phase) + 0.16 * 0.6 * np.cos(slow))


def off(log: Log) -> np.ndarray:
    """Rms of the accelerations' errors, (6,) [rad/s2]."""
    found = prepare(log, quiet=True)
    wrong = found.qdd - exact(found.time)[1]
    return np.asarray(np.sqrt(np.mean(wrong[found.known.any(axis=1)] ** 2, axis=0)))


@pytest.mark.parametrize("rate", [100.0, 250.0, 500.0])
def test_coarse_angles_make_no_accelerations(rate: float) -> None:
    """Digits of 0.4 mrad through the usual filter are 0.3 to 0.6 rad/s2, a third of what moves."""
    assert off(log_of(rate, 4e-4)).max() < 0.12


def test_identify_differentiates_such_angles() -> None:
    log = log_of(250.0, 4e-4)
    found = motion_of(log, "angle")
    assert np.array_equal(found.qdd, prepare(log, quiet=True).qdd)
    assert not np.allclose(found.qdd[:, 0], prepare(log).qdd[: len(found.qdd), 0])


def test_noise_that_digits_hide_is_seen() -> None:
    """Neighbours that mostly agree to the last digit have noise all the same."""
    assert off(log_of(200.0, 4e-5, noise=2e-5)).max() < 0.05


@pytest.mark.parametrize("rate", [50.0, 250.0])
def test_clean_angles_go_through_the_usual_filter(rate: float) -> None:
    log = log_of(rate, 0.0)
    grid = resample(log)
    found = angle_smoothing(grid, grid.q, log)
    assert (found.cutoff == SMOOTHING).all()
    assert found.reach == 0


@pytest.mark.parametrize(("every", "stronger"), [(0.9, False), (1.1, True)])
def test_a_second_without_a_gap_tells_the_noise(every: float, stronger: bool) -> None:
    log = log_of(250.0, 4e-4)
    grid = resample(log)
    whole = grid.time % (every + 0.1) < every
    found = angle_smoothing(replace(grid, valid=whole), grid.q, log)
    assert (found.reach > 0) == stronger


def test_a_quick_motion_keeps_what_is_quick_in_it() -> None:
    """A joint that shakes at 8 Hz above its noise is not smoothed below that; one that rests keeps
    the usual filter."""
    log = log_of(250.0, 1e-4)
    q = np.array(log.q)
    q[:, 1] += 4e-3 * np.sin(2.0 * np.pi * 8.0 * log.time)
    q[:, 2] = 0.3
    grid = resample(Log(log.time, q, log.tau))
    found = angle_smoothing(grid, grid.q, log)
    assert found.cutoff[1] > 8.0
    assert found.cutoff[2] == SMOOTHING
    assert found.cutoff[0] < found.cutoff[1]


def test_what_a_wide_window_makes_incomplete_is_not_known() -> None:
    """At the ends, and beside a gap."""
    log = log_of(250.0, 4e-4)
    kept = (log.time < 9.0) | (log.time > 9.5)
    found = prepare(Log(log.time[kept], log.q[kept], log.tau[kept]), quiet=True)
    moving = np.abs(exact(found.time)[0]).max(axis=1) > 0.0
    known = found.known.any(axis=1)
    assert not known[found.time < 0.15].any()
    assert not known[(found.time > 8.85) & (found.time < 9.65)].any()
    assert known[moving].mean() > 0.6
    assert off(Log(log.time[kept], log.q[kept], log.tau[kept])).max() < 0.12


def test_what_a_commanded_motion_begins_with_is_not_known() -> None:
    """It is blended in from coarse angles, whose accelerations are noise: 3 rad/s2 were known."""
    log = log_of(250.0, 4e-4)
    t = np.asarray(log.time)
    ahead = exact(t + 0.02)[0]
    found = prepare(Log(t, log.q, log.tau, q_ref=ahead), quiet=True)
    assert found.instrumented
    wrong = (found.qdd - exact(found.time)[1])[found.known.any(axis=1)]
    assert np.abs(wrong).max() < 0.5
