"""Pieces that the controllers share: their inputs and outputs, saturation, anti-windup, the
assembly into a `Block`."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.codegen.block import Quantities
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import joined

BEYOND = 0.05
"""how far beyond the joint box an angle is still believed [rad]: an arm at its limit overshoots a
little"""
FASTEST = 2.0
"""largest speed that is believed, as a multiple of the robot's limit: a filtered difference of
angles overshoots; ten times the limit is a wrong unit or a broken encoder"""
UNKNOWN_SPEED = 10.0
"""[rad/s] in place of a speed limit that the robot file does not state"""
UNBOUNDED = 1e6
"""[Nm] in place of a torque limit that it does not state"""

ROUNDING = 1e-12
"""of the largest inertia: less is none"""
LONGEST = 1.0
"""longest sample time [s]: more is a rate, or milliseconds"""
STRETCH = 2**22
"""samples that a clock counts before it adds them to its seconds"""

PORT_UNITS = {
    "q": "rad",
    "qd": "rad/s",
    "q_ref": "rad",
    "qd_ref": "rad/s",
    "qdd_ref": "rad/s2",
    "tau": "Nm",
}
"""in which a controller is served, and gives its torque"""

Values = dict[str, ca.SX]
Law = Callable[[Values], Values]


@dataclass(frozen=True)
class Clock:
    """The time since the start, for effects that change with it.

    In single precision a sum of sample times runs at a wrong rate and stands still in the end (at
    10 kHz after 34 minutes); samples are counted exactly.

    Args:
        sample_time: [s].
        name: of its states.
    """

    sample_time: float
    name: str = "clock"

    @property
    def states(self) -> tuple[Field, Field]:
        """Seconds and samples."""
        doc = f"time since the start, in stretches of {STRETCH} samples"
        return (
            Field(self.name, 1, "s", doc),
            Field(f"{self.name}_samples", 1, "-", "samples since the last full stretch"),
        )

    def time(self, values: Mapping[str, ca.SX]) -> ca.SX:
        """Time since the start [s]."""
        samples = values[f"{self.name}_samples"]
        return ca.SX(values[self.name] + self.sample_time * samples)

    def later(self, values: Mapping[str, ca.SX]) -> Values:
        """Its states one sample later."""
        seconds = values[self.name]
        samples = values[f"{self.name}_samples"] + 1
        full = samples >= STRETCH
        return {
            self.name: ca.if_else(full, seconds + STRETCH * self.sample_time, seconds),
            f"{self.name}_samples": ca.if_else(full, 0, samples),
        }


def check_masses(robot: Robot) -> None:
    """Gains and torques of a controller follow from the arm's masses.

    Raises:
        InputError: no link has one, or none that a joint turns.
    """
    if robot.weightless:
        raise InputError(
            f"{robot.name}: found no link with a mass, expected those of the arm: the torques of a "
            "controller mean nothing without; state [[links]] body, or identify them"
        )
    own = np.diagonal(Model(robot).mass_matrix((robot.q_min + robot.q_max) / 2))
    least = ROUNDING * own.max()
    idle = [joint.name for joint, M in zip(robot.joints, own, strict=True) if least >= M]
    if idle:
        raise InputError(
            f"{robot.name}: found no mass that {joined(idle)} turns, expected some at every joint: "
            "no torque has a meaning there; state the body of its link, a tool, or rotor_inertia"
        )


def signals_in(robot: Robot) -> tuple[Field, ...]:
    """Inputs of every controller: measured angle and speed, and the reference motion."""
    n = robot.n
    low = tuple((robot.q_min - BEYOND).tolist())
    high = tuple((robot.q_max + BEYOND).tolist())
    fast = tuple((FASTEST * fastest(robot)).tolist()) if np.isfinite(robot.qd_bound).any() else ()
    slow = tuple(-v for v in fast)
    return (
        Field("q", n, "rad", "measured actuator angles", lower=low, upper=high),
        Field("qd", n, "rad/s", "measured actuator speeds", lower=slow, upper=fast),
        Field("q_ref", n, "rad", "reference angles", lower=low, upper=high),
        Field("qd_ref", n, "rad/s", "reference speeds"),
        Field("qdd_ref", n, "rad/s2", "reference accelerations"),
    )


def torque_out(robot: Robot) -> tuple[Field, ...]:
    """Output of every controller: the torque command, already inside the limits; without bounds
    where the robot states none of them."""
    known = np.isfinite(robot.tau_bound)
    if not known.any():
        return (Field("tau", robot.n, "Nm", "torque command; no limit is known"),)
    doc = "torque command" if known.all() else f"torque command; {UNBOUNDED:g}: limit not known"
    high = strongest(robot)
    return (Field("tau", robot.n, "Nm", doc, lower=tuple(-high), upper=tuple(high)),)


def strongest(robot: Robot) -> Array:
    """Torque limits, `UNBOUNDED` where one is not stated [Nm], shape (n,)."""
    return np.where(np.isfinite(robot.tau_bound), robot.tau_bound, UNBOUNDED)


def fastest(robot: Robot) -> Array:
    """Speed limits, `UNKNOWN_SPEED` where one is not stated [rad/s], shape (n,)."""
    return np.where(np.isfinite(robot.qd_bound), robot.qd_bound, UNKNOWN_SPEED)


def errors(robot: Robot) -> tuple[Field, Field]:
    """Steps that a law calls `error` and `speed_error`."""
    return (
        Field("error", robot.n, "rad", "angle error, q_ref - q"),
        Field("speed_error", robot.n, "rad/s", "speed error, qd_ref - qd"),
    )


def gain(robot: Robot, name: str, unit: str, doc: str, value: ArrayLike) -> Field:
    """A parameter per joint; one number stands for all joints.

    Args:
        robot: whose joints it is of.
        name: of the parameter.
        unit: of the value, for the header of the C code.
        doc: what it is.
        value: one number or shape (n,), in that unit.

    Raises:
        InputError: neither one number nor one per joint, or a negative one.
    """
    array = numbers(name, value)
    if array.shape not in {(), (robot.n,)} or not np.isfinite(array).all() or (array < 0).any():
        raise InputError(
            f"{name} is {array.tolist()}; expected one number [{unit}] >= 0, or {robot.n} of them, "
            "one per joint"
        )
    default = tuple(np.broadcast_to(array, robot.n).tolist())
    return Field(name, robot.n, unit, doc, default, lower=(0.0,) * robot.n)


def saturate(v: Values, tau: ca.SX) -> ca.SX:
    """tau [Nm], shape (n,), cut at the torque limits of the parameter table; as it is where that
    has none."""
    if "tau_limit" not in v:
        return tau
    return ca.SX(ca.fmin(ca.fmax(tau, -v["tau_limit"]), v["tau_limit"]))


def back_calculated(
    integral: ca.SX, rate: ca.SX, excess: ca.SX, tracking: ca.SX, step: float
) -> ca.SX:
    """Next value of an integral torque with anti-windup (back-calculation).

    dI/dt = rate + excess / T_t, where excess = saturated minus wanted torque: while the command is
    cut, the integral moves, with time constant T_t = `tracking` [s], to where the command just
    reaches the limit.

    Args:
        integral: I, present value [Nm], shape (n,).
        rate: what the error adds to it [Nm/s], shape (n,).
        excess: saturated minus wanted torque [Nm], shape (n,).
        step: sample time [s].
    """
    share = ca.fmin(step / tracking, 1.0)
    return integral + step * rate + share * excess


def resting(qd_ref: ca.SX, error: ca.SX, deadband: ca.SX) -> ca.SX:
    """1 for each joint whose reference rests and whose angle error is inside the deadband, else
    0.

    Args:
        qd_ref: speeds of the reference [rad/s], shape (n,).
        error: of the angles [rad], shape (n,).
        deadband: [rad], shape (n,).
    """
    return ca.logic_and(ca.fabs(qd_ref) < 1e-6, ca.fabs(error) < deadband)


def assemble(
    name: str,
    doc: str,
    sample_time: float,
    law: Law,
    *,
    states: Sequence[Field],
    inputs: Sequence[Field],
    outputs: Sequence[Field],
    parameters: Sequence[Field],
    told: Sequence[Field] = (),
) -> Block:
    """The block whose step is `law`: values of states, inputs and parameters by name -> next states
    and outputs.

    What else of `told` the law gives by name, generated code names its locals after. The limit of
    an output that is cut at a magnitude is a parameter of the block.

    Args:
        name: of the block.
        doc: what it does, in a sentence.
        sample_time: [s].
        law: the step.
        states: kept from step to step.
        inputs: of every step.
        outputs: of every step.
        parameters: that may change while it runs.
    """
    if not 0 < sample_time <= LONGEST:
        raise InputError(
            f"sample time is {sample_time} s; expected a positive number of seconds, at most "
            f"{LONGEST:g}, for example 0.001"
        )
    stated = {field.name for field in parameters}
    limits = (field.magnitude for field in outputs)
    parameters = (*parameters, *(row for row in limits if row and row.name not in stated))
    taken = (*states, *inputs, *parameters)
    symbols = {field.name: ca.SX.sym(field.name, field.size) for field in taken}
    results = law(dict(symbols))
    given = [ca.densify(results[field.name]) for field in (*states, *outputs)]
    names_out = [*(f"{field.name}_next" for field in states), *(field.name for field in outputs)]
    names_in = [field.name for field in taken]
    # an output may bear the name of an input (a filtered q); CasADi wants them apart
    names_out = [f"{n}_out" if n in names_in else n for n in names_out]
    step = ca.Function(name, list(symbols.values()), given, names_in, names_out)
    steps = [ca.densify(results[field.name]) for field in told]
    quantities = Quantities(tuple(told), ca.Function("quantities", list(symbols.values()), steps))
    return Block(
        name,
        doc,
        sample_time,
        tuple(states),
        tuple(inputs),
        tuple(outputs),
        parameters,
        step,
        quantities=quantities,
    )


def with_gains(block: Block, **gains: ArrayLike) -> Block:
    """The block with other defaults for some of its parameters.

    Raises:
        InputError: no such parameter, or neither one number nor one per element.
    """
    known = {f.name: f for f in block.parameters}
    for name, value in gains.items():
        if name not in known:
            raise InputError(
                f"{block.name} has no parameter {name!r}; expected some of {', '.join(known)}"
            )
        array = np.asarray(value, dtype=float)
        if array.shape not in {(), (known[name].size,)} or not np.isfinite(array).all():
            raise InputError(
                f"{block.name}: {name} is {array.tolist()}; expected 1 or {known[name].size} "
                "finite numbers"
            )
        default = tuple(np.broadcast_to(array, known[name].size).tolist())
        known[name] = replace(known[name], default=default)
    return replace(block, parameters=tuple(known.values()))


def check_port_unit(controller: str, field: Field) -> None:
    """Refuse a port of a controller in another unit than it is served in: nothing converts it.

    Args:
        controller: its name.
        field: one of its inputs, or its torque.
    """
    # rad/s**2, rad/s^2 and rad/s2 are one, and so are N m, N*m and Nm
    found = re.sub(r"[\s*^·.]", "", field.unit.replace("²", "2"))
    expected = PORT_UNITS.get(field.name, found)
    if found not in ("", "-", expected):
        raise InputError(
            f"controller {controller!r}: {field.name} is in {field.unit}; expected {expected}: "
            "ports are served in SI units; convert inside the step"
        )
