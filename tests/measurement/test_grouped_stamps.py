"""A host that gets several samples at once stamps them as they come, not as they were taken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.measurement.instants.grouped_stamps import grouped, stamps_apart
from irb2400_ctrl.measurement.instants.time_base import time_base, ungrouped, vouched_for
from irb2400_ctrl.measurement.log_facts import log_facts
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.columns.channels import channel_problem

STEP = 0.008


def waves(m: int = 3000) -> tuple[np.ndarray, np.ndarray]:
    """Even instants and the angles at them, whole steps of 1e-5 rad."""
    time = STEP * np.arange(m)
    phase = np.arange(6) + time[:, None] * np.linspace(0.8, 3.0, 6)
    return time, np.round(np.sin(phase), 5)


def arrivals(time: np.ndarray, apart: float, seed: int = 3) -> np.ndarray:
    """When a host gets them: groups of one to eight, of which each is read `apart` after the one
    before."""
    rng = np.random.default_rng(seed)
    stamps = np.empty(len(time))
    first = 0
    while first < len(time):
        last = min(first + int(rng.integers(1, 9)), len(time))
        stamps[first:last] = time[last - 1] + 0.001 + apart * np.arange(last - first)
        first = last
    return 1.7e9 + stamps


def csv(path: Path, stamps: np.ndarray, q: np.ndarray, digits: int) -> Path:
    names = ["time_s", *(f"q{j}_rad" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
    rows = [
        ",".join([f"{t:.{digits}f}", *(f"{v:.5f}" for v in a), *(f"{10 * v:.3f}" for v in a)])
        for t, a in zip(stamps, q, strict=True)
    ]
    path.write_text("\n".join([",".join(names), *rows]))
    return path


def test_samples_that_came_in_groups_are_counted() -> None:
    """Of a recording of an arm over a network 99 % of the samples seemed lost, at 11 kHz."""
    time, q = waves()
    log = Log(arrivals(time, 2e-5), q, 10.0 * q)
    assert grouped(log.time)
    base = time_base(log)
    assert base.rebuilt
    assert base.period == pytest.approx(STEP, rel=1e-3)
    np.testing.assert_allclose(np.diff(base.time), STEP, rtol=1e-3)
    facts = log_facts(log)
    assert facts.rate == pytest.approx(1.0 / STEP, rel=1e-3)
    assert facts.gaps == 0
    np.testing.assert_array_equal(ungrouped(log).time, base.time)


def test_a_log_of_groups_is_what_its_columns_say() -> None:
    """The speeds within a group were those of another clock."""
    time, q = waves()
    log = Log(arrivals(time, 2e-5), q, 10.0 * q)
    assert log_problem(None, log) is None


def test_samples_of_one_stamp_are_told_apart(tmp_path: Path) -> None:
    time, q = waves()
    found = read_log(csv(tmp_path / "a.csv", arrivals(time, 1e-6), q, 3))
    np.testing.assert_allclose(np.diff(ungrouped(found).time), STEP, rtol=1e-3)


@pytest.mark.parametrize("scatter", [0.2e-3, 0.3e-3])
def test_stamps_of_whole_milliseconds_are_read_as_what_they_are(
    tmp_path: Path, scatter: float
) -> None:
    """A thousand samples a second, one to nine in a hundred on the stamp of the one before."""
    time, q = waves()
    time = time / 8.0
    late = np.random.default_rng(2).normal(scale=scatter, size=len(time))
    found = read_log(csv(tmp_path / "a.csv", np.maximum.accumulate(time + late), q, 3))
    base = time_base(found)
    assert base.rebuilt
    assert np.std(base.time - base.time[0] - time) < 2e-5


def test_rows_of_one_stamp_that_are_no_samples_of_a_motion_are_refused(tmp_path: Path) -> None:
    """Each row is there twice, the second time with other angles."""
    time, q = waves()
    twice = np.repeat(q, 2, axis=0)
    twice[1::2] += np.random.default_rng(5).normal(scale=0.1, size=q.shape)
    with pytest.raises(InputError, match="time does not rise"):
        read_log(csv(tmp_path / "a.csv", np.repeat(time, 2), twice, 3))


def test_one_stamp_that_is_there_twice_begins_no_other_record() -> None:
    time, q = waves()
    time[107] = time[106]
    with pytest.raises(InputError, match=r"at sample 108 .*delete doubled ones; of a clock too"):
        Log(time, q, q)


def test_what_was_lost_between_groups_stays_lost() -> None:
    """Forty samples of one second are missing: the angles go on behind them."""
    time, q = waves()
    kept = (time < 10.0) | (time > 10.32)
    log = Log(arrivals(time[kept], 2e-5), q[kept], q[kept])
    steps = np.diff(ungrouped(log).time)
    assert steps.max() == pytest.approx(0.32, abs=0.05)
    assert np.mean(np.abs(steps / STEP - 1.0) < 0.01) > 0.99


def test_a_long_pause_is_no_group() -> None:
    time, q = waves()
    kept = (time < 5.0) | (time > 17.0)
    log = Log(time[kept], q[kept], q[kept])
    assert ungrouped(log) is log or (ungrouped(log).time == log.time).all()


@pytest.mark.parametrize("pauses", [1, 8, 20])
def test_pauses_of_a_host_that_is_late_now_and_then_stay(pauses: int) -> None:
    """Half of the record is not there: its samples are no groups, and their clock goes on."""
    time, q = waves()
    kept = np.ones(len(time), dtype=bool)
    for start in np.linspace(1.0, 22.0, pauses):
        kept &= ~((time > start) & (time < start + 12.0 / pauses))
    late = np.random.default_rng(1).normal(scale=2e-4, size=int(kept.sum()))
    stamps = np.sort(time[kept] + late)
    assert not grouped(stamps)
    base = time_base(Log(stamps, q[kept], q[kept]))
    assert np.abs(base.time - base.time[0] - time[kept] + time[kept][0]).max() < 2e-3


@pytest.mark.parametrize("share", [0.3, 0.4])
def test_what_is_lost_in_short_bursts_is_no_group(share: float) -> None:
    time, q = waves()
    lost = np.repeat(np.random.default_rng(4).uniform(size=len(time) // 5) < share, 5)
    log = Log(time[~lost], q[~lost], 10.0 * q[~lost])
    assert np.mean(np.diff(log.time) > 5.0 * STEP) > 0.05
    assert log_problem(None, log) is None


def test_a_clock_of_another_period_is_none() -> None:
    """Groups and a pause: even instants over all of it would run away from the stamps."""
    time, q = waves()
    kept = (time < 5.0) | (time > 14.0)
    log = Log(arrivals(time[kept], 2e-5), q[kept], q[kept])
    even = ungrouped(log).time
    assert even is log.time or np.abs(even - log.time).max() < 0.1


def test_groups_around_pauses_fit_no_fine_lattice() -> None:
    """One was taken, 40 samples off."""
    time, q = waves()
    parts = [time < 5.0, (time > 7.0) & (time < 13.1), time > 14.6]
    kept = np.any(parts, axis=0)
    stamps = np.concatenate([arrivals(time[part], 1e-5, k) for k, part in enumerate(parts)])
    base = time_base(Log(stamps, q[kept], q[kept]))
    assert np.abs(base.time - time[kept] - np.median(base.time - time[kept])).max() < 0.07


def test_losses_on_a_coarse_clock_are_not_vouched_for() -> None:
    """Even instants were seven samples off, which shows where the joints are fast."""
    rng = np.random.default_rng(8)
    time = np.arange(5000) / 500.0
    waves_of = [2.0 * np.pi * f * time[:, None] + rng.uniform(0, 6, 6) for f in (0.3, 0.6, 0.8)]
    q = np.round(0.3 * np.sum(np.sin(waves_of), axis=0), 5)
    kept = rng.uniform(size=len(time)) < 0.7
    late = rng.normal(scale=2e-4, size=int(kept.sum()))
    stamps = np.maximum.accumulate(np.round((time[kept] + late) / 0.0156) * 0.0156)
    log = Log(stamps_apart(stamps), q[kept], q[kept])
    assert time_base(log).rebuilt
    assert not vouched_for(log)


def test_losses_within_groups_are_no_even_clock() -> None:
    """Counted without them the instants were five to twelve samples off; lattices finer than the
    steps within groups are as wrong."""
    time, q = waves()
    for lost, seed in ((0.3, 7), (0.5, 8)):
        kept = np.random.default_rng(seed).uniform(size=len(time)) > lost
        base = time_base(Log(arrivals(time[kept], 5e-5, seed), q[kept], q[kept]))
        assert not base.rebuilt


def test_stamps_that_rise_or_go_back_stay() -> None:
    time, _ = waves(100)
    assert stamps_apart(time) is time
    back = time.copy()
    back[50:] -= 0.2
    assert stamps_apart(back) is back


def test_groups_of_which_samples_were_lost_are_no_sound_log() -> None:
    """Rows of one stamp deleted, one was "sound at 12985 Hz, 93 % lost"."""
    time, q = waves()
    stamps = arrivals(time, 2e-5)
    kept = np.random.default_rng(7).uniform(size=len(time)) > 0.3
    log = Log(stamps[kept], q[kept], 10.0 * q[kept])
    assert ungrouped(log) is log
    found = channel_problem(log)
    assert found is not None
    assert found.kind == "clock_groups"
    assert "came in groups, 0.02 ms apart within" in found.says
