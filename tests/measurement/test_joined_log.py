"""Several logs one after another: each filtered for itself, nothing reaches over a seam."""

from __future__ import annotations

import numpy as np
import pytest
from measured_logs import made

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.joined_log import PAUSE, prepare_together
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import prepare


def logs() -> list[Log]:
    first = made(1000)
    second = made(1500)
    return [first, Log(second.time + 50.0, second.q + 0.3, 2.0 * second.tau, name="second")]


def test_each_log_is_prepared_as_if_it_were_alone() -> None:
    both = prepare_together(logs())
    alone = [prepare(log) for log in logs()]
    assert both.starts == (0, len(alone[0].time))
    for part, one in zip(both.parts, alone, strict=True):
        for name in ("q", "qd", "qdd", "tau", "tau_smooth", "known"):
            np.testing.assert_array_equal(getattr(both, name)[part], getattr(one, name))
    rows = np.concatenate([one.filtered(one.tau) for one in alone])
    np.testing.assert_allclose(both.filtered(both.tau), rows, rtol=1e-12)
    assert len(both.row_time) == len(both.row_known) == both.rows == len(rows)


def test_time_rises_and_the_first_rows_of_a_log_have_no_neighbours() -> None:
    both = prepare_together(logs())
    steps = np.diff(both.time)
    assert steps.min() > 0
    assert steps.max() == pytest.approx(PAUSE)
    assert both.duration == pytest.approx(steps.sum())
    first = len(prepare(logs()[0]).row_time)
    assert not both.row_known[first : first + 2].any()


def test_logs_of_two_rates_share_one_grid() -> None:
    slow = made(500, rate=100.0)
    both = prepare_together([made(1000), slow])
    assert both.step == pytest.approx(1 / 250.0)
    inside = np.diff(both.time)
    assert np.sum(np.abs(inside - both.step) > 1e-9) == 1


def test_no_log_and_different_arms_are_refused() -> None:
    with pytest.raises(InputError, match="found no log"):
        prepare_together([])
    other = made(1000)
    three = Log(other.time, other.q[:, :3], other.tau[:, :3], name="three")
    with pytest.raises(InputError, match="different numbers of joints"):
        prepare_together([other, three])
