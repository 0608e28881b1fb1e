"""Rows that repeat the state before under a time of their own are left out; rows that are written
twice are not taken for them."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.held_samples import released
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.columns.jumps import uncounted

RATE = 250.0


def log(digit: float = 1e-5, seconds: float = 12.0) -> Log:
    """Three joints that swing, with noise on their torques."""
    time = np.arange(0.0, seconds, 1.0 / RATE)
    q = np.sin([4.4, 5.6, 8.2] * time[:, None] + [0.0, 1.0, 2.0])
    tau = 40.0 * np.cos(q) + 0.3 * np.random.default_rng(4).standard_normal(q.shape)
    return Log(time, digit * np.round(q / digit), tau)


def published_again(whole: Log, share: float, torques: bool = True) -> tuple[Log, np.ndarray]:
    """The log with rows that repeat the one before, and which rows are new."""
    fresh = np.random.default_rng(1).random(len(whole.time)) > share
    fresh[:3] = True
    fresh[-3:] = True
    place = np.maximum.accumulate(np.where(fresh, np.arange(len(fresh)), 0))
    tau = whole.tau[place] if torques else whole.tau
    return replace(whole, q=whole.q[place], tau=tau), fresh


@pytest.mark.parametrize("share", [0.003, 0.02, 0.1, 0.25])
@pytest.mark.parametrize("torques", [True, False])
def test_rows_that_repeat_the_angles_of_the_row_before_are_left_out(
    share: float, torques: bool
) -> None:
    whole = log()
    found, fresh = published_again(whole, share, torques)
    left, said = released(found)
    assert np.array_equal(left.time, whole.time[fresh])
    assert np.array_equal(left.q, whole.q[fresh])
    assert np.array_equal(left.tau, whole.tau[fresh])
    assert said.startswith(f"{np.sum(~fresh)} rows, ")
    assert said in prepare(found).held
    assert log_problem(None, found) is None


def test_accelerations_come_out_as_without_them() -> None:
    """Two rows in a hundred put them off by two thirds of the largest."""
    whole = log()
    found, _ = published_again(whole, 0.02)
    exact = -(np.array([4.4, 5.6, 8.2]) ** 2) * whole.q
    ready = prepare(found)
    off = ready.qdd - np.column_stack(
        [np.interp(ready.time, whole.time, column) for column in exact.T]
    )
    assert np.abs(off[20:-20]).max() < 0.02 * np.abs(exact).max()


def test_rows_that_are_written_twice_are_still_refused() -> None:
    whole = log()
    rows = np.sort(np.r_[np.arange(len(whole.time)), np.arange(40, len(whole.time), 30)])
    twice = Log(np.arange(len(rows)) / RATE, whole.q[rows], whole.tau[rows])
    assert released(twice)[1] == ""
    problem = log_problem(None, twice)
    assert problem is not None
    assert problem.kind == "rows_twice"


def test_three_rows_are_chance_and_a_quarter_of_a_second_is_none_that_is_published_again() -> None:
    whole = log()
    place = np.arange(len(whole.time))
    place[[500, 900, 1300]] -= 1
    assert released(replace(whole, q=whole.q[place], tau=whole.tau[place]))[1] == ""
    place[[700, 1100]] -= 1
    place[1700:1760] = 1700
    left, said = released(replace(whole, q=whole.q[place]))
    assert said.startswith("5 rows, ")
    # what stays that long stands
    assert len(left.time) == len(whole.time) - 5


def test_an_arm_that_rests_turns_or_has_coarse_angles_repeats_nothing() -> None:
    whole = log()
    q = whole.q.copy()
    q[500:1500] = q[500]
    q[1500:] += q[500] - q[1500]
    assert released(replace(whole, q=q))[1] == ""
    # angles that change every few rows are held by their digits
    assert released(log(digit=np.radians(2.0)))[1] == ""
    # one joint alone, at its turns
    slow = replace(whole, q=np.round(np.sin(0.5 * whole.time[:, None]), 4), tau=whole.tau[:, :1])
    assert released(slow)[1] == ""


def test_an_arm_that_comes_to_rest_repeats_no_rows() -> None:
    """From pose to pose in a simulation: the rows of its rests are the same to the last digit, and
    those before get smaller than any noise. 24 of them were called rows that are there twice."""
    rng = np.random.default_rng(8)
    poses = rng.uniform(-1.0, 1.0, (16, 4))
    parts = []
    for a, b in pairwise(poses):
        s = np.linspace(0.0, 1.0, int(rng.uniform(800, 2000)))
        blend = (10 * s**3 - 15 * s**4 + 6 * s**5)[:, None]
        parts.append(np.vstack([a + blend * (b - a), np.tile(b, (150, 1))]))
    q = np.vstack(parts)[::10]
    time = np.arange(len(q)) / 100.0
    tau = 40.0 * np.cos(q) + 0.3 * rng.standard_normal(q.shape)
    assert uncounted(Log(time, q, tau)) is None
