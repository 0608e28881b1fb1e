"""`Certificate`: everything that is needed to check a timed path again, without the solver that
made it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, Way
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.typed import typed


@dataclass(frozen=True)
class Certificate:
    """A motion: the joint path, the grid with sdot^2 on it, and the limits it claims to keep."""

    path: JointPath
    law: TimeLaw
    limits: MotionLimits
    carriage: Way | None = None
    """where the base of the arm goes per metre of the first axis behind the arm's, a rail; None
    without one"""


@typed
def check(certificate: Certificate, model: Model, dynamics: PathDynamics | None = None) -> Checked:
    """Bound torque, speed and what else is limited over all times, from the motion's own numbers
    alone: nothing that the solver computed is used.

    Args:
        certificate: what a plan or a timing promises; model: the arm it is checked with.
        dynamics: of the path, where they are made already.
    """
    if dynamics is None:
        external = certificate.path.n - model.robot.n
        dynamics = _dynamics(model, external, certificate.carriage)
    return certificate.law.bounds(certificate.path, certificate.limits, dynamics)


# a program has many certificates of one arm; apart from the solver's own
_dynamics = lru_cache(maxsize=8)(PathDynamics)
