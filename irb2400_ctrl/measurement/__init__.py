"""Log files in and out, resampling, derivative estimation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl._lazy import lazily
from irb2400_ctrl.measurement.csv_file import read_log, write_log
from irb2400_ctrl.measurement.log import Log

if TYPE_CHECKING:
    from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
    from irb2400_ctrl.measurement.recorded import recorded_motion

__all__ = ["Log", "PreparedLog", "prepare", "read_log", "recorded_motion", "write_log"]

# these load SciPy, which reading a log does not need
__getattr__ = lazily(
    __name__,
    {"PreparedLog": "prepared_log", "prepare": "prepared_log", "recorded_motion": "recorded"},
)
