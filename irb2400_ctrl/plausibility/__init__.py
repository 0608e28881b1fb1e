"""Whether a log can be what it says it is, before anything is made of it."""

from irb2400_ctrl.plausibility.log_check import LogCheck, check_log, log_problem
from irb2400_ctrl.plausibility.problem import LogProblem

__all__ = ["LogCheck", "LogProblem", "check_log", "log_problem"]
