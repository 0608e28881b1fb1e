"""What stands around the controller on a machine, in the loop that is simulated: the package's test
of its inputs, the brakes, the end stops."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.codegen.input_guard import believed
from irb2400_ctrl.codegen.package_pages import inside
from irb2400_ctrl.controllers.parts import BEYOND
from irb2400_ctrl.robot import Robot

Values = dict[str, ca.SX]
STOP_RAD = 0.02
"""how far beyond the angles that the controller believes the end stops stand [rad]"""
STOP_DEPTH = 0.01
"""by how much a stop gives way under the axis' torque limit [rad]"""
STOP_TIME = 0.01
"""damping of a stop over its stiffness [s]"""
BRAKE_TIME = 0.02
"""from the signal until a brake holds, with the torque limit of its axis [s]"""
ANY_TORQUE = 1e6
"""[Nm] with which the brake of an axis holds whose torque limit is unknown"""
BRAKE_CLOCK = Field("brake_time", 1, "s", "time since the brake was signalled")


def has_brake(controller: Block) -> bool:
    """Whether the controller says when to close the brakes."""
    return any(f.name == "brake" for f in controller.outputs)


def as_packaged(controller: Block, values: Values, run: Callable[..., Values]) -> Values:
    """One step of the controller as its C package makes it.

    An input outside its bounds: the state stands still, the last good output is repeated, `fault`
    is 1. Outputs are cut at theirs.

    Args:
        controller: whose step it is.
        values: its states, inputs and parameters, each name behind `c_`.
        run: makes the plain step.
    """
    control = run(controller, "c_", values)
    tests = [test for f in believed(controller) for test in _inside(f, values[f"c_{f.name}"])]
    valid = ca.SX(1)
    for test in tests:
        valid = ca.logic_and(valid, test)
    result: Values = {"fault": ca.logic_not(valid)}
    for f in controller.states:
        old = values[f"c_{f.name}"]
        result[f"{f.name}_next"] = ca.if_else(valid, control[f"{f.name}_next"], old)
    for f in controller.outputs:
        sent = _cut(controller, f, control[f.name], values)
        result[f.name] = ca.if_else(valid, sent, values[f"held_{f.name}"])
    return result


def _cut(controller: Block, field: Field, value: ca.SX, values: Values) -> ca.SX:
    """An output as it is sent: inside its bounds, or the row of the table that stands for them.

    Args:
        controller: whose output it is.
        field: of the output.
        value: that the controller gives.
        values: its states, inputs and parameters, each name behind `c_`.
    """
    if row := controller.own_limit(field):
        limit = values[f"c_{row.name}"]
        return ca.fmin(ca.fmax(value, -limit), limit)
    # what is no number stays in front: fmin and fmax pass it on
    low = ca.fmax(value, ca.DM(field.lower)) if field.lower else value
    return ca.fmin(low, ca.DM(field.upper)) if field.upper else low


def held_outputs(controller: Block) -> list[Field]:
    """The states that keep the last good outputs."""
    return [
        Field(f"held_{f.name}", f.size, f.unit, f"last good {f.name}", tuple(inside(f).tolist()))
        for f in controller.outputs
    ]


def _inside(field: Field, value: ca.SX) -> list[ca.SX]:
    low = ca.vertsplit(value >= ca.DM(field.lower)) if field.lower else []
    high = ca.vertsplit(value <= ca.DM(field.upper)) if field.upper else []
    return [*low, *high]


def end_stop_torque(plant: Robot, q: ca.SX, qd: ca.SX) -> ca.SX:
    """Torque of the end stops on the axes [Nm]: one-sided springs with damping, `STOP_RAD` beyond
    what is believed; none where the torque limit of an axis is unknown.

    Args:
        plant: with the ranges of its axes.
        q: true angles [rad], shape (n,).
        qd: true speeds [rad/s], shape (n,).
    """
    known = np.isfinite(plant.tau_bound)
    stiffness = ca.DM(np.where(known, plant.tau_bound, 0.0) / STOP_DEPTH)
    margin = BEYOND + STOP_RAD
    above = ca.fmax(q - ca.DM(plant.q_max + margin), 0)
    below = ca.fmax(ca.DM(plant.q_min - margin) - q, 0)
    push = stiffness * (below - above - STOP_TIME * qd * ca.logic_or(above > 0, below > 0))
    # a stop pushes back, it never pulls
    return ca.if_else(above > 0, ca.fmin(push, 0), ca.fmax(push, 0)) * ca.logic_or(
        above > 0, below > 0
    )


def brake_friction(plant: Robot, closed: ca.SX) -> ca.SX:
    """What closed brakes add to the table (F_s, F_c, F_v, omega_st), column by column."""
    hold = ca.DM(np.fmin(plant.tau_bound, ANY_TORQUE))
    return ca.vertcat(hold, hold, ca.DM.zeros(2 * plant.n)) * closed
