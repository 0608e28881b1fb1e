"""Controller, instruments and plant in one discrete-time block: what `simulate` runs in generated
C."""

from __future__ import annotations

import math
from collections.abc import Mapping

import casadi as ca

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.instruments import Actuators, Sensors
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
    n = plant.n
    period = controller.sample_time
    arm = plant_block(plant, period, substeps=substeps, wrench=wrench)
    states = [
        *prefixed("p_", arm.states),
        *prefixed("c_", controller.states),
        Field("q_before", n, "rad", "angles measured one sample before"),
        Field("qd_filter", n, "rad/s", "filtered speeds"),
        Field("tau_before", n, "Nm", "command of the sample before"),
        Field("tau_lag", n, "Nm", "torque behind the lag"),
    ]
    known = {"q", "qd", "fresh", *REFERENCE}
    if not {f.name for f in controller.inputs} <= known or "tau" not in {
        f.name for f in controller.outputs
    }:
        raise InputError(
            f"controller {controller.name!r} has inputs {[f.name for f in controller.inputs]}; "
            "expected some of q, qd, q_ref, qd_ref, qdd_ref, fresh, and an output tau"
        )
    inputs = [Field(name, n, unit, "reference") for name, unit in REFERENCE.items()]
    if wrench:
        inputs.append(
            Field("wrench", 6, "N, Nm", "force and moment on the tool at the TCP, base frame")
        )
    if any(f.name == "fresh" for f in controller.inputs):
        inputs.append(
            Field("fresh", 1, "-", "0 where the sample was lost on its way to the controller")
        )
    if sensors.encoder_noise_rad > 0:
        inputs.append(Field("encoder_noise", n, "rad", "added to the angles before quantisation"))
    extra = [f for f in controller.outputs if f.name != "tau"]
    outputs = [
        Field("q", n, "rad", "true angles"),
        Field("qd", n, "rad/s", "true speeds"),
        Field("q_seen", n, "rad", "measured angles"),
        Field("qd_seen", n, "rad/s", "measured speeds"),
        Field("tau", n, "Nm", "torque that acts on the arm"),
        Field("command", n, "Nm", "torque command"),
        Field("dry", n, "Nm", "dry friction, mean of the step before"),
        Field("q_link", n, "rad", "true angles on the side of the links"),
        *prefixed("c_", extra),
    ]
    parameters = [
        *prefixed("p_", arm.parameters),
        *prefixed("c_", controller.parameters),
        Field("encoder_zero", n, "rad", "true minus reported angle", tuple(encoder_zero(plant))),
    ]
    v = {f.name: ca.SX.sym(f.name, f.size) for f in (*states, *inputs, *parameters)}

    q = v["p_q"]
    qd = v["p_qd"]
    shown = q - v["encoder_zero"] + v.get("encoder_noise", ca.SX.zeros(n))
    q_seen = quantised(shown, sensors.encoder_step_rad)
    if sensors.speed_filter_Hz > 0:
        share = 1 - math.exp(-2 * math.pi * sensors.speed_filter_Hz * period)
        qd_seen = v["qd_filter"] + share * ((q_seen - v["q_before"]) / period - v["qd_filter"])
    else:
        qd_seen = qd
    measured = {**v, **{f"c_{k}": x for k, x in (("q", q_seen), ("qd", qd_seen))}}
    control = run(controller, "c_", {**measured, **{f"c_{f.name}": v[f.name] for f in inputs}})
    command = control["tau"]
    wanted = v["tau_before"] if actuators.delay_samples else command
    if actuators.saturate:
        limit = ca.DM(plant.tau_bound)
        wanted = ca.fmin(ca.fmax(wanted, -limit), limit)
    lag = 0.0 if actuators.lag_s == 0 else math.exp(-period / actuators.lag_s)
    # the torque behind a first-order lag, its mean over the period
    behind = wanted + lag * (v["tau_lag"] - wanted)
    tau = (
        wanted
        if lag == 0
        else wanted + (v["tau_lag"] - wanted) * (1 - lag) * actuators.lag_s / period
    )
    moved = run(arm, "p_", {**v, "p_tau": tau, **({"p_wrench": v["wrench"]} if wrench else {})})
    after = {
        **{f"p_{f.name}": moved[f"{f.name}_next"] for f in arm.states},
        **{f"c_{f.name}": control[f"{f.name}_next"] for f in controller.states},
        "q_before": q_seen,
        "qd_filter": qd_seen,
        "tau_before": command,
        "tau_lag": behind,
    }
    given: Values = {
        "q": q,
        "qd": qd,
        "q_seen": q_seen,
        "qd_seen": qd_seen,
        "tau": tau,
        "command": command,
        "dry": v["p_dry"],
        "q_link": link_angles(plant, q, v.get("p_link", ca.SX(0, 1))),
        **{f"c_{f.name}": control[f.name] for f in extra},
    }
    results = [
        ca.densify(x) for x in (*(after[f.name] for f in states), *(given[f.name] for f in outputs))
    ]
    names_out = [*(f"{f.name}_next" for f in states), *(f"{f.name}_now" for f in outputs)]
    step = ca.Function(f"{controller.name}_loop", list(v.values()), results, list(v), names_out)
    return Block(
        step.name(),
        f"{controller.name} on {plant.name}",
        period,
        tuple(states),
        tuple(inputs),
        tuple(outputs),
        tuple(parameters),
        step,
    )


def quantised(angle: ca.SX, step: float) -> ca.SX:
    """The angle as an encoder of that resolution gives it."""
    return angle if step == 0 else step * ca.floor(angle / step + 0.5)


def encoder_zero(robot: Robot) -> list[float]:
    """True minus reported angle of each joint [rad], from the effects of the measuring chain."""
    zero = [0.0] * robot.n
    for effect in robot.effects:
        if effect.kind == "encoder_zero":
            zero[effect.index] += effect.coefficients()[0]
    return zero


def prefixed(prefix: str, fields: tuple[Field, ...] | list[Field]) -> list[Field]:
    """The fields under other names."""
    return [Field(prefix + f.name, f.size, f.unit, f.doc, f.default) for f in fields]


def run(block: Block, prefix: str, values: Mapping[str, ca.SX]) -> Values:
    """One step of a block on expressions: next states under `<name>_next`, outputs under their
    names."""
    taken = (*block.states, *block.inputs, *block.parameters)
    results = block.step.call([values[prefix + f.name] for f in taken], True, False)
    n = len(block.states)
    after = {f"{f.name}_next": x for f, x in zip(block.states, results[:n], strict=True)}
    return {**after, **{f.name: x for f, x in zip(block.outputs, results[n:], strict=True)}}
