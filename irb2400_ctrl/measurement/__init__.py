"""Log files in and out, what they hold, their time base, resampling, derivative estimation."""

from irb2400_ctrl.measurement.column_map import ColumnMap, load_column_map
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.read_log import read_log
from irb2400_ctrl.measurement.write_log import write_log

__all__ = ["ColumnMap", "Log", "load_column_map", "read_log", "write_log"]
