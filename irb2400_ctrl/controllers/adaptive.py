"""Adaptive computed torque: learns the payload and the dry friction while the arm moves.

With the true values theta* the tracking error e = q_ref - q obeys

    e'' + Kd e' + Kp e = M(q)^-1 Y (theta* - theta).

Where M is constant and diagonal and Kd > slope (damping above 1/2), (p + slope) / (p^2 + Kd p + Kp)
is strictly positive real, and the gradient law drives e to zero. For an arm, whose M couples its
joints and changes, that is no proof: the law relies on learning slowly beside the error's own
motion (`adaptation_time` times `bandwidth` well above 1), wherever the arm is and however large
the error. theta goes to theta* only where the motion excites it.

Source: adaptive computed torque with a gradient law, the class of Craig, Hsu and Sastry, Int. J.
Robotics Research 6(2), 1987, but with the regressor at the commanded acceleration instead of the
measured one, and without the inverse of the estimated M in front of s. It is not the law of Slotine
and Li (1987), whose regressor takes a reference speed and which is stable for any M(q) by
passivity.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.compensation import SIGN_WIDTH, Compensation
from irb2400_ctrl.controllers.computed_torque import pd_gains, wanted_acceleration
from irb2400_ctrl.controllers.parts import (
    UNBOUNDED,
    Values,
    assemble,
    errors,
    gain,
    saturate,
    signals_in,
    strongest,
    torque_out,
)
from irb2400_ctrl.controllers.scaling import typical_inertia
from irb2400_ctrl.controllers.stribeck import fade
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

PAYLOAD = 4
"""learned of the load at the flange: mass and first moments; its own inertia is too small to be
told from them"""
LEAST = 1e-6
"""Kd [1/s] and learning limit [1/s] of a law without gains, which would be divided by"""
LEARNING = 0.75
"""learning limit in units of the bandwidth"""
UNSEEN = 1e-12
"""share of the largest mean square of the regressor's columns that is rounding"""


@typed
def adaptive(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    bandwidth: ArrayLike | None = None,
    damping: ArrayLike = 1.0,
    adaptation_time: float = 0.3,
) -> Block:
    """tau = tau_ct(q, qd, a) + Y(q, qd, a) theta,  d theta/dt = Gamma Y^T s / max(1, g / g_max),
    s = ed + slope e,  g = sum_ij Y_ij^2 Gamma_jj / (J Kd)_i,
    a = qdd_ref + Kd ed + Kp e the commanded acceleration, e = q_ref - q.

    g is how fast all is learned here; `learning_limit`, g_max, keeps a large error from speeding it
    up. theta stays below what would take a joint's whole torque in a typical motion.

    theta holds what a robot in use changes: the load at the flange (m, m c) and each joint's
    Coulomb friction. Unlike an integrator it keeps what it has learned when pose and direction
    change; friction acts in the direction of the reference. Learning stops while a joint is at its
    torque limit, and at rest, where static friction would teach it anything.

    Args:
        robot: the arm it knows; sample_time: period [s].
        bandwidth, damping: of the error, as in `computed_torque`.
        adaptation_time: how fast a parameter alone is learned in a typical motion [s].
    """
    if not adaptation_time > 0:
        raise InputError(f"adaptation_time is {adaptation_time} s; expected a positive time")
    model = Compensation(robot, sample_time)
    regressor = _regressor(robot)
    typical = _typical(robot, regressor)
    most = _most(robot, typical)
    J = typical_inertia(robot)
    learned = partial(_learned, J)

    def law(v: Values) -> Values:
        error = v["q_ref"] - v["q"]
        speed_error = v["qd_ref"] - v["qd"]
        wanted = v["qdd_ref"] + v["kd"] * speed_error + v["kp"] * error
        known, after = model.torque(v, (v["q"], v["qd"], wanted), v["qd_ref"], v["qd"])
        Y = regressor(v["q"], v["qd"], wanted, v["qd_ref"])
        asked = known + Y @ v["theta"]
        tau = saturate(v, asked)
        going = fade(v["qd_ref"], v["breakaway"])
        heard = going * (tau == asked) * (speed_error + v["slope"] * error)
        theta = v["theta"] + sample_time * learned(v, Y, heard)
        theta = ca.fmin(ca.fmax(theta, -most), most)
        steps = {"error": error, "speed_error": speed_error, "wanted": wanted, "Y": Y}
        return {"tau": tau, "theta": theta, **steps, "heard": heard, **after}

    pd = pd_gains(robot, sample_time, bandwidth, damping)
    gains = _gains(robot, pd, _rates(typical, J * np.maximum(pd[1].start, LEAST), adaptation_time))
    return assemble(
        "adaptive", "computed torque that learns load and dry friction", sample_time, law,
        states=(_theta(robot), *model.states),
        inputs=signals_in(robot),
        outputs=torque_out(robot),
        parameters=(*gains, *model.parameters),
        told=(*_told(robot), *model.told),
    )  # fmt: skip


def _told(robot: Robot) -> tuple[Field, ...]:
    return (
        *errors(robot),
        wanted_acceleration(robot),
        Field("heard", robot.n, "rad/s", "s = ed + slope e, where it is learned from"),
        Field("Y", robot.n * (PAYLOAD + robot.n), "", "regressor of what is learned"),
    )


def _learned(J: Array, v: Values, Y: ca.SX, heard: ca.SX) -> ca.SX:
    """d theta/dt, no faster than `learning_limit`.

    Args:
        J: typical inertia [kg m2], shape (n,).
        v: values by name.
        Y: regressor, shape (n, 4 + n).
        heard: s, where it is learned from [rad/s], shape (n,).
    """
    learning = ca.sum(Y**2 @ v["rate"] / (J * ca.fmax(v["kd"], LEAST)))
    share = v["learning_limit"] / ca.fmax(learning, v["learning_limit"])
    return share * v["rate"] * (Y.T @ heard)


def _theta(robot: Robot) -> Field:
    doc = "learned load (m, m c) and Coulomb friction, added to the model's"
    return Field("theta", PAYLOAD + robot.n, "kg, kg m, Nm", doc)


def _gains(robot: Robot, pd: tuple[Field, Field], rate: Array) -> tuple[Field, ...]:
    """Those of the error, and how fast is learned beside them.

    Args:
        robot: the arm it knows.
        pd: Kp and Kd.
        rate: the diagonal of Gamma, shape (4 + n,).
    """
    kp, kd = pd
    omega = np.sqrt(kp.start)
    limit = max(LEARNING * float(omega.min()), LEAST)
    return (
        kp,
        kd,
        Field(
            "rate",
            PAYLOAD + robot.n,
            "theta^2/(Nm rad)",
            "learning rates, the diagonal of Gamma",
            tuple(rate.tolist()),
        ),
        gain(robot, "slope", "1/s", "weight of the angle error in s", omega),
        Field("learning_limit", 1, "1/s", "fastest learning of all together", (limit,), (LEAST,)),
    )


def _regressor(robot: Robot) -> ca.Function:
    """(q, qd, qdd, qd_ref) -> Y, shape (n, 4 + n)."""
    s = Model(robot).signals()
    qd_ref = ca.SX.sym("qd_ref", robot.n)
    s = replace(s, sign=qd_ref / ca.sqrt(qd_ref**2 + SIGN_WIDTH**2))
    load = s.regressor(robot.n + 1)[:, :PAYLOAD]
    Y = ca.densify(ca.cse(ca.horzcat(load, ca.diag(s.sign))))
    return ca.Function("regressor", [s.q, s.qd, s.qdd, qd_ref], [Y])


def _typical(robot: Robot, regressor: ca.Function) -> Array:
    """Y in a typical motion, shape (k, n, 4 + n)."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(64):
        q = rng.uniform(robot.q_min, robot.q_max)
        qd = rng.uniform(-0.5, 0.5, robot.n) * robot.qd_max
        found.append(np.asarray(regressor(q, qd, np.zeros(robot.n), qd)))
    return np.stack(found)


def _rates(typical: Array, stiffness: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Gamma_ii = 1 / (T sum_j mean Y_ji^2 / (J Kd)_j): each parameter alone converges in about
    T; zero where no motion shows it, such as a load's place along the axes of a planar arm.

    Args:
        typical: Y in a typical motion, shape (k, n, p).
        stiffness: J Kd [Nm s/rad], shape (n,).
        time: T [s].
    """
    power = np.zeros(typical.shape[2])
    for Y in typical:
        power += (Y**2 / stiffness[:, None]).sum(axis=0) / len(typical)
    shown = power > UNSEEN * power.max()
    return np.where(shown, 1.0 / (time * np.where(shown, power, 1.0)), 0.0)


def _most(robot: Robot, typical: Array) -> Array:
    """Largest |theta|: what alone takes a joint's whole torque in a typical motion, (4 + n,). No
    tighter: a load below zero stands for links that are lighter than the file has them."""
    shown = np.sqrt((typical**2).mean(axis=0))
    most = strongest(robot)[:, None]
    return np.asarray((most / np.maximum(shown, most / UNBOUNDED)).min(axis=0))
