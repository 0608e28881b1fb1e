"""Digits of columns, told from what sampling leaves of them."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.measurement.log_facts import digit

TIME = 0.02 * np.arange(170)


@pytest.mark.parametrize(
    ("column", "expected"),
    [
        # 3.4 s of a Rokae AR5, whose joints only move: 0.3 degrees were called its digit
        (np.round(np.sin(0.4 * TIME), 6), 1e-6),
        # counts of a sensor, printed in finer digits
        (np.round(0.0404919 * np.round(250.0 * np.sin(TIME)), 6), 0.0404919),
        # two thirds of all counts left out
        (3e-4 * np.array([0, 2, 5, 7, 12, 14, 15, 19, 22, 27, 30]), 3e-4),
    ],
)
def test_a_joint_that_only_moves_has_the_digit_of_its_file(
    column: np.ndarray, expected: float
) -> None:
    np.testing.assert_allclose(digit(column[:, None]), expected, rtol=1e-3)


@pytest.mark.parametrize("places", [5, 6])
def test_an_encoders_step_is_told_from_degrees_that_are_printed(places: int) -> None:
    """Steps of 5e-6 rad printed to 1e-5 degrees were ones of 1e-5 degrees: seventy of the shortest,
    0.00028 or 0.00029, are none of seventy-one."""
    encoder = np.degrees(5e-6)
    for speed in (0.4, 2.0):
        counts = np.round(np.degrees(np.sin(speed * 0.004 * np.arange(8000))) / encoder)
        column = np.round(counts * encoder, places)[:, None]
        np.testing.assert_allclose(digit(column), encoder, rtol=1e-3)


def test_a_column_without_digits_has_next_to_none() -> None:
    assert (digit(np.sin(0.4 * TIME)[:, None]) < 1e-8).all()
    assert (digit(np.full((9, 1), 0.3)) == 0.0).all()
