"""PD control with gravity compensation: needs no inertias, and is passive."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.parts import (
    Values,
    assemble,
    errors,
    gain,
    saturate,
    signals_in,
    torque_out,
)
from irb2400_ctrl.controllers.scaling import (
    CANCELLED,
    RINGING,
    fastest_crossover,
    heaviest,
    slowed,
    stiffened,
    typical_inertia,
)
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.elasticity import rigid
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

BANDWIDTH = 40.0
"""natural frequency of an axis alone [rad/s], where the arm bears it"""


@typed
def gravity_pd(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    bandwidth: ArrayLike | None = None,
    damping: ArrayLike | None = None,
) -> Block:
    """tau = G(q) + Kp (q_ref - q) + Kd (qd_ref - qd).

    Kp = J bandwidth^2, Kd = 2 damping J bandwidth with J from `typical_inertia`.

    Args:
        robot: the arm it knows; sample_time: period [s].
        bandwidth: natural frequency of an axis alone [rad/s], one or one per joint; default 40.
        damping: damping ratio [-], one or one per joint; default 1. Where the inertia spans more
            over the postures than these bear at the sample time, the defaults are slower.
    """
    if bandwidth is None and damping is None:
        bandwidth, damping = _speeds(robot, sample_time)
    bandwidth = BANDWIDTH if bandwidth is None else bandwidth
    damping = 1.0 if damping is None else damping
    omega = gain(robot, "bandwidth", "rad/s", "natural frequency of an axis alone", bandwidth).start
    zeta = gain(robot, "damping", "-", "damping ratio", damping).start
    J = typical_inertia(robot)
    parameters = (
        gain(robot, "kp", "Nm/rad", "torque per angle error", J * omega**2),
        gain(robot, "kd", "Nm s/rad", "torque per speed error", 2 * zeta * J * omega),
    )
    gravity = Model(rigid(robot)).function("gravity")

    def law(v: Values) -> Values:
        weight = gravity.call([v["q"]], True, False)[0]
        error = v["q_ref"] - v["q"]
        speed_error = v["qd_ref"] - v["qd"]
        wanted = weight + v["kp"] * error + v["kd"] * speed_error
        steps = {"weight": weight, "error": error, "speed_error": speed_error}
        return {"tau": saturate(v, wanted), **steps}

    return assemble(
        "gravity_pd",
        "PD with gravity compensation",
        sample_time,
        law,
        states=(),
        inputs=signals_in(robot),
        outputs=torque_out(robot),
        parameters=parameters,
        told=(
            Field("weight", robot.n, "Nm", "torque of the arm at rest, G(q)"),
            *errors(robot),
        ),
    )


def _speeds(robot: Robot, sample_time: float) -> tuple[Array, Array]:
    """Bandwidth [rad/s] and damping ratio of each joint, as fast as margins over all postures
    allow.

    With the inertia m in units of Kd the loop is m s^2 + s + Kp / Kd: 1 / m has to stay below what
    the drive's delay allows where the arm is lightest, and the damping ratio above `RINGING` where
    it is heaviest. Kp is no smaller than a weight asks for that is cancelled late or in part.
    """
    J = typical_inertia(robot)
    kd = slowed(robot, 2 * BANDWIDTH * J, fastest_crossover(sample_time))
    kp = kd * np.minimum(BANDWIDTH / 2, 1 / (4 * RINGING**2 * heaviest(robot, kd)))
    bandwidth = np.sqrt(stiffened(robot, kp, CANCELLED) / J)
    return bandwidth, kd / (2 * J * bandwidth)
