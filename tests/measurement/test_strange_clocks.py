"""What is said of a clock that goes back, or ticks in another unit than its name says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from measured_logs import made

from irb2400_ctrl.errors import InputError

LOG = made()


def told(time: np.ndarray) -> str:
    """The refusal of the log at these times."""
    with pytest.raises(InputError) as refused:
        replace(LOG, time=time)
    return str(refused.value)


def test_a_second_record_in_one_file_is_told() -> None:
    half = len(LOG.time) // 2
    again = np.concatenate([LOG.time[:half], LOG.time[: len(LOG.time) - half]])
    assert "another record begins there" in told(again)
    assert "sample 251 (0.996 s, then 0 s)" in told(again)
    back = LOG.time.copy()
    back[half] -= 0.1
    assert "sort the rows" in told(back)


@pytest.mark.parametrize(("share", "begins"), [(0.045, True), (0.055, False)])
def test_another_record_begins_near_the_beginning_of_the_first(share: float, begins: bool) -> None:
    half = len(LOG.time) // 2
    first = LOG.time[:half]
    again = first[0] + share * np.ptp(first)
    second = np.linspace(again, first[-1], len(LOG.time) - half)
    assert ("another record begins there" in told(np.append(first, second))) == begins


def test_runs_one_after_another_are_told_however_many() -> None:
    """Of eleven and more it was "sort the rows"."""
    ends = np.arange(30, 30 + len(LOG.time), 33) + np.arange(0, len(LOG.time), 33) // 33 % 3
    parts = np.split(np.arange(len(LOG.time)), ends[ends < len(LOG.time) - 25])
    runs = [LOG.time[: len(part)] for part in parts]
    assert len(runs) > 11
    assert "another record begins there" in told(np.concatenate(runs))


@pytest.mark.parametrize(
    ("back", "says"),
    [
        (3600.0, "set back by an hour, as at the end of summer time: add 3600 s"),
        (86400.0, "passes midnight: add 86400 s"),
        (2**32 * 1e-6, "a counter of 32 bits that wraps: add 4294.967296 s"),
        (65.536, "a counter of 16 bits that wraps: add 65.536 s"),
        (3601.0, "another record begins there"),
    ],
)
def test_a_clock_that_was_set_back_once_is_no_other_record(back: float, says: str) -> None:
    """Each was said to be another record, to be put into a file of its own."""
    half = len(LOG.time) // 2
    assert says in told(LOG.time + back * (np.arange(len(LOG.time)) < half))


def test_a_few_rows_before_the_clock_is_set_are_no_record() -> None:
    early = np.concatenate([LOG.time[:5], LOG.time[:-5]])
    assert "another record" not in told(early)
    assert "sort the rows" in told(early)


def test_a_counter_that_wraps_is_told() -> None:
    said = told(0.004 * (np.arange(len(LOG.time)) % 50))
    assert "the clock begins again every 0.2 s" in said
    assert "rate_Hz" in said


def test_rows_out_of_order_are_no_lost_zeros() -> None:
    """Digits that are lost go back within a second, and never stand still."""
    order = np.arange(len(LOG.time))
    order[100:200] = order[100:200].reshape(-1, 2)[:, ::-1].ravel()
    assert "leading zeros" not in told(300.0 * LOG.time[order])
    doubled = np.repeat(LOG.time[: (len(LOG.time) + 1) // 2], 2)[: len(LOG.time)]
    assert "leading zeros" not in told(doubled)


def test_nanoseconds_without_their_zeros_are_told() -> None:
    """`f"{sec}.{nanosec}"`; of 1,700,000,000 seconds the message held two digits."""
    nanoseconds = np.round(1e9 * LOG.time).astype(int)
    joined = [f"{1_700_000_000 + n // 10**9}.{n % 10**9}" for n in nanoseconds]
    said = told(np.array([float(text) for text in joined]))
    assert "without their leading zeros" in said
    assert "1700000000.8 s, then 1700000000.12 s" in said


@pytest.mark.parametrize(
    ("times", "unit"), [(1e3, "time_ms"), (1e6, "time_us"), (1e9, "time_ns"), (50.0, "time_ms")]
)
def test_the_unit_by_which_a_rate_is_one_is_said(times: float, unit: str) -> None:
    said = told(LOG.time * times)
    assert "is time_s in seconds?" in said
    assert unit in said
    assert ("it would be 250" in said) == (times > 100.0)
