"""A plant that shares no code with the library under test: blind test logs with a known truth."""

from .case import Case, Log, TrueEffect
from .effects import GROUPS, KINDS, LIBRARY, OUTSIDE, Effect
from .sensors import Sensors

__all__ = ["GROUPS", "KINDS", "LIBRARY", "OUTSIDE", "Case", "Effect", "Log", "Sensors", "TrueEffect"]
