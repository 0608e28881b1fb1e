"""Log, diagnosis and regenerated controller against an arm that shares no code with the library."""

from .closing import CONTROLLERS, Closed, Tracking, close, followed, measured
from .generated import generated_drive

__all__ = ["CONTROLLERS", "Closed", "Tracking", "close", "followed", "generated_drive", "measured"]
