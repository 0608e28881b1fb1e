"""One time step of the plant: leapfrog of the arm, fine friction steps of the actuators, elastic
transmissions.

    q_m = q + h/2 qd,   qd_m = qd + h/2 qdd_last
    M, bias and the effects' share of the dry friction at (q_m, qd_m), held over the step
    `friction_steps` friction steps one after the other: springs at their middle, friction on the
    actuators

q and qd are angles and speeds of the links, which are the motors' where a joint is rigid.

It is of second order, events of the dry friction included, with one evaluation of the dynamics per
step. The friction steps are finer than the dynamics because friction is faster: where the Stribeck
curve falls, a joint that breaks loose runs away with up to 4000 1/s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca

from irb2400_ctrl.effects.memory import next_memory
from irb2400_ctrl.effects.transmission import wound_torque
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.linear_solve import factorise
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.dry_friction import Bounds, dry_friction_step
from irb2400_ctrl.simulation.mechanics import symbolic_mechanics
from irb2400_ctrl.simulation.spring_step import elastic_joints

STATES = ("q", "qd", "qdd", "dry", "time", "memory", "link", "link_rate", "link_acc")
"""of the actuators, the effects, and the links of elastic joints"""


def time_step(
    robot: Robot, h: float, friction_steps: int, sweeps: int, wrench: bool
) -> ca.Function:
    """(STATES, tau, wrench, phi, friction, effects, elastic) -> STATES after the time h.

    Args:
        robot: the plant.
        h: [s].
        friction_steps: one after another in the time h.
        sweeps: of that solution over the joints.
        wrench: whether force and moment act at the tool.
    """
    soft = list(elastic_joints(robot))
    mechanics = symbolic_mechanics(robot)
    x = _State.symbols(robot.n, len(soft), mechanics.memory_size)
    tau = ca.SX.sym("tau", robot.n)
    w = ca.SX.sym("wrench", 6 if wrench else 0)
    elastic = ca.SX.sym("elastic", len(soft), 5)
    arguments = [*x.parts(), tau, w]
    arguments += [mechanics.phi, mechanics.table, mechanics.data, elastic]

    acceleration = _put(x.qdd, soft, x.link_acc)
    q_m = _put(x.q, soft, x.link) + 0.5 * h * _put(x.qd, soft, x.link_rate)
    qd_m = _put(x.qd, soft, x.link_rate) + 0.5 * h * acceleration
    M, bias, effects, memory_rate = mechanics.equations(
        q_m, qd_m, acceleration, x.time + 0.5 * h, x.memory
    )
    # the viscous friction of an elastic joint brakes its motor, not its link
    viscous = mechanics.law.viscous[soft, 0]
    bias[soft, 0] -= viscous * qd_m[soft, 0]
    if wrench:
        bias -= kinematics.tcp_jacobian(robot, q_m).T @ w
    held = _Held(
        soft=soft,
        tau=tau,
        bias=bias,
        W=factorise(M).solve(ca.SX.eye(robot.n)),
        viscous=viscous,
        elastic=elastic,
        bounds=lambda v: mechanics.bounds(v, effects),
    )

    end = x
    for _ in range(friction_steps):
        end = _friction_step(end, held, h / friction_steps, sweeps)
    end = replace(end, time=x.time + h, memory=next_memory(memory_rate, x.memory, h))
    dense = ca.cse([ca.densify(value) for value in end.parts()])
    names = [*STATES, "tau", "wrench", "phi", "friction", "effects", "elastic"]
    return ca.Function("time_step", arguments, dense, names, [f"{name}_end" for name in STATES])


@dataclass(frozen=True)
class _State:
    """The STATES as expressions."""

    q: ca.SX
    qd: ca.SX
    qdd: ca.SX
    dry: ca.SX
    time: ca.SX
    memory: ca.SX
    link: ca.SX
    link_rate: ca.SX
    link_acc: ca.SX

    @classmethod
    def symbols(cls, n: int, soft: int, memory_size: int) -> _State:
        sizes = (n, n, n, n, 1, memory_size, soft, soft, soft)
        return cls(*(ca.SX.sym(name, k) for name, k in zip(STATES, sizes, strict=True)))

    def parts(self) -> list[ca.SX]:
        """In the order of STATES."""
        return [getattr(self, name) for name in STATES]


@dataclass(frozen=True)
class _Held:
    """What stands still during the friction steps of one time step."""

    soft: list[int]
    """elastic joints"""
    tau: ca.SX
    bias: ca.SX
    W: ca.SX
    """inverse of the mass matrix"""
    viscous: ca.SX
    """of the elastic joints' motors"""
    elastic: ca.SX
    bounds: Callable[[ca.SX], Bounds]
    """of the dry friction at some speeds"""

    def actuator_mobility(self) -> ca.SX:
        """Acceleration of the actuators per torque: behind a spring, of the rotor alone."""
        mobility = ca.SX(self.W)
        for place, j in enumerate(self.soft):
            mobility[j, :] = mobility[:, j] = 0
            mobility[j, j] = 1 / self.elastic[place, 2]
        return mobility


def _friction_step(x: _State, held: _Held, part: float, sweeps: int) -> _State:
    """Springs at the middle of the step, then dry friction on the actuators."""
    soft = held.soft
    stiff = [j for j in range(x.q.numel()) if j not in soft]
    spring = _spring_torque(x, held, part)
    acting = held.W @ (_put(held.tau, soft, spring) - held.bias)
    braking = held.viscous * (x.qd[soft, 0] + 0.5 * part * x.qdd[soft, 0])
    motors = (held.tau[soft, 0] - spring - braking) / held.elastic[:, 2]
    free = _put(acting, soft, motors)
    v_end, dry = dry_friction_step(
        x.qd,
        x.qd + part * free,
        part * held.actuator_mobility(),
        held.bounds,
        (x.qd + part * x.qdd, x.dry),
        sweeps,
    )
    link_end = x.link_rate + part * (acting[soft, 0] - held.W[soft, stiff] @ dry[stiff, 0])
    return replace(
        x,
        q=x.q + 0.5 * part * (x.qd + v_end),
        qd=v_end,
        qdd=(v_end - x.qd) / part,
        dry=dry,
        link=x.link + 0.5 * part * (x.link_rate + link_end),
        link_rate=link_end,
        link_acc=(link_end - x.link_rate) / part,
    )


def _spring_torque(x: _State, held: _Held, part: float) -> ca.SX:
    """(k / a) sinh(a twist beyond the gap) + d twist rate of the elastic joints, where the teeth
    touch."""
    soft = held.soft
    rate = x.qd[soft, 0] - x.link_rate
    twist = x.q[soft, 0] - x.link + 0.5 * part * rate
    half_gap = 0.5 * held.elastic[:, 3]
    wound = twist - ca.fmin(ca.fmax(twist, -half_gap), half_gap)
    touching = ca.logic_or(wound != 0, half_gap == 0)
    twisting = rate + 0.5 * part * (x.qdd[soft, 0] - x.link_acc)
    stiffness = held.elastic[:, 0]
    damping = held.elastic[:, 1]
    torque = wound_torque(wound, stiffness, held.elastic[:, 4])
    return torque + touching * damping * twisting


def _put(whole: ca.SX, places: list[int], values: ca.SX) -> ca.SX:
    """`whole` with the values at some places."""
    changed = ca.SX(whole)
    changed[places] = values
    return changed
