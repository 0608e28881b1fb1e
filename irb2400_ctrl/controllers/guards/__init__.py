"""Tests of the guard: of a sample alone, and of motion against torque."""

from irb2400_ctrl.controllers.guards.consistency import Consistency
from irb2400_ctrl.controllers.guards.sample_check import SampleCheck

__all__ = ["Consistency", "SampleCheck"]
