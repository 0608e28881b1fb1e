"""A plant that shares no code with the library under test: blind test logs with a known truth."""

from .case import Case, TrueEffect
from .effects import GROUPS, KINDS, LIBRARY, OUTSIDE, Effect
from .log import Log
from .machine import Driven
from .sensors import Sensors
from .suites import SUITES, suite
from .visibility import beyond_priors

__all__ = [
    "GROUPS",
    "KINDS",
    "LIBRARY",
    "OUTSIDE",
    "SUITES",
    "Case",
    "Driven",
    "Effect",
    "Log",
    "Sensors",
    "TrueEffect",
    "beyond_priors",
    "suite",
]
