"""Controllers of the arm as discrete-time blocks: the same objects are simulated and become C."""

from irb2400_ctrl.controllers.adaptive import adaptive
from irb2400_ctrl.controllers.cascade import feedforward_pid, pid
from irb2400_ctrl.controllers.computed_torque import computed_torque
from irb2400_ctrl.controllers.computed_torque_integral import computed_torque_integral
from irb2400_ctrl.controllers.gravity_pd import gravity_pd
from irb2400_ctrl.controllers.guard import guarded
from irb2400_ctrl.controllers.momentum import momentum_observer
from irb2400_ctrl.controllers.registry import CONTROLLERS, controller
from irb2400_ctrl.controllers.timing import Timing

__all__ = [
    "CONTROLLERS",
    "Timing",
    "adaptive",
    "computed_torque",
    "computed_torque_integral",
    "controller",
    "feedforward_pid",
    "gravity_pd",
    "guarded",
    "momentum_observer",
    "pid",
]
