"""The cascade of an industrial drive: P position loop around a PI speed loop, with or without the
model's torque."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.compensation import Compensation
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
from irb2400_ctrl.controllers.scaling import typical_inertia
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

DEADBAND = 1e-4
"""angle error [rad] that the integral leaves alone at rest; against static friction it would creep
and hunt"""


@typed
def pid(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    position_bandwidth: ArrayLike = 20.0,
    speed_bandwidth: ArrayLike = 80.0,
    integral_time: ArrayLike = 0.12,
    speed_feedforward: ArrayLike = 1.0,
) -> Block:
    """tau = Kv e_v + I,  e_v = Kp (q_ref - q) + ff qd_ref - qd,  dI/dt = Kv e_v / Ti: a drive's
    cascade P-PI.

    Kv = J speed_bandwidth with J from `typical_inertia`. It knows no model of the arm:
    gravity and friction come out of the integrator. Anti-windup by back-calculation. The integrator
    starts at zero, like a drive whose brake opens; the arm sags until it has found the weight.

    Args:
        robot: the arm it knows; sample_time: period [s].
        position_bandwidth: gain Kp of the position loop [1/s].
        speed_bandwidth: crossover of the speed loop [rad/s].
        integral_time: Ti of the speed loop [s].
        speed_feedforward: share of the reference speed that is fed forward [-].
    """
    return _cascade(
        "pid", "cascade P-PI of an industrial drive", robot, sample_time, None,
        (position_bandwidth, speed_bandwidth, integral_time, speed_feedforward),
    )  # fmt: skip


@typed
def feedforward_pid(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    position_bandwidth: ArrayLike = 20.0,
    speed_bandwidth: ArrayLike = 80.0,
    integral_time: ArrayLike = 0.12,
    speed_feedforward: ArrayLike = 1.0,
    tables: bool = False,
) -> Block:
    """The cascade of `pid` plus the model's torque along the reference: tau = ID(q_ref, qd_ref,
    qdd_ref) + Kv e_v + I.

    Args:
        robot: the arm it knows; sample_time: period [s].
        position_bandwidth, speed_bandwidth, integral_time, speed_feedforward: as in `pid`; the
            feed-forward torque contains friction and effects.
        tables: as in `computed_torque`.
    """
    return _cascade(
        "feedforward_pid", "cascade P-PI with the model's torque fed forward", robot, sample_time,
        Compensation(robot, sample_time, tables),
        (position_bandwidth, speed_bandwidth, integral_time, speed_feedforward),
    )  # fmt: skip


def _cascade(
    name: str,
    doc: str,
    robot: Robot,
    sample_time: float,
    model: Compensation | None,
    wish: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
) -> Block:
    position, speed, time, share = wish
    kv = typical_inertia(robot) * gain(robot, "speed_bandwidth", "rad/s", "", speed).start
    ti = gain(robot, "integral_time", "s", "", time).start
    parameters = (
        gain(robot, "kp", "1/s", "speed per angle error", position),
        gain(robot, "kv", "Nm s/rad", "torque per speed error", kv),
        gain(robot, "ki", "Nm/rad", "torque rate per speed error", kv / np.maximum(ti, 1e-6)),
        gain(robot, "feedforward", "-", "share of the reference speed fed forward", share),
        gain(robot, "deadband", "rad", "angle error that is left alone at rest", DEADBAND),
        gain(
            robot, "tracking", "s", "time constant of the anti-windup", np.maximum(ti, sample_time)
        ),
        *(() if model is None else model.parameters),
    )
    memory = () if model is None else model.states
    states = (Field("integral", robot.n, "Nm", "integral torque"), *memory)

    def law(v: Values) -> Values:
        error = v["kp"] * (v["q_ref"] - v["q"]) + v["feedforward"] * v["qd_ref"] - v["qd"]
        forward = ca.SX.zeros(robot.n)
        after = dict[str, ca.SX]()
        if model is not None:
            forward, after = model.torque(
                v, (v["q_ref"], v["qd_ref"], v["qdd_ref"]), v["qd_ref"], v["qd"]
            )
        wanted = forward + v["kv"] * error + v["integral"]
        tau = saturate(robot, wanted)
        still = resting(v["qd_ref"], v["q_ref"] - v["q"], v["deadband"])
        integral = back_calculated(
            v["integral"], (1 - still) * v["ki"] * error, tau - wanted, v["tracking"], sample_time
        )
        steps = {"error": error, "forward": forward, "still": still}
        return {"tau": tau, "integral": integral, **steps, **after}

    forward_torque = Field("forward", robot.n, "Nm", "torque of the model along the reference")
    return assemble(
        name, doc, sample_time, law,
        states=states, inputs=signals_in(robot), outputs=torque_out(robot), parameters=parameters,
        told=(
            Field("error", robot.n, "rad/s", "speed error of the inner loop"),
            Field("still", robot.n, "-", "1: at rest within the deadband, the integral is held"),
            *(() if model is None else (forward_torque, *model.told)),
        ),
    )  # fmt: skip
