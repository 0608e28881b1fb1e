"""A sample between two gaps is drawn: a line through it alone shows nothing."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.report.elements.plots import Line, over_time


@pytest.mark.parametrize("count", [200, 20000])
def test_every_known_sample_is_part_of_a_stroke(count: int) -> None:
    """Of an arm that picks and places, each second of motion stood alone: the figures of `watch`
    were empty."""
    time = np.arange(float(count))
    values = np.where(np.arange(count) % 3 == 0, np.sin(time), np.nan)
    values[-4:] = 0.5
    (line,) = over_time(time, [Line(values)], "x [-]").axes[0].lines
    drawn = np.isfinite(np.asarray(line.get_ydata(), dtype=float))
    assert (drawn[1:] & drawn[:-1]).any()
    beside = np.append(drawn[1:], False) | np.append(False, drawn[:-1])
    assert not (drawn & ~beside).any()
    if count == 200:
        (plain,) = over_time(time, [Line(np.sin(time))], "x [-]").axes[0].lines
        assert len(np.asarray(plain.get_xdata())) == count
