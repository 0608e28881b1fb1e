"""One step of the guard at a time, from rest at the reference."""

from __future__ import annotations

from functools import cache

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller, guarded

ROBOT = irb.load_robot("irb2400")
MODEL = irb.Model(ROBOT)
T = 0.001
Q = np.array([0.1, 0.2, -0.1, 0.3, 0.8, -0.2])
ZERO = np.zeros(6)


@cache
def block(consistency: bool = False, start_time: float = 0.0, most_lost: int = 20) -> Block:
    return guarded(
        controller("gravity_pd", ROBOT),
        ROBOT,
        start_time=start_time,
        most_lost=most_lost,
        consistency=consistency,
    )


def leading(axis: int, degrees: float) -> float:
    """What the brake says of computed torque, which feeds forward, that far from its reference."""
    block_of = guarded(controller("computed_torque", ROBOT), ROBOT, consistency=False)
    away = Q + np.radians(degrees) * np.eye(6)[axis]
    return float(step(block_of, q=away, q_last=away)["brake"][0])


def defaults(of: Block) -> dict[str, object]:
    return {field.name: field.default or 0.0 for field in of.parameters}


def step(of: Block, **given: object) -> dict[str, np.ndarray]:
    """One step from rest at the reference, with what is given instead."""
    usual: dict[str, object] = {
        "q": Q, "qd": ZERO, "q_ref": Q, "qd_ref": ZERO, "qdd_ref": ZERO, "fresh": 1.0, "lost": 0.0,
        "braked": 0.0, "blend": 1.0, "bump": ZERO, "q_last": Q, "qd_last": ZERO,
        "tau_last": MODEL.gravity(Q), "running": 1.0, "explained": ZERO, "explained_slow": ZERO,
        "load_speed": 0.0, "load_speed_slow": 0.0, "doubt": 0.0, "doubt_slow": 0.0,
        **defaults(of),
    }  # fmt: skip
    # a torque that has acted for long
    usual["tau_seen"] = given.get("tau_last", usual["tau_last"])
    values = usual | given
    fields = (*of.states, *of.inputs, *of.parameters)
    found = of.step(*(np.broadcast_to(values[f.name], f.size) for f in fields))
    names = (*(f"{f.name}" for f in of.states), *("tau", "brake"))
    told = dict(zip(names, (np.asarray(v).ravel() for v in found), strict=True))
    return told | {"tau": np.asarray(found[-2]).ravel(), "brake": np.asarray(found[-1]).ravel()}
