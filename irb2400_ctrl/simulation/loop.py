"""Controller, instruments and plant in one discrete-time block: what `simulate` runs in generated
C."""

from __future__ import annotations

import math
from collections.abc import Mapping

import casadi as ca

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.parts import check_port_unit
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.instruments import Actuators, Sensors
from irb2400_ctrl.simulation.machine_limits import (
    BRAKE_CLOCK,
    BRAKE_TIME,
    as_packaged,
    brake_friction,
    end_stop_torque,
    has_brake,
    held_outputs,
)
from irb2400_ctrl.simulation.plant import link_angles, plant_block

Values = dict[str, ca.SX]
REFERENCE = {"q_ref": "rad", "qd_ref": "rad/s", "qdd_ref": "rad/s2"}


def closed_loop(
    controller: Block,
    plant: Robot,
    *,
    sensors: Sensors,
    actuators: Actuators,
    substeps: int,
    wrench: bool = False,
) -> Block:
    """One control period of the whole loop as a block.

    Inputs: `q_ref`, `qd_ref`, `qdd_ref`, with `wrench` also `wrench`, `fresh` if the controller has
    it, `encoder_noise` if the sensors have it. Outputs, all at the sample: true `q` and `qd`,
    measured `q_seen` and `qd_seen`, `tau` as it acts during the period, `command`, `dry` friction
    of the step before, `q_link` (differs from `q` where a joint is elastic).
    States and parameters of the controller bear the prefix `c_`, those of the plant `p_`.
    """
    _check_ports(controller, plant.n)
    period = controller.sample_time
    arm = plant_block(plant, period, substeps=substeps, wrench=wrench)
    states = _states(arm, controller)
    inputs = _inputs(plant.n, controller, sensors, wrench)
    outputs = _outputs(plant.n, controller)
    parameters = _parameters(plant, arm, controller)
    v = {f.name: ca.SX.sym(f.name, f.size) for f in (*states, *inputs, *parameters)}

    q_seen, qd_seen = _measured(v, sensors, period)
    heard = {f"c_{f.name}": v[f.name] for f in inputs}
    control = as_packaged(controller, {**v, "c_q": q_seen, "c_qd": qd_seen, **heard}, run)
    drive, behind_lag = _acting(v, control["tau"], plant, actuators, period)
    stop = end_stop_torque(plant, v["p_q"], v["p_qd"])
    tau, friction, braking = _braked(v, control, plant, drive, period)
    moved = run(arm, "p_", {**v, **_wrench(v), **friction, "p_tau": tau + stop})

    after = {
        **{f"p_{f.name}": moved[f"{f.name}_next"] for f in arm.states},
        **{f"c_{f.name}": control[f"{f.name}_next"] for f in controller.states},
        **{f"held_{f.name}": control[f.name] for f in controller.outputs},
        **braking,
        "q_before": q_seen,
        "qd_filter": qd_seen,
        "tau_before": control["tau"],
        "tau_lag": behind_lag,
    }
    shown: Values = {
        "q_seen": q_seen,
        "qd_seen": qd_seen,
        "tau": tau,
        "command": control["tau"],
        "fault": control["fault"],
        "end_stop": stop,
        **_true(v, plant),
        **{f"c_{f.name}": control[f.name] for f in _extra(controller)},
    }
    names_out = [*(f"{f.name}_next" for f in states), *(f"{f.name}_now" for f in outputs)]
    results = (*(after[f.name] for f in states), *(shown[f.name] for f in outputs))
    dense = [ca.densify(x) for x in results]
    step = ca.Function(f"{controller.name}_loop", list(v.values()), dense, list(v), names_out)
    ports = (tuple(states), tuple(inputs), tuple(outputs), tuple(parameters))
    return Block(step.name(), f"{controller.name} on {plant.name}", period, *ports, step)


def _wrench(v: Values) -> Values:
    return {"p_wrench": v["wrench"]} if "wrench" in v else {}


def _braked(
    v: Values, control: Values, plant: Robot, drive: ca.SX, period: float
) -> tuple[ca.SX, Values, Values]:
    """Torque of the drives, friction of the plant with its brakes, next value of the brakes'
    clock."""
    if "brake" not in control:
        return drive, {}, {}
    closed = v["brake_time"] >= BRAKE_TIME - 0.5 * period
    friction = v["p_friction"] + brake_friction(plant, closed)
    clock = ca.if_else(control["brake"] > 0, v["brake_time"] + period, 0)
    # the drive is switched off once the brake holds
    return drive * ca.logic_not(closed), {"p_friction": friction}, {"brake_time": clock}


def _check_ports(controller: Block, n: int) -> None:
    """InputError where the loop has nothing to give to an input, the controller no torque, or one
    of them is of another arm."""
    inputs = [f.name for f in controller.inputs]
    known = {"q", "qd", "fresh", *REFERENCE}
    if not set(inputs) <= known or "tau" not in {f.name for f in controller.outputs}:
        raise InputError(
            f"controller {controller.name!r} has inputs {inputs}; "
            "expected some of q, qd, q_ref, qd_ref, qdd_ref, fresh, and an output tau"
        )
    torque = [f for f in controller.outputs if f.name == "tau"]
    for field in (*controller.inputs, *torque):
        size = 1 if field.name == "fresh" else n
        if field.size != size:
            raise InputError(
                f"controller {controller.name!r}: {field.name} has {field.size} elements; expected "
                f"{size}: the arm has {n} joints"
            )
        check_port_unit(controller.name, field)


def _extra(controller: Block) -> list[Field]:
    """What the controller says beside its torque."""
    return [f for f in controller.outputs if f.name != "tau"]


def _states(arm: Block, controller: Block) -> list[Field]:
    n = arm.inputs[0].size
    return [
        *prefixed("p_", arm.states),
        *prefixed("c_", controller.states),
        *held_outputs(controller),
        *([BRAKE_CLOCK] if has_brake(controller) else []),
        Field("q_before", n, "rad", "angles measured one sample before"),
        Field("qd_filter", n, "rad/s", "filtered speeds"),
        Field("tau_before", n, "Nm", "command of the sample before"),
        Field("tau_lag", n, "Nm", "torque behind the lag"),
    ]


def _inputs(n: int, controller: Block, sensors: Sensors, wrench: bool) -> list[Field]:
    inputs = [Field(name, n, unit, "reference") for name, unit in REFERENCE.items()]
    if wrench:
        doc = "force and moment on the tool at the TCP, base frame"
        inputs.append(Field("wrench", 6, "N, Nm", doc))
    if any(f.name == "fresh" for f in controller.inputs):
        doc = "0 where the sample was lost on its way to the controller"
        inputs.append(Field("fresh", 1, "-", doc))
    if sensors.encoder_noise_rad > 0:
        inputs.append(Field("encoder_noise", n, "rad", "added to the angles before quantisation"))
    return inputs


def _outputs(n: int, controller: Block) -> list[Field]:
    return [
        Field("q", n, "rad", "true angles"),
        Field("qd", n, "rad/s", "true speeds"),
        Field("q_seen", n, "rad", "measured angles"),
        Field("qd_seen", n, "rad/s", "measured speeds"),
        Field("tau", n, "Nm", "torque that acts on the arm"),
        Field("command", n, "Nm", "torque command"),
        Field("fault", 1, "-", "1 where the package refuses an input"),
        Field("end_stop", n, "Nm", "torque of the end stops"),
        Field("dry", n, "Nm", "dry friction, mean of the step before"),
        Field("q_link", n, "rad", "true angles on the side of the links"),
        *prefixed("c_", _extra(controller)),
    ]


def _parameters(plant: Robot, arm: Block, controller: Block) -> list[Field]:
    zero = tuple(encoder_zero(plant))
    return [
        *prefixed("p_", arm.parameters),
        *prefixed("c_", controller.parameters),
        Field("encoder_zero", plant.n, "rad", "true minus reported angle", zero),
    ]


def _true(v: Values, plant: Robot) -> Values:
    """Motion and friction of the arm at the sample."""
    return {
        "q": v["p_q"],
        "qd": v["p_qd"],
        "dry": v["p_dry"],
        "q_link": link_angles(plant, v["p_q"], v.get("p_link", ca.SX(0, 1))),
    }


def _measured(v: Values, sensors: Sensors, period: float) -> tuple[ca.SX, ca.SX]:
    """Angles and speeds as the controller gets them: quantised; differenced and filtered."""
    q = v["p_q"]
    reported = q - v["encoder_zero"] + v.get("encoder_noise", ca.SX.zeros(q.numel()))
    q_seen = quantised(reported, sensors.encoder_step_rad)
    if sensors.speed_filter_Hz <= 0:
        return q_seen, v["p_qd"]
    share = 1 - math.exp(-2 * math.pi * sensors.speed_filter_Hz * period)
    difference = (q_seen - v["q_before"]) / period
    return q_seen, v["qd_filter"] + share * (difference - v["qd_filter"])


def _acting(
    v: Values, command: ca.SX, plant: Robot, actuators: Actuators, period: float
) -> tuple[ca.SX, ca.SX]:
    """Mean torque of the drives over the period, and the torque behind their lag at its end."""
    wanted = v["tau_before"] if actuators.delay_samples else command
    if actuators.saturate:
        limit = ca.DM(plant.tau_bound)
        wanted = ca.fmin(ca.fmax(wanted, -limit), limit)
    if actuators.lag_s == 0:
        return wanted, wanted
    lag = math.exp(-period / actuators.lag_s)
    missing = v["tau_lag"] - wanted
    mean = wanted + missing * (1 - lag) * actuators.lag_s / period
    return mean, wanted + lag * missing


def quantised(angle: ca.SX, step: float) -> ca.SX:
    """The angle as an encoder of that resolution gives it."""
    return angle if step == 0 else step * ca.floor(angle / step + 0.5)


def encoder_zero(robot: Robot) -> list[float]:
    """True minus reported angle of each joint [rad], from the effects of the measuring chain."""
    zero = [0.0] * robot.n
    for effect in robot.effects:
        offset, _ = effect.angle_error
        if offset:
            zero[effect.index] += offset
    return zero


def prefixed(prefix: str, fields: tuple[Field, ...] | list[Field]) -> list[Field]:
    """The fields under other names."""
    return [Field(prefix + f.name, f.size, f.unit, f.doc, f.default) for f in fields]


def run(block: Block, prefix: str, values: Mapping[str, ca.SX]) -> Values:
    """One step of a block on expressions: next states under `<name>_next`, outputs under their
    names.

    Args:
        block: whose step it is.
        prefix: of its names among the values.
        values: states, inputs and parameters by name.
    """
    taken = (*block.states, *block.inputs, *block.parameters)
    results = block.step.call([values[prefix + f.name] for f in taken], True, False)
    n = len(block.states)
    after = {f"{f.name}_next": x for f, x in zip(block.states, results[:n], strict=True)}
    return {**after, **{f.name: x for f, x in zip(block.outputs, results[n:], strict=True)}}
