"""The figures of a sweep."""

from __future__ import annotations

from irb2400_ctrl.report.figures.sweep_figures import share_figure
from irb2400_ctrl.sweep.table import SummaryLine


def test_errors_of_zero_are_drawn_without_a_logarithm() -> None:
    """Of a motion that stands; Matplotlib's warning stood on the user's terminal."""
    standing = SummaryLine("pid", "nod", 1.0, (0.0, 0.0), 0, 0, 0, 0)
    (axis,) = share_figure([standing]).axes
    assert axis.get_xscale() == "linear"
    moving = SummaryLine("pid", "nod", 1.0, (0.0, 0.3), 0, 0, 0, 0)
    (axis,) = share_figure([moving]).axes
    assert axis.get_xscale() == "log"
