"""Log files in and out, resampling, derivative estimation."""

from irb2400_ctrl.measurement.csv_file import read_log, write_log
from irb2400_ctrl.measurement.log import Log

__all__ = ["Log", "read_log", "write_log"]
