"""A log of another day beside what the model of an arm left of its own logs."""

from irb2400_ctrl.identification.another_day.otherwise import otherwise
from irb2400_ctrl.identification.another_day.reference_error import unseen_error

__all__ = ["otherwise", "unseen_error"]
