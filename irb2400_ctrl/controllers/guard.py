"""What any torque controller needs around it on a machine: bumpless start, torque-rate limit, lost
samples."""

from __future__ import annotations

import casadi as ca
from numpy.typing import ArrayLike

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.parts import Values, assemble, gain
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot

FRESH = Field(
    "fresh", 1, "-", "1: measured anew, 0: the sample was lost", lower=(0.0,), upper=(1.0,)
)
BRAKE = Field("brake", 1, "-", "1: close the brakes", lower=(0.0,), upper=(1.0,))


def guarded(
    block: Block,
    robot: Robot,
    *,
    torque_rate: ArrayLike = 50_000.0,
    start_time: float = 0.05,
    most_lost: int = 20,
) -> Block:
    """The controller with guards; it keeps its inputs, outputs, states and parameters and gains a
    few.

    - **Bumpless start.** tau = hold + s (wanted - hold): the torque `hold` with which the brake was
      released (parameter `hold`, [Nm]) is blended over into the controller's within `start_time`.
    - **Torque rate.** The command moves by at most `torque_rate` per second.
    - **Lost samples.** Input `fresh` is 1 with a new measurement and 0 without. Without, the angle
      is carried on with the last speed, and the controller goes on. After `most_lost` in a row the
      output `brake` becomes 1 and stays 1: the torque holds its last value, within its limits,
      until the brake has closed.

    Args:
        block: a controller with inputs q, qd and output tau.
        torque_rate: [Nm/s], one or one per joint.
        start_time: [s].
        most_lost: samples that may be missing in a row.
    """
    _check(block, start_time, most_lost)
    T = block.sample_time
    share = 1.0 if start_time < T else T / start_time

    def law(v: Values) -> Values:
        seen = _carried_on(v, T)
        braked = ca.fmax(v["braked"], seen["lost"] > most_lost)
        inner = {**v, "q": seen["q"], "qd": seen["qd"]}
        taken = (*block.states, *block.inputs, *block.parameters)
        results = block.step.call([inner[f.name] for f in taken], True, False)
        after = dict(zip((f.name for f in block.states), results, strict=False))
        tau = _guarded_torque(v, results[-1], braked, T)
        return {
            **after,
            "tau": tau,
            "brake": braked,
            "tau_last": tau,
            "q_last": seen["q"],
            "qd_last": seen["qd"],
            "lost": seen["lost"],
            "braked": braked,
            "blend": ca.fmin(v["blend"] + share, 1.0),
        }

    return assemble(
        f"guarded_{block.name}",
        f"{block.doc}, with guards",
        T,
        law,
        states=(*block.states, *_states(robot.n)),
        inputs=(*block.inputs, FRESH),
        outputs=(*block.outputs, BRAKE),
        parameters=(*block.parameters, *_parameters(robot, torque_rate)),
    )


def _check(block: Block, start_time: float, most_lost: int) -> None:
    names = [f.name for f in block.inputs]
    if "q" not in names or "qd" not in names or [f.name for f in block.outputs] != ["tau"]:
        raise InputError(
            f"block {block.name!r} has inputs {names}; a guard expects q, qd and the single output "
            "tau"
        )
    if start_time < 0 or most_lost < 0:
        raise InputError(
            f"start_time {start_time} s, most_lost {most_lost}; expected values that are not "
            "negative"
        )


def _states(n: int) -> tuple[Field, ...]:
    return (
        Field("tau_last", n, "Nm", "last command"),
        Field("q_last", n, "rad", "last angle, measured or carried on"),
        Field("qd_last", n, "rad/s", "last measured speed"),
        Field("lost", 1, "-", "samples lost in a row"),
        Field("braked", 1, "-", "1 from the first time that too many were lost"),
        Field("blend", 1, "-", "share of the controller in the torque"),
    )


def _parameters(robot: Robot, torque_rate: ArrayLike) -> tuple[Field, ...]:
    return (
        Field("hold", robot.n, "Nm", "torque at which the brake is released"),
        gain(robot, "torque_rate", "Nm/s", "largest change of the command", torque_rate),
    )


def _carried_on(v: Values, T: float) -> Values:
    """The measurement, or the last one carried on with its speed; samples lost in a row."""
    fresh = v["fresh"] > 0.5
    return {
        "q": ca.if_else(fresh, v["q"], v["q_last"] + T * v["qd_last"]),
        "qd": ca.if_else(fresh, v["qd"], v["qd_last"]),
        "lost": ca.if_else(fresh, 0, v["lost"] + 1),
    }


def _guarded_torque(v: Values, own: ca.SX, braked: ca.SX, T: float) -> ca.SX:
    """The controller's own torque, blended in, limited in its rate, held once braked."""
    wanted = v["hold"] + v["blend"] * (own - v["hold"])
    # before the first step the brake holds the arm: the rate counts from there
    last = ca.if_else(v["blend"] > 0, v["tau_last"], v["hold"])
    step = T * v["torque_rate"]
    limited = last + ca.fmin(ca.fmax(wanted - last, -step), step)
    return ca.if_else(braked, last, limited)
