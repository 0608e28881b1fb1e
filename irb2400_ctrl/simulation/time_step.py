"""One time step of the plant: leapfrog of the arm, fine friction steps of the actuators, elastic
transmissions.

    q_m = q + h/2 qd,   qd_m = qd + h/2 qdd_last        (angles of the links; the motors' where a
    joint is rigid) M, bias and the effects' share of the dry friction at (q_m, qd_m), held over the
    step `friction_steps` friction steps one after the other: springs at their middle, friction on
    the actuators

It is of second order, events of the dry friction included, with one evaluation of the dynamics per
step. The friction steps are finer than the dynamics because friction is faster: where the Stribeck
curve falls, a joint that breaks loose runs away with up to 4000 1/s.
"""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.effects.memory import next_memory
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.linear_solve import factorise
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.dry_friction import dry_friction_step
from irb2400_ctrl.simulation.mechanics import symbolic_mechanics
from irb2400_ctrl.simulation.spring_step import elastic_joints

STATES = ("q", "qd", "qdd", "dry", "time", "memory", "link", "link_rate", "link_acc")
"""of the actuators, the effects, and the links of elastic joints"""


def time_step(
    robot: Robot, h: float, friction_steps: int, sweeps: int, wrench: bool
) -> ca.Function:
    """(STATES, tau, wrench, phi, friction, effects, elastic) -> STATES after the time h."""
    n = robot.n
    soft = list(elastic_joints(robot))
    stiff = [j for j in range(n) if j not in soft]
    k = len(soft)
    mechanics = symbolic_mechanics(robot)
    q, qd, qdd, dry, tau = (ca.SX.sym(name, n) for name in ("q", "qd", "qdd", "dry", "tau"))
    link, link_rate, link_acc = (ca.SX.sym(name, k) for name in STATES[-3:])
    time = ca.SX.sym("time")
    memory = ca.SX.sym("memory", mechanics.memory_size)
    w = ca.SX.sym("wrench", 6 if wrench else 0)
    elastic = ca.SX.sym("elastic", k, 4)

    arguments = [q, qd, qdd, dry, time, memory, link, link_rate, link_acc, tau, w]
    arguments += [mechanics.phi, mechanics.table, mechanics.data, elastic]

    angle, speed, acceleration = (
        _put(a, soft, b) for a, b in ((q, link), (qd, link_rate), (qdd, link_acc))
    )
    q_m = angle + 0.5 * h * speed
    qd_m = speed + 0.5 * h * acceleration
    M, bias, effects, rate = mechanics.equations(q_m, qd_m, acceleration, time + 0.5 * h, memory)
    # the viscous friction of an elastic joint brakes its motor, not its link
    viscous = mechanics.law.viscous[soft]
    bias[soft] -= viscous * qd_m[soft]
    if wrench:
        bias -= kinematics.tcp_jacobian(robot, q_m).T @ w
    W = factorise(M).solve(ca.SX.eye(n))
    W_actuators = ca.SX(W)
    for place, j in enumerate(soft):
        W_actuators[j, :] = W_actuators[:, j] = 0
        W_actuators[j, j] = 1 / elastic[place, 2]

    part = h / friction_steps
    for _ in range(friction_steps):
        twist = q[soft] - link + 0.5 * part * (qd[soft] - link_rate)
        half_gap = 0.5 * elastic[:, 3]
        wound = twist - ca.fmin(ca.fmax(twist, -half_gap), half_gap)
        touching = ca.logic_or(wound != 0, half_gap == 0)
        twisting = qd[soft] - link_rate + 0.5 * part * (qdd[soft] - link_acc)
        spring = elastic[:, 0] * wound + touching * elastic[:, 1] * twisting
        acting = W @ (_put(tau, soft, spring) - bias)
        motors = (tau[soft] - spring - viscous * (qd[soft] + 0.5 * part * qdd[soft])) / elastic[
            :, 2
        ]
        free = _put(acting, soft, motors)
        v_end, dry = dry_friction_step(
            qd, qd + part * free, part * W_actuators, lambda v: mechanics.bounds(v, effects),
            (qd + part * qdd, dry), sweeps,
        )  # fmt: skip
        link_end = link_rate + part * (acting[soft] - W[soft, stiff] @ dry[stiff])
        q = q + 0.5 * part * (qd + v_end)
        link = link + 0.5 * part * (link_rate + link_end)
        qdd = (v_end - qd) / part
        link_acc = (link_end - link_rate) / part
        qd = v_end
        link_rate = link_end

    after = [q, qd, qdd, dry, time + h, next_memory(rate, memory, h), link, link_rate, link_acc]
    names = [*STATES, "tau", "wrench", "phi", "friction", "effects", "elastic"]
    dense = ca.cse([ca.densify(value) for value in after])
    return ca.Function("time_step", arguments, dense, names, [f"{name}_end" for name in STATES])


def _put(whole: ca.SX, places: list[int], values: ca.SX) -> ca.SX:
    """`whole` with the values at some places."""
    changed = ca.SX(whole)
    changed[places] = values
    return changed
