"""Readers of CAM files: one file per concept of their languages."""

from irb2400_ctrl.planners.toolpath.readers.csv_path import read_csv
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.text import read_text

__all__ = ["ProgramBuilder", "read_csv", "read_text"]
