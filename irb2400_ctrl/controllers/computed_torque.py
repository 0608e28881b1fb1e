"""Computed torque: the model linearises the arm, a PD law shapes the double integrators that
remain."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.compensation import Compensation
from irb2400_ctrl.controllers.parts import Values, assemble, gain, saturate, signals_in, torque_out
from irb2400_ctrl.controllers.scaling import fastest_crossover
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

BANDWIDTH = 60.0
"""of the error [rad/s], where the sample time bears it"""
SHARE = 0.81
"""of the crossover that the drive's delay leaves a speed loop, for Kd: with the position gain, the
sensitivity peaks by 2.5"""


@typed
def computed_torque(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    bandwidth: ArrayLike | None = None,
    damping: ArrayLike = 1.0,
    tables: bool = False,
) -> Block:
    """tau = M(q) (qdd_ref + Kd (qd_ref - qd) + Kp (q_ref - q)) + C(q, qd) qd + G(q) + F(qd_ref) +
    effects.

    Kp = bandwidth^2, Kd = 2 damping bandwidth: each joint's error obeys e'' + Kd e' + Kp e = 0 on
    the nominal arm.

    Args:
        robot: the arm it knows; sample_time: period [s].
        bandwidth: natural frequency of the error [rad/s], one or one per joint; default 60, less
            where the sample time is above 3 ms.
        damping: damping ratio [-], one or one per joint.
        tables: payload, friction and the numbers of the robot's effects are parameters of the
            block, to be set while it runs.
    """
    model = Compensation(robot, sample_time, tables)
    parameters = (*pd_gains(robot, sample_time, bandwidth, damping), *model.parameters)

    def law(v: Values) -> Values:
        wanted = v["qdd_ref"] + v["kd"] * (v["qd_ref"] - v["qd"]) + v["kp"] * (v["q_ref"] - v["q"])
        tau, after = model.torque(v, (v["q"], v["qd"], wanted), v["qd_ref"], v["qd"])
        return {"tau": saturate(v, tau), "wanted": wanted, **after}

    return assemble(
        "computed_torque",
        "inverse dynamics with a PD law on the acceleration",
        sample_time,
        law,
        states=model.states,
        inputs=signals_in(robot),
        outputs=torque_out(robot),
        parameters=parameters,
        told=(wanted_acceleration(robot), *model.told),
    )


def wanted_acceleration(robot: Robot) -> Field:
    """What the law calls `wanted`."""
    return Field("wanted", robot.n, "rad/s2", "acceleration that the law asks for")


def pd_gains(
    robot: Robot, sample_time: float, bandwidth: ArrayLike | None, damping: ArrayLike
) -> tuple[Field, Field]:
    """Kp = bandwidth^2 and Kd = 2 damping bandwidth as parameters.

    Args:
        robot: whose joints they are of.
        sample_time: period [s].
        bandwidth: [rad/s], one number or shape (n,); None: no faster than leaves margins at the
            sample time.
        damping: zeta [-], one number or shape (n,).
    """
    zeta = gain(robot, "damping", "-", "damping ratio of the tracking error", damping).start
    if bandwidth is None:
        borne = SHARE * fastest_crossover(sample_time) / (2 * np.maximum(zeta, 1.0))
        bandwidth = np.minimum(BANDWIDTH, borne)
    omega = gain(
        robot, "bandwidth", "rad/s", "natural frequency of the tracking error", bandwidth
    ).start
    return (
        gain(robot, "kp", "1/s2", "acceleration per angle error", omega**2),
        gain(robot, "kd", "1/s", "acceleration per speed error", 2 * zeta * omega),
    )
