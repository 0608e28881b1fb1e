"""The plant: a rigid arm with dry friction and effects as a discrete-time block, the numbers of all as parameters.

One time step h (a control period holds `substeps` of them, the torque constant over it) is a leapfrog:

    q_m = q + h/2 qd,   qd_m = qd + h/2 qdd_last,   qdd_last the mean acceleration of the step before
    M, bias and the effects' share of the dry friction at (q_m, qd_m), held over the step
    `friction_steps` friction steps (`dry_friction`) one after the other, which give qd+ and the way q+ - q

It is of second order, events of the dry friction included, with one evaluation of the dynamics per step. The friction
steps are finer than the dynamics because friction is faster: where the Stribeck curve falls, a joint that breaks loose
runs away with up to 4000 1/s.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.effects.memory import next_memory
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.linear_solve import factorise
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.dry_friction import dry_friction_step
from irb2400_ctrl.simulation.effect_data import data_of
from irb2400_ctrl.simulation.mechanics import force_effects, mass_data, symbolic_mechanics

SUBSTEPS = 1
FRICTION_STEPS = 2
SWEEPS = 2
STATES = ("q", "qd", "qdd", "dry", "time", "memory")


def plant_block(
    robot: Robot,
    sample_time: float = 0.001,
    *,
    substeps: int = SUBSTEPS,
    friction_steps: int = FRICTION_STEPS,
    sweeps: int = SWEEPS,
    wrench: bool = False,
) -> Block:
    """The arm between two samples of the controller, the torque held.

    Inputs: `tau` (n,) [Nm]; with `wrench` also `wrench` (6,): force and moment on the tool at the TCP, base frame
    [N, Nm]. Outputs: `q`, `qd` at the *end* of the period. Parameters: link mass data `phi`, `friction`, and the
    numbers of the effects, `effects`, where there are any.

    Args:
        robot: the arm; its effects of kind force and parameters act, those of the measuring chain do not.
        sample_time: period of the controller [s].
        substeps: time steps per period.
        friction_steps: friction steps per time step.
        sweeps: Gauss-Seidel sweeps of the dry friction per friction step.
    """
    if min(substeps, friction_steps, sweeps) < 1:
        found = f"{substeps} substeps, {friction_steps} friction steps, {sweeps} sweeps"
        raise InputError(f"plant: found {found}; expected at least one of each")
    n = robot.n
    step = _time_step(robot, sample_time / substeps, friction_steps, sweeps, wrench)
    memory_size = step.numel_in("memory")
    states = [
        Field("q", n, "rad", "actuator angles"),
        Field("qd", n, "rad/s", "actuator speeds"),
        Field("qdd", n, "rad/s2", "mean accelerations of the last step"),
        Field("dry", n, "Nm", "mean dry friction of the last step"),
        Field("time", 1, "s", "time since the start"),
    ]
    if memory_size:
        states.append(Field("memory", memory_size, "-", "internal states of the effects"))
    inputs = [Field("tau", n, "Nm", "torque of the actuators")]
    if wrench:
        inputs.append(Field("wrench", 6, "N, Nm", "force and moment on the tool at the TCP, base frame"))
    outputs = [Field("q_end", n, "rad", "actuator angles"), Field("qd_end", n, "rad/s", "actuator speeds")]
    mass, friction = _column(mass_data(robot)), _column(ca.DM(robot.friction))
    parameters = [
        Field("phi", 10 * n, "kg, kg m, kg m2", "(m, m c, I_O) of the links, column by column", mass),
        Field("friction", 4 * n, "Nm, Nm, Nm s/rad, rad/s", "F_s, F_c, F_v, omega_st, column by column", friction),
    ]
    numbers = data_of(force_effects(robot))
    if numbers:
        doc = "coefficients, fields and shape of each effect"
        parameters.append(Field("effects", len(numbers), "units of the effects", doc, numbers))
    given = {field.name: ca.SX.sym(field.name, field.size) for field in (*states, *inputs, *parameters)}
    x = [given.get(name, ca.SX(0, 1)) for name in STATES]
    held = [given["tau"], given.get("wrench", ca.SX(0, 1))]
    data = [ca.reshape(given["phi"], n, 10), ca.reshape(given["friction"], n, 4), given.get("effects", ca.SX(0, 1))]
    for _ in range(substeps):
        x = step.call([*x, *held, *data], True, False)
    after = [value for name, value in zip(STATES, x, strict=True) if name in given]
    names_out = [*(f"{f.name}_next" for f in states), *(f.name for f in outputs)]
    function = ca.Function("plant", list(given.values()), [*after, x[0], x[1]], list(given), names_out)
    doc = f"rigid arm, {substeps} steps of {1e3 * sample_time / substeps:g} ms per period"
    return Block("plant", doc, sample_time, tuple(states), tuple(inputs), tuple(outputs), tuple(parameters), function)


def _time_step(robot: Robot, h: float, friction_steps: int, sweeps: int, wrench: bool) -> ca.Function:
    """(q, qd, qdd, dry, time, memory, tau, wrench, phi, friction, effects) -> the first six after the time h."""
    n = robot.n
    mechanics = symbolic_mechanics(robot)
    q, qd, qdd, dry = (ca.SX.sym(name, n) for name in ("q", "qd", "qdd", "dry"))
    time, memory, tau = ca.SX.sym("time"), ca.SX.sym("memory", mechanics.memory_size), ca.SX.sym("tau", n)
    w = ca.SX.sym("wrench", 6 if wrench else 0)
    q_m, qd_m = q + 0.5 * h * qd, qd + 0.5 * h * qdd
    M, bias, effects, rate = mechanics.equations(q_m, qd_m, qdd, time + 0.5 * h, memory)
    W = factorise(M).solve(ca.SX.eye(n))
    load = tau - bias
    if wrench:
        load += kinematics.tcp_jacobian(robot, q_m).T @ w
    free, part = W @ load, h / friction_steps
    v, moved, acceleration, f = qd, ca.SX.zeros(n), qdd, dry
    for _ in range(friction_steps):
        v_end, f = dry_friction_step(
            v, v + part * free, part * W, lambda speed: mechanics.bounds(speed, effects),
            (v + part * acceleration, f), sweeps,
        )  # fmt: skip
        moved, acceleration, v = moved + 0.5 * part * (v + v_end), (v_end - v) / part, v_end
    after = [q + moved, v, acceleration, f, time + h, next_memory(rate, memory, h)]
    arguments = [q, qd, qdd, dry, time, memory, tau, w, mechanics.phi, mechanics.table, mechanics.data]
    names = [*STATES, "tau", "wrench", "phi", "friction", "effects"]
    dense = ca.cse([ca.densify(value) for value in after])
    return ca.Function("time_step", arguments, dense, names, [f"{name}_end" for name in STATES])


def _column(matrix: ca.DM) -> tuple[float, ...]:
    flat: NDArray[np.float64] = np.asarray(ca.densify(matrix)).ravel(order="F")
    return tuple(flat.tolist())
