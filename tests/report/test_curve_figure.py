"""The curve of a finding is drawn where the log has samples."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import Curve
from irb2400_ctrl.report.figures.diagnosis_figures import curve_figure


def curve(x: np.ndarray) -> Curve:
    law = np.cos(x)
    return Curve(4, "q4", "rad", x, law, law - 0.1, law + 0.1, law)


@pytest.mark.parametrize(("stops", "parts"), [((1.9, 2.4), 2), ((1.9, 1.9), 1)])
def test_no_line_and_no_band_is_drawn_over_a_gap(stops: tuple[float, float], parts: int) -> None:
    """Of a joint that moved about two angles they filled what lies between."""
    x = np.arange(1.7, 2.8, 0.027)
    x = x[(x < stops[0]) | (x > stops[1])]
    (axis,) = curve_figure(curve(x), "payload").axes
    dots, line = axis.lines
    assert np.array_equal(dots.get_xdata(), x)
    assert np.isnan(np.asarray(line.get_ydata())).sum() == parts - 1
    (band,) = axis.collections
    assert len(band.get_paths()) == parts


def test_one_bin_is_drawn() -> None:
    (axis,) = curve_figure(curve(np.array([0.3])), "payload").axes
    assert len(axis.lines) == 2
