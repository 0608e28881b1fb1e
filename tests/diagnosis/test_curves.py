"""The curve of a finding where a log has few rows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.curves import BINS, FEWEST, binned_curve


def motion(rows: int) -> Any:
    """A log of one joint, a row every quarter second, all of them known."""
    still = np.zeros((rows, 1))
    return SimpleNamespace(
        row_time=0.25 * np.arange(rows), row_known=still == 0.0, q=still, qd=still, qdd=still
    )


@pytest.mark.parametrize("rows", [4, 20, 56, 118, 1000])
def test_few_rows_are_drawn_in_fewer_bins(rows: int) -> None:
    """A bin of fewer than three samples shows nothing: torques that were low-passed before they
    were written have some fifty rows, of which forty bins left an empty figure."""
    law = np.full(rows, 0.9)
    curve = binned_curve(motion(rows), np.zeros((rows, 1)), 0, "time", law, np.zeros(rows))
    assert len(curve.x) == np.clip(rows // (2 * FEWEST), 1, BINS)
    np.testing.assert_allclose(curve.measured, 0.9)
    np.testing.assert_allclose(curve.law, 0.9)


def test_a_bin_of_two_rows_is_not_drawn() -> None:
    few = motion(12)
    few.q = np.array([[0.0]] * 10 + [[1.0]] * 2)
    few.at_rows = lambda signal: signal
    curve = binned_curve(few, np.zeros((12, 1)), 0, "q", np.ones(12), np.zeros(12))
    assert list(curve.x) == [0.0]
