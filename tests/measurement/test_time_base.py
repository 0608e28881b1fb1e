"""The time base is rebuilt where the sampling was even, and kept where the stamps are right."""

from __future__ import annotations

import numpy as np
import pytest
from mujoco_plant.suites import suite

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.instants.even_instants import missed_by
from irb2400_ctrl.measurement.instants.time_base import _slope, time_base, with_time_base
from irb2400_ctrl.measurement.log_facts import log_facts

DIGIT = 5e-6


def motion(time: np.ndarray) -> np.ndarray:
    angles = np.sin(1.7 * time[:, None] + np.arange(6)) + 0.2 * np.sin(5.0 * time[:, None])
    return np.round(angles / DIGIT) * DIGIT


def log_at(true: np.ndarray, stamps: np.ndarray) -> Log:
    return Log(stamps, motion(true), np.cos(true[:, None] * np.arange(1, 7)))


def sampled(rate: float, lost: float, seed: int = 0) -> np.ndarray:
    """Even instants over 20 s, a share of them lost in bursts of eight."""
    time = np.arange(0.0, 20.0, 1.0 / rate)
    keep = np.repeat(np.random.default_rng(seed).uniform(size=len(time)) >= lost, 8)[: len(time)]
    keep[[0, -1]] = True
    return time[keep]


@pytest.mark.parametrize(
    ("rate", "scatter", "lost"),
    [
        (250.0, 0.5e-3, 0.0),
        (250.0, 1.0e-3, 0.2),
        (250.0, 2e-3 / np.sqrt(3.0), 0.02),  # over a whole period: the stamps have no phase
        (50.0, 3e-3, 0.1),
    ],
)
def test_stamps_of_a_host_give_way_to_the_even_sampling(
    rate: float, scatter: float, lost: float
) -> None:
    true = sampled(rate, lost)
    noise = np.random.default_rng(1).uniform(-1.0, 1.0, len(true)) * scatter * np.sqrt(3.0)
    stamps = np.maximum.accumulate(true + noise) + 1e-10 * np.arange(len(true))
    base = time_base(log_at(true, stamps))
    assert base.rebuilt
    assert abs(base.slope) < 0.02
    assert base.period == pytest.approx(1.0 / rate, rel=1e-4)
    # uniform, and a few stamps that would cross are held back
    assert base.scatter == pytest.approx(scatter, rel=0.1)
    error = base.time - true
    assert np.std(error) < 0.1 * scatter


@pytest.mark.parametrize("rate", [125.0, 250.0])
def test_uneven_instants_are_no_lost_samples(rate: float) -> None:
    """Sampled 0.5 ms off an even clock, the stamps right: any lattice six times as fine is near to
    them, on which 83 % were said to be lost."""
    even = np.arange(0.0, 20.0, 1.0 / rate)
    true = even + np.random.default_rng(5).normal(0.0, 0.5e-3, len(even))
    base = time_base(log_at(true, true))
    assert not base.rebuilt
    assert base.lost == 0.0
    assert base.period == pytest.approx(1.0 / rate, rel=1e-4)
    assert base.scatter == pytest.approx(0.5e-3, rel=0.05)
    assert base.slope == pytest.approx(1.0, abs=0.05)


def test_stamps_that_are_right_are_kept() -> None:
    even = np.arange(0.0, 20.0, 0.004)
    true = even + np.random.default_rng(2).uniform(-0.8e-3, 0.8e-3, len(even))
    base = time_base(log_at(true, true))
    assert not base.rebuilt
    assert base.slope > 0.9
    np.testing.assert_array_equal(base.time, true)


def test_samples_lost_before_a_decimation_are_not_smoothed_over() -> None:
    # steps of 20 and 24 ms: the lattice is that of 4 ms
    steps = np.where(np.random.default_rng(3).uniform(size=900) < 0.2, 0.024, 0.020)
    true = np.cumsum(steps)
    log = log_at(true, true)
    base = time_base(log)
    assert base.period == pytest.approx(0.004, rel=1e-6)
    np.testing.assert_allclose(with_time_base(log).time, true, atol=1e-9)


@pytest.mark.parametrize("step", [0.002, 0.004, 0.005])
def test_stamps_in_whole_milliseconds_are_no_samples_lost_by_the_dozen(step: float) -> None:
    """Of 4 ms that a host wrote as 3, 4 and 5 three quarters were said to be lost, and the stamps
    were taken as they stood."""
    true = np.arange(0.0, 20.0, step)
    late = np.random.default_rng(8).uniform(0.0, 1.6e-3, len(true))
    base = time_base(log_at(true, np.floor(1e3 * (true + late) + 1e-9) * 1e-3))
    assert base.rebuilt
    assert base.lost == 0.0
    np.testing.assert_allclose(np.diff(base.time), step, atol=1e-6)


def test_an_even_log_is_left_as_it_is() -> None:
    time = np.arange(0.0, 10.0, 0.004)
    log = log_at(time, time)
    assert with_time_base(log) is log


def test_facts_of_a_log() -> None:
    true = sampled(250.0, 0.1, seed=4)
    command = np.sin(1.7 * (true[:, None] + 0.015) + np.arange(6))
    command += 0.2 * np.sin(5.0 * (true[:, None] + 0.015))
    rng = np.random.default_rng(5)
    tau = np.cos(true[:, None] * np.arange(1, 7)) + 0.2 * rng.standard_normal((len(true), 6))
    facts = log_facts(Log(true, motion(true), np.round(tau, 3), q_ref=command))
    assert facts.rate == pytest.approx(250.0)
    assert facts.base.lost == pytest.approx(0.1, abs=0.05)
    assert facts.gaps > 10
    assert facts.longest_gap >= 8 * 0.004
    np.testing.assert_allclose(facts.angle_digit, DIGIT, rtol=1e-6)
    np.testing.assert_allclose(facts.torque_digit, 1e-3, rtol=1e-6)
    np.testing.assert_allclose(facts.torque_noise, 0.2, rtol=0.15)
    assert facts.lag is not None
    np.testing.assert_allclose(facts.lag, 0.015, atol=1e-4)


def test_a_long_lag_behind_the_command_is_measured_as_well() -> None:
    time = 0.004 * np.arange(2500)

    def moved(t: np.ndarray) -> np.ndarray:
        return np.cos(2.0 * np.clip(t[:, None] - np.linspace(1.0, 2.0, 6), 0.0, 2.0 * np.pi))

    command = moved(time + 0.2)
    facts = log_facts(Log(time, moved(time), np.sin(np.outer(time, np.ones(6))), q_ref=command))
    assert facts.lag is not None
    np.testing.assert_allclose(facts.lag, 0.2, atol=1e-4)


def test_stamps_that_scatter_over_more_than_a_period_do_not_shorten_it() -> None:
    """Where stamps may cross, a lattice of another period is nearer to them; the angles know."""
    (case,) = suite("jitter", 3, 1, 922905)
    read = case.simulate()
    base = time_base(Log(read.time, read.q, read.tau))
    assert base.rebuilt
    assert base.period == pytest.approx(4e-3, rel=2e-5)
    # nor are losses a few samples off, which would be jumps of the angles by milliradians
    rough = np.abs(missed_by(read.q, base.time))
    assert (rough < 20.0 * np.median(rough, axis=0)).all()


def test_an_arm_that_does_not_move_says_nothing_of_its_stamps() -> None:
    """Whatever they scatter: nothing is interpolated wrongly."""
    even = 0.004 * np.arange(500)
    stamps = even + 1e-3 * np.random.default_rng(3).uniform(-1, 1, 500)
    log = Log(stamps, np.full((500, 2), 0.7), np.zeros((500, 2)))
    assert _slope(log, even) == (0.0, np.inf)
