"""Log files in and out, what they hold, their time base, resampling, derivative estimation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl._lazy import lazily
from irb2400_ctrl.measurement.columns.column_map import ColumnMap, load_column_map
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.read_log import read_log
from irb2400_ctrl.measurement.write_log import write_log

if TYPE_CHECKING:
    from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
    from irb2400_ctrl.measurement.recorded import recorded_motion

__all__ = [
    "ColumnMap",
    "Log",
    "PreparedLog",
    "load_column_map",
    "prepare",
    "read_log",
    "recorded_motion",
    "write_log",
]

# these load SciPy, which reading a log does not need
__getattr__ = lazily(
    __name__,
    {"PreparedLog": "prepared_log", "prepare": "prepared_log", "recorded_motion": "recorded"},
)
