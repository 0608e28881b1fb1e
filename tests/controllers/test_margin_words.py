"""Margins of a loop in words."""

from __future__ import annotations

import math

import pytest

from irb2400_ctrl.controllers.margins import times


@pytest.mark.parametrize(
    ("down", "up", "words"),
    [
        (0.0, 6.24, "up to 6.24 times"),
        (0.4, 6.24, "0.40 to 6.24 times"),
        (0.4, math.inf, "0.40 times or more"),
        (0.0, math.inf, "any"),
    ],
)
def test_an_open_gain_margin_is_no_number(down: float, up: float, words: str) -> None:
    """`gain 0.00 to inf times`."""
    assert times(down, up) == words
