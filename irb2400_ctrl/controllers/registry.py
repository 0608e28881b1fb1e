"""Controllers by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers.adaptive import adaptive
from irb2400_ctrl.controllers.cascade import feedforward_pid, pid
from irb2400_ctrl.controllers.computed_torque import computed_torque
from irb2400_ctrl.controllers.computed_torque_integral import computed_torque_integral
from irb2400_ctrl.controllers.gravity_pd import gravity_pd
from irb2400_ctrl.controllers.origin import arm_notes, axes_of, origin_of
from irb2400_ctrl.controllers.parts import check_masses
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

CONTROLLERS: dict[str, Callable[..., Block]] = {
    "pid": pid,
    "gravity_pd": gravity_pd,
    "feedforward_pid": feedforward_pid,
    "computed_torque": computed_torque,
    "computed_torque_integral": computed_torque_integral,
    "adaptive": adaptive,
}


@typed
def controller(name: str, robot: Robot, sample_time: float = 0.001, **design: Any) -> Block:
    """The controller of that name for a robot, effects of the robot included.

    Args:
        robot: the arm it knows.
        name: one of `CONTROLLERS`.
        sample_time: [s].
        design: wishes of that controller (bandwidth, damping …), see its function; defaults
            otherwise.

    Raises:
        InputError: no such controller or wish; an arm without masses.
    """
    check_masses(robot)
    if name not in CONTROLLERS:
        raise InputError(f"no controller {name!r}; expected one of {', '.join(CONTROLLERS)}")
    known = _wishes(name)
    unknown = sorted(set(design) - set(known))
    if "tables" in unknown:
        have = ", ".join(other for other in CONTROLLERS if "tables" in _wishes(other))
        raise InputError(
            f"{name} has no tables: parameters for payload, friction and effects (--tables); "
            f"expected one of {have}, or no tables"
        )
    if unknown:
        raise InputError(
            f"{name} has no design parameter {', '.join(unknown)}; expected some of "
            f"{', '.join(known)}"
        )
    block = CONTROLLERS[name](robot, sample_time, **design)
    origin = origin_of(robot, name, design)
    return replace(block, origin=origin, notes=arm_notes(robot), axes=axes_of(robot))


def _wishes(name: str) -> list[str]:
    """Design parameters of a controller."""
    parameters = inspect.signature(CONTROLLERS[name]).parameters
    return [key for key in parameters if key not in {"robot", "sample_time"}]
