"""What a reader is told of the time in which an effect acts."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.test_three_lists import diagnosis, finding

from irb2400_ctrl.diagnosis import Unexplained
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.report.pages.diagnosis_tables import parameter_rows
from irb2400_ctrl.report.pages.three_lists import list_lines


def test_when_a_push_acts_is_said_once_and_open_bounds_are_not() -> None:
    """A push from 8 to 19 s read "acts 8.0 to 14 s, acts 15 to 19 s, ... stop_s 1,000,000,000"."""
    windows = ((8.0, 14.0), (15.0, 19.0))
    effect = LIBRARY["process_force"].of(None, force_x_N=50.0, windows_s=windows)
    one = replace(finding("gear_ripple", 1, 0.1), effect=effect)
    text = str((list_lines(diagnosis(one)), parameter_rows(one)))
    assert "acts 8.00 to 14.0 s and 15.0 to 19.0 s (" in text
    assert "stop_s" not in text


def test_a_vibration_without_a_name_is_told_with_its_frequency() -> None:
    """A terminal said "depends on time" of 1.7 Hz that the search had found."""
    curve = finding("gear_ripple", 1, 0.1).curve
    rest = Unexplained(1, ("time",), 16.9, 0.97, "vibration of 1.71 Hz", curve)
    assert rest.line == "joint 1, 16.90 Nm rms, depends on time (vibration of 1.71 Hz)"
