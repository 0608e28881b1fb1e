"""The plant: an arm with dry friction, effects and elastic joints as a discrete-time block, its
numbers as inputs."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.given import positive, whole
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.effect_data import data_of
from irb2400_ctrl.simulation.mechanics import force_effects, mass_data
from irb2400_ctrl.simulation.spring_step import check_step, elastic_data, elastic_joints
from irb2400_ctrl.simulation.time_step import STATES, time_step
from irb2400_ctrl.typed import typed

SUBSTEPS = 1
FRICTION_STEPS = 2
SWEEPS = 2


@typed
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

    Inputs: `tau` (n,) [Nm]; with `wrench` also `wrench` (6,): force and moment on the tool at the
    TCP, base frame [N, Nm]. Outputs: `q_end`, `qd_end` of the actuators and `link_end` of the links
    at the *end* of the period; they differ where a joint is elastic. Parameters: link mass data
    `phi`, `friction`, and where there are any the numbers of the effects, `effects`, and of the
    elastic joints, `elastic`.

    Args:
        robot: the arm; its effects of kind force and parameters act, those of the measuring chain
            do not.
        sample_time: period of the controller [s].
        substeps: time steps per period; wrench: whether a force on the tool is an input.
        friction_steps: friction steps per time step.
        sweeps: Gauss-Seidel sweeps of the dry friction per friction step.
    """
    whole("friction_steps", friction_steps, 1)
    whole("sweeps", sweeps, 1)
    h = positive("sample_time", sample_time, "s") / whole("substeps", substeps, 1)
    check_step(robot, h / friction_steps)
    step = time_step(robot, h, friction_steps, sweeps, wrench)
    elastic = elastic_data(robot)
    states = _states(robot.n, step.numel_in("memory"), len(elastic))
    inputs = _inputs(robot.n, wrench)
    outputs = _outputs(robot.n)
    parameters = _parameters(robot, elastic)
    given = {f.name: ca.SX.sym(f.name, f.size) for f in (*states, *inputs, *parameters)}

    nothing = ca.SX(0, 1)
    x = [given.get(name, nothing) for name in STATES]
    held = [given["tau"], given.get("wrench", nothing)]
    data = _tables(given, robot.n, len(elastic))
    for _ in range(substeps):
        x = step.call([*x, *held, *data], True, False)

    end = dict(zip(STATES, x, strict=True))
    after = [value for name, value in end.items() if name in given]
    seen = [end["q"], end["qd"], link_angles(robot, end["q"], end["link"])]
    names_out = [*(f"{f.name}_next" for f in states), *(f.name for f in outputs)]
    function = ca.Function("plant", list(given.values()), [*after, *seen], list(given), names_out)
    return Block(
        "plant",
        f"arm, {substeps} steps of {1e3 * sample_time / substeps:g} ms per period",
        sample_time,
        tuple(states),
        tuple(inputs),
        tuple(outputs),
        tuple(parameters),
        function,
    )


def _states(n: int, memory_size: int, soft: int) -> list[Field]:
    """Of the actuators; where there are any, of effects with memory and of the elastic joints."""
    states = [
        Field("q", n, "rad", "actuator angles"),
        Field("qd", n, "rad/s", "actuator speeds"),
        Field("qdd", n, "rad/s2", "mean accelerations of the last step"),
        Field("dry", n, "Nm", "mean dry friction of the last step"),
        Field("time", 1, "s", "time since the start"),
    ]
    if memory_size:
        states.append(Field("memory", memory_size, "-", "internal states of the effects"))
    if soft:
        states += [
            Field("link", soft, "rad", "link angles of the elastic joints"),
            Field("link_rate", soft, "rad/s", "their speeds"),
            Field("link_acc", soft, "rad/s2", "their mean accelerations of the last step"),
        ]
    return states


def _inputs(n: int, wrench: bool) -> list[Field]:
    inputs = [Field("tau", n, "Nm", "torque of the actuators")]
    if wrench:
        doc = "force and moment on the tool at the TCP, base frame"
        inputs.append(Field("wrench", 6, "N, Nm", doc))
    return inputs


def _outputs(n: int) -> list[Field]:
    return [
        Field("q_end", n, "rad", "actuator angles"),
        Field("qd_end", n, "rad/s", "actuator speeds"),
        Field("link_end", n, "rad", "angles on the side of the links"),
    ]


def _parameters(robot: Robot, elastic: NDArray[np.float64]) -> list[Field]:
    """The robot's numbers, every table column by column."""
    n = robot.n
    mass = _column(mass_data(robot))
    mass_doc = "(m, m c, I_O) of the links, column by column"
    friction = _column(ca.DM(robot.friction))
    friction_doc = "F_s, F_c, F_v, omega_st, column by column"
    parameters = [
        Field("phi", 10 * n, "kg, kg m, kg m2", mass_doc, mass),
        Field("friction", 4 * n, "Nm, Nm, Nm s/rad, rad/s", friction_doc, friction),
    ]
    numbers = data_of(force_effects(robot))
    if numbers:
        doc = "coefficients, fields and shape of each effect"
        parameters.append(Field("effects", len(numbers), "units of the effects", doc, numbers))
    if len(elastic):
        unit = "Nm/rad, Nm s/rad, kg m2, rad, 1/rad"
        doc = "stiffness, damping, rotor inertia, gap, stiffening, column by column"
        springs = _column(ca.DM(elastic))
        parameters.append(Field("elastic", 5 * len(elastic), unit, doc, springs))
    return parameters


def _tables(given: dict[str, ca.SX], n: int, soft: int) -> list[ca.SX]:
    """phi, friction, effects, elastic in the shapes that `time_step` takes."""
    return [
        ca.reshape(given["phi"], n, 10),
        ca.reshape(given["friction"], n, 4),
        given.get("effects", ca.SX(0, 1)),
        ca.reshape(given["elastic"], soft, 5) if soft else ca.SX(0, 5),
    ]


def link_angles(robot: Robot, q: ca.SX, link: ca.SX) -> ca.SX:
    """Angles on the side of the links, shape (n,): those of the actuators, but `link` where a joint
    is elastic.

    Args:
        robot: with its elastic joints.
        q: of the actuators [rad], shape (n,).
        link: of the elastic joints [rad], one each.
    """
    angles = ca.SX(q)
    angles[list(elastic_joints(robot))] = link
    return angles


def _column(matrix: ca.DM) -> tuple[float, ...]:
    flat: NDArray[np.float64] = np.asarray(ca.densify(matrix)).ravel(order="F")
    return tuple(flat.tolist())
