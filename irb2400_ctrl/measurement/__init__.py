"""Log files in and out, resampling, derivative estimation."""

from irb2400_ctrl.measurement.csv_file import read_log, write_log
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.measurement.recorded import recorded_motion

__all__ = ["Log", "PreparedLog", "prepare", "read_log", "recorded_motion", "write_log"]
