"""A row or two that a counted clock passes over are set right; more of them are refused."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.lost_rows import with_rows_counted
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.plausibility.columns.jumps import uncounted

PERIOD = 0.004


def log(rows: int = 2500) -> Log:
    """Three joints on sines, with the noise of encoders; what was recorded beside goes along."""
    time = PERIOD * np.arange(rows)
    q = np.column_stack([np.sin(w * time + w) for w in (1.1, 1.7, 2.3)])
    q += 3e-6 * np.random.default_rng(1).standard_normal(q.shape)
    tau = 40.0 * np.cos(q) + np.random.default_rng(2).standard_normal(q.shape)
    return Log(
        time, q, tau, qd=np.gradient(q, PERIOD, axis=0), extra={"row": np.arange(rows) * 1.0}
    )


def of_rows(whole: Log, rows: np.ndarray) -> Log:
    """Some rows of it under a time that is counted."""
    assert whole.qd is not None
    return Log(
        PERIOD * np.arange(len(rows)),
        whole.q[rows],
        whole.tau[rows],
        qd=whole.qd[rows],
        extra={"row": whole.extra["row"][rows]},
    )


def without(*places: int) -> Log:
    return of_rows(log(), np.delete(np.arange(2500), places))


def doubled(*places: int) -> Log:
    return of_rows(log(), np.sort(np.concatenate([np.arange(2500), places])))


@pytest.mark.parametrize("places", [(700,), (700, 701), (300, 1200, 2000)])
def test_a_row_that_is_missing_is_a_gap_of_the_clock(places: tuple[int, ...]) -> None:
    counted, said = with_rows_counted(without(*places))
    np.testing.assert_allclose(counted.time, np.delete(log().time, places), atol=1e-9)
    assert said.startswith("rows are missing at ")
    one_after_another = len([p for p in places if p - 1 in places])
    assert len(re.findall(r"\d\.\d\d", said)) == len(places) - one_after_another


def test_a_row_that_is_there_twice_is_left_out() -> None:
    counted, said = with_rows_counted(doubled(900))
    np.testing.assert_allclose(counted.time, log().time, atol=1e-9)
    np.testing.assert_array_equal(counted.extra["row"], np.arange(2500.0))
    assert counted.qd is not None
    assert log().qd is not None
    np.testing.assert_array_equal(counted.qd, log().qd)
    assert said.startswith("rows are there twice at 3.60 s")


def test_both_at_once_end_where_they_began() -> None:
    rows = np.sort(np.concatenate([np.delete(np.arange(2500), 400), [1500]]))
    counted, said = with_rows_counted(of_rows(log(), rows))
    np.testing.assert_allclose(counted.time, np.delete(log().time, 400), atol=1e-9)
    assert "are missing at 1.60 s" in said
    assert "are there twice at " in said


def test_more_than_a_few_are_left_to_the_recorder() -> None:
    broken = without(300, 600, 900, 1200, 1500, 1800)
    assert with_rows_counted(broken) == (broken, "")
    found = uncounted(broken)
    assert found is not None
    assert found.kind == "rows_missing"


def test_a_log_whose_rows_are_all_there_stays_as_it_is() -> None:
    whole = log()
    assert with_rows_counted(whole) == (whole, "")
    # one joint alone that goes two steps at once has slipped
    q = whole.q.copy()
    q[1000:, 1] += 2.0 * (q[1000, 1] - q[999, 1])
    slipped = replace(whole, q=q)
    assert with_rows_counted(slipped)[0] is slipped


@pytest.mark.parametrize("scatter", [0.08, 0.1, 0.12])
def test_long_steps_between_short_ones_are_no_rows_that_are_missing(scatter: float) -> None:
    """A host that samples unevenly and stamps right what it samples, mostly slow."""
    rows = 20000
    draw = np.random.default_rng(7)
    time = PERIOD * (np.arange(rows) + scatter * draw.standard_normal(rows))
    along = time - 0.97 * np.sin(time)
    q = np.column_stack([w * along for w in (1.1, 1.7, 2.3)])
    scattered = Log(time, q, 40.0 * np.cos(q))
    assert with_rows_counted(scattered)[1] == ""


def test_a_row_that_is_repeated_under_a_time_of_its_own_is_none() -> None:
    """A host that reads once before there is a new sample: the step behind it is of two, and the
    time is right."""
    rows = np.arange(2500)
    rows[900] = 899
    stale = of_rows(log(), rows)
    assert with_rows_counted(stale) == (stale, "")


def test_a_prepared_log_says_so_and_has_no_blow_there() -> None:
    sound, broken = (prepare(one) for one in (log(), without(1200)))
    assert any("rows are missing at 4.80 s" in remark for remark in broken.remarks)
    assert not any("rows are" in remark for remark in sound.remarks)
    most = [np.abs(one.qdd[one.known.all(axis=1)]).max() for one in (sound, broken)]
    assert most[1] == pytest.approx(most[0], rel=0.02)
