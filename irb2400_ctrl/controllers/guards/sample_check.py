"""Whether a measured sample can be true: its numbers, its distance from the sample before, and its
distance from the reference."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.codegen import Field
from irb2400_ctrl.controllers.parts import BEYOND, FASTEST, Values, fastest
from irb2400_ctrl.robot import Robot

JUMP = 0.5
"""how far an angle may lie from where the last one and its speed lead, as a share of the axis'
speed limit times the sample time; ten times what full torque does in a sample"""
LEADING = float(np.radians(5.0))
"""[rad] largest distance from the reference: an axis farther away is not under control"""
LAGGING = float(np.radians(8.0))
"""the same under a controller that knows nothing of the acceleration that is asked for:
`gravity_pd` leaves 5.1 deg on axis 6 in the motion of the demo"""


@dataclass(frozen=True)
class SampleCheck:
    """The tests of one sample, as expressions.

    Args:
        error: largest distance from the reference that is under control [rad].
    """

    robot: Robot
    sample_time: float
    error: float

    @property
    def parameters(self) -> tuple[Field, ...]:
        """What can be tuned without new code."""
        n = self.robot.n
        doc = "largest distance from the reference that is under control"
        error = Field("error_limit", n, "rad", doc, (self.error,) * n, lower=(0.0,) * n)
        doc = "largest jump of an angle in a sample, beside its speed"
        jump = tuple((JUMP * self.sample_time * self.fast).tolist())
        return (error, Field("jump_limit", n, "rad", doc, jump, lower=(0.0,) * n))

    @property
    def fast(self) -> np.ndarray:
        """Speed limits [rad/s], shape (n,)."""
        return fastest(self.robot)

    def can_be_true(self, v: Values) -> ca.SX:
        """1 where the sample is fresh, inside the joint box and the speeds, and no jump.

        A comparison with a number that is none is false. After k samples that were not believed the
        jump may be k + 1 times as large.
        """
        robot = self.robot
        waited = 1 + v["lost"]
        moved = v["q"] - v["q_last"] - self.sample_time * v["qd_last"]
        near = ca.fabs(moved) <= waited * v["jump_limit"]
        inside = [
            v["q"] >= ca.DM(robot.q_min - BEYOND),
            v["q"] <= ca.DM(robot.q_max + BEYOND),
            ca.fabs(v["qd"]) <= ca.DM(FASTEST * self.fast),
        ]
        # before the first sample there is none to be near to
        first = v["blend"] <= 0
        rows = [*(row for test in inside for row in ca.vertsplit(test))]
        rows += [ca.logic_or(first, row) for row in ca.vertsplit(near)]
        return all_of([v["fresh"] > 0.5, *rows])

    def under_control(self, v: Values) -> ca.SX:
        """1 where every measured angle is near its reference."""
        near = ca.fabs(v["q_ref"] - v["q"]) <= v["error_limit"]
        return all_of(ca.vertsplit(near))


def all_of(conditions: list[ca.SX]) -> ca.SX:
    """1 where every condition holds."""
    result = conditions[0]
    for condition in conditions[1:]:
        result = ca.logic_and(result, condition)
    return result
