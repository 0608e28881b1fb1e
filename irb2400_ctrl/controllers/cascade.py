"""The cascade of an industrial drive: P position loop around a PI speed loop, with or without the
model's torque."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
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
from irb2400_ctrl.controllers.scaling import (
    CARRIED,
    FADING,
    fastest_crossover,
    heaviest,
    slowed,
    stiffened,
    typical_inertia,
)
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

POSITION = 20.0
"""gain of the position loop [1/s], where the arm bears it"""
SPEED = 80.0
"""crossover of the speed loop [rad/s], where the arm bears it"""
INTEGRAL = 0.12
"""Ti of the speed loop [s], where the arm bears it"""
INNER = 4.0
"""largest gain of the position loop in units of the slowest speed loop's crossover: damping 0.25"""
LAG = 1.5
LAG_OF_POSITION = 1.2
"""least Ti in units of the slowest speed loop's crossover, and the same per square of the position
gain in these units: sensitivity peak 2.5 of one inertia"""
DEADBAND = 1e-4
"""angle error [rad] that the integral leaves alone at rest; against static friction it would creep
and hunt"""


@typed
def pid(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    position_bandwidth: ArrayLike | None = None,
    speed_bandwidth: ArrayLike | None = None,
    integral_time: ArrayLike | None = None,
    speed_feedforward: ArrayLike = 1.0,
) -> Block:
    """tau = Kv e_v + I,  e_v = Kp (q_ref - q) + ff qd_ref - qd,  dI/dt = Kv e_v / Ti: a drive's
    cascade P-PI.

    Kv = J speed_bandwidth with J from `typical_inertia`. It knows no model of the arm:
    gravity and friction come out of the integrator. Anti-windup by back-calculation. The integrator
    starts at zero, like a drive whose brake opens; the arm sags until it has found the weight.

    Args:
        robot: the arm it knows; sample_time: period [s].
        position_bandwidth: gain Kp of the position loop [1/s]; default 20.
        speed_bandwidth: crossover of the speed loop [rad/s]; default 80.
        integral_time: Ti of the speed loop [s]; default 0.12. Where the inertia spans more over the
            postures than these bear at the sample time, the defaults are slower.
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
    position_bandwidth: ArrayLike | None = None,
    speed_bandwidth: ArrayLike | None = None,
    integral_time: ArrayLike | None = None,
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


def _speeds(
    robot: Robot,
    sample_time: float,
    position: ArrayLike | None,
    speed: ArrayLike | None,
    time: ArrayLike | None,
) -> tuple[ArrayLike, Array, Array]:
    """Kp [1/s], Kv [Nm s/rad] and Ti [s]: those stated, the others as fast as margins over all
    postures allow.

    With the inertia m in units of J the loop is m s^3 + w (s + 1 / Ti) (s + Kp): w / m has to stay
    below what the drive's delay allows where the arm is lightest. Where it is heaviest, it has to
    be above 1 / (1 / Kp + Ti) (Routh), here by a margin. Weight takes at most `CARRIED` of Kp. With
    viscous friction d the second term is (w + d) s^2, and the integral must not overtake Kp.

    Args:
        robot: the arm.
        sample_time: [s].
        position, speed, time: as stated, None: not.
    """
    J = typical_inertia(robot)
    if speed is None:
        kv = slowed(robot, J * SPEED, fastest_crossover(sample_time))
    else:
        kv = J * gain(robot, "speed_bandwidth", "rad/s", "", speed).start
    slow = np.full(robot.n, SPEED)
    if (position is None or time is None) and kv.all():
        slow = 1 / heaviest(robot, kv)
    if position is None:
        position = np.minimum(POSITION, INNER * slow)
        if kv.all():
            position = position * (stiffened(robot, kv * position, CARRIED) / (kv * position))
    if time is None:
        kp = gain(robot, "position_bandwidth", "1/s", "", position).start
        least = np.maximum(LAG, LAG_OF_POSITION * np.minimum(kp / slow, INNER) ** 2)
        time = np.maximum(INTEGRAL, least / slow)
        if (kv * kp).all():
            time = np.maximum(time, FADING * (kv + robot.friction[:, 2]) / (kv * kp))
    return position, kv, gain(robot, "integral_time", "s", "", time).start


def _cascade(
    name: str,
    doc: str,
    robot: Robot,
    sample_time: float,
    model: Compensation | None,
    wish: tuple[ArrayLike | None, ArrayLike | None, ArrayLike | None, ArrayLike],
) -> Block:
    *stated, share = wish
    position, kv, ti = _speeds(robot, sample_time, *stated)
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
        tau = saturate(v, wanted)
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
