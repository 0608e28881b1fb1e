"""Computed torque with integral action."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.compensation import Compensation
from irb2400_ctrl.controllers.computed_torque import pd_gains, wanted_acceleration
from irb2400_ctrl.controllers.parts import (
    Values,
    assemble,
    back_calculated,
    gain,
    resting,
    saturate,
    signals_in,
    torque_out,
)
from irb2400_ctrl.controllers.scaling import FADING, inertia_span, typical_inertia
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

INTEGRAL = 0.1
"""Ti [s], where the arm bears it"""
BEHIND = 6.0
"""least Ti in units of 1 / bandwidth"""
OVERTAKEN = 1.8
"""least Kd Ti m in the lightest direction, m in units of J: sensitivity peak 1.6; unstable below
1"""


@typed
def computed_torque_integral(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    bandwidth: ArrayLike | None = None,
    damping: ArrayLike = 1.0,
    integral_time: ArrayLike | None = None,
    deadband: ArrayLike = 1e-4,
    tables: bool = False,
) -> Block:
    """Computed torque plus an integral torque: tau = tau_ct + I,  dI/dt = J Kp e / Ti.

    J: `typical_inertia`. Anti-windup by back-calculation. While the reference rests and the error
    is inside the deadband the integral holds still: against static friction it would otherwise
    creep and hunt.

    Args:
        robot: the arm it knows; sample_time: period [s].
        bandwidth, damping: of the error, as in `computed_torque`.
        integral_time: Ti [s]; default 0.1, longer for a light arm or a bandwidth below 60.
        deadband: angle error that is left alone at rest [rad].
        tables: as in `computed_torque`.
    """
    model = Compensation(robot, sample_time, tables)
    kp, kd = pd_gains(robot, sample_time, bandwidth, damping)
    ti = _integral_time(robot, integral_time, kp.start, kd.start)
    ki = typical_inertia(robot) * kp.start / np.maximum(ti, 1e-6)
    slow = np.maximum(ti, sample_time)
    parameters = (
        kp,
        kd,
        gain(robot, "ki", "Nm/(rad s)", "torque rate per angle error", ki),
        gain(robot, "deadband", "rad", "angle error that is left alone at rest", deadband),
        gain(robot, "tracking", "s", "time constant of the anti-windup", slow),
        *model.parameters,
    )

    def law(v: Values) -> Values:
        error = v["q_ref"] - v["q"]
        wanted = v["qdd_ref"] + v["kd"] * (v["qd_ref"] - v["qd"]) + v["kp"] * error
        known, after = model.torque(v, (v["q"], v["qd"], wanted), v["qd_ref"], v["qd"])
        asked = known + v["integral"]
        tau = saturate(v, asked)
        moving = 1 - resting(v["qd_ref"], error, v["deadband"])
        integral = back_calculated(
            v["integral"], moving * v["ki"] * error, tau - asked, v["tracking"], sample_time
        )
        return {"tau": tau, "integral": integral, "wanted": wanted, **after}

    return assemble(
        "computed_torque_integral",
        "computed torque with integral action",
        sample_time,
        law,
        states=(Field("integral", robot.n, "Nm", "integral torque"), *model.states),
        inputs=signals_in(robot),
        outputs=torque_out(robot),
        parameters=parameters,
        told=(wanted_acceleration(robot), *model.told),
    )


def _integral_time(robot: Robot, stated: ArrayLike | None, kp: Array, kd: Array) -> Array:
    """Ti [s]: the loop is s^3 + Kd s^2 + Kp s + Kp / (m Ti), unstable where Kd Ti m < 1 (Routh).
    Viscous friction d, which is compensated along the reference, makes Kd + d / J of Kd.

    Args:
        robot: the arm.
        stated: by the user, None: not.
        kp: acceleration per angle error [1/s2], shape (n,).
        kd: acceleration per speed error [1/s], shape (n,).
    """
    if stated is None:
        stated = INTEGRAL
        if (kp * kd).all():
            J = typical_inertia(robot)
            light = inertia_span(robot, J).light
            least = max(INTEGRAL, OVERTAKEN / (light * float(kd.min())))
            fading = FADING * (kd + robot.friction[:, 2] / J) / kp
            stated = np.maximum(least, np.maximum(fading, BEHIND / np.sqrt(kp)))
    return gain(robot, "integral_time", "s", "", stated).start
