"""Rows that are missing or there twice under an even clock, cells that are no samples."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import LogProblem, log_problem
from irb2400_ctrl.plausibility.columns import jumps

RATE = 125.0


def log(digit: float = 1e-6, seconds: float = 20.0, seed: int = 2) -> Log:
    """Four joints that swing, with noise of a few digits."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 1.0 / RATE)
    w = np.array([0.9, 1.3, 1.7, 2.2])
    q = np.sin(w * time[:, None] + [0.0, 1.0, 2.0, 3.0]) + digit * rng.standard_normal(
        (len(time), 4)
    )
    tau = 40.0 * np.sin(q) + 9.0 * np.cos(w * time[:, None]) + rng.standard_normal(q.shape)
    return Log(time, digit * np.round(q / digit), tau)


def counted(found: Log, rows: np.ndarray) -> Log:
    """These rows of a log, with a time that is their number."""
    return Log(np.arange(len(rows)) / RATE, found.q[rows], found.tau[rows])


def problem_of(found: Log) -> LogProblem:
    problem = log_problem(None, found)
    assert problem is not None
    return problem


@pytest.mark.parametrize("share", [0.005, 0.03, 0.1])
def test_rows_that_are_missing_under_an_even_clock_are_told(share: float) -> None:
    found = log()
    drawn = np.random.default_rng(1).random(len(found.time))
    kept = np.flatnonzero(drawn > share)
    problem = problem_of(counted(found, kept))
    assert problem.kind == "rows_missing"
    # where two are lost next to each other their neighbours tell neither
    assert 0.5 < problem.fits["places"] / np.sum(np.diff(kept) > 1) <= 1.0
    assert problem.fits["from_s"] < 3.0


def test_rows_that_are_there_twice_under_an_even_clock_are_told() -> None:
    found = log()
    rows = np.sort(np.r_[np.arange(len(found.time)), np.arange(40, len(found.time), 10)])
    problem = problem_of(counted(found, rows))
    assert problem.kind == "rows_twice"
    assert problem.fits["places"] > 0.9 * len(range(40, len(found.time), 10))
    assert "Leave them out" in problem.says


@pytest.mark.parametrize(("stands_in", "seconds"), [(True, 20.0), (False, 20.0), (True, 2.2)])
def test_where_a_recorded_speed_stands_in_nothing_is_refused(
    stands_in: bool, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A Panda's host reads its state when it comes to it."""
    found = log(seconds=seconds)
    rows = np.sort(np.r_[np.arange(len(found.time)), np.arange(40, len(found.time), 10)])
    polled = replace(counted(found, rows), qd=np.gradient(found.q, found.time, axis=0)[rows])
    monkeypatch.setattr(jumps, "prepare", lambda log: SimpleNamespace(by_speed=stands_in))
    problem = jumps.uncounted(polled)
    # of a log too short to be prepared nobody knows
    assert (problem is None) == (stands_in and seconds > 2.5)
    assert problem is None or problem.kind == "rows_twice"


def test_rows_whose_time_is_lost_with_them_are_no_fault() -> None:
    found = log()
    kept = np.random.default_rng(1).random(len(found.time)) > 0.03
    assert log_problem(None, Log(found.time[kept], found.q[kept], found.tau[kept])) is None


def test_angles_of_few_digits_and_an_arm_at_rest_tell_nothing_of_their_rows() -> None:
    coarse = log(digit=np.radians(0.1))
    kept = np.flatnonzero(np.random.default_rng(1).random(len(coarse.time)) > 0.03)
    assert log_problem(None, counted(coarse, kept)) is None
    moves = log()
    rests = np.r_[np.arange(600), np.repeat(600, 400), np.arange(600, 1200)]
    tau = moves.tau[rests] + 0.1 * np.random.default_rng(3).standard_normal((len(rests), 4))
    slow = np.sin(np.minimum(np.arange(len(rests)), 600) / 600 * np.pi) ** 2
    stands = Log(
        np.arange(len(rests)) / RATE, moves.q[600] + slow[:, None] * [0.4, 0.3, 0.2, 0.1], tau
    )
    assert log_problem(None, stands) is None


@pytest.mark.parametrize("rows", [[900], [400, 900, 1500], [900, 901], [900, 901, 902]])
def test_an_angle_that_leaves_for_a_sample_and_comes_back_is_told(rows: list[int]) -> None:
    found = log()
    q = found.q.copy()
    q[rows, 2] += 0.3
    problem = problem_of(replace(found, q=q))
    assert problem.kind == "spike"
    assert problem.unusable
    assert problem.joints == (3,)
    assert problem.fits == {"sample": rows[0] + 1, "rows": len(rows)}


@pytest.mark.parametrize("value", [-9999.0, 9999.0, 999.0, 1e9])
@pytest.mark.parametrize("count", [2, 8, 60])
def test_a_value_that_stands_for_missing_samples_is_told(value: float, count: int) -> None:
    """The second of them was no huge cell any more, twenty a limit of the torque."""
    found = log()
    rows = np.sort(np.random.default_rng(4).choice(len(found.time), count, replace=False))
    tau = found.tau.copy()
    tau[rows, 1] = value
    problem = problem_of(replace(found, tau=tau))
    assert problem.kind == "spike"
    assert problem.joints == (2,)
    assert problem.fits == {"sample": rows[0] + 1, "rows": count, "value": value}


def test_a_torque_that_is_cut_off_is_no_value_for_missing_ones() -> None:
    found = log()
    tau = found.tau.copy()
    tau[:, 1] = np.clip(tau[:, 1], -37.0, 37.0)
    assert problem_of(replace(found, tau=tau)).kind == "saturation"


def test_rows_of_zeros_in_the_middle_of_a_motion_are_told() -> None:
    found = log()
    q = found.q.copy()
    tau = found.tau.copy()
    q[700:712] = 0.0
    tau[700:712] = 0.0
    problem = problem_of(replace(found, q=q, tau=tau))
    assert problem.kind == "spike"
    assert problem.fits == {"sample": 701, "rows": 12}
