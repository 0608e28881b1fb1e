"""What a controller was made from, in words that travel with its C code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.codegen.block import Origin
from irb2400_ctrl.codegen.provenance import fingerprint
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.robot import Robot


def origin_of(robot: Robot, controller: str, design: Mapping[str, Any]) -> Origin:
    """Controller, robot, tool, payload, effects, and the hash of the robot's description."""
    loads = [e for e in robot.effects if isinstance(e, Payload)]
    others = [e for e in robot.effects if not isinstance(e, Payload)]
    wishes = [f"{name} {np.asarray(value).tolist()}" for name, value in sorted(design.items())]
    tool = robot.tool
    return (
        ("controller", controller),
        ("design", ", ".join(wishes) or "default"),
        ("robot", robot.name),
        ("tool", "none" if tool is None else f"{tool.name} {tool.body.mass_kg:g} kg"),
        ("payload", ", ".join(f"{e.mass_kg:g} kg" for e in loads) or "none"),
        ("effects", ", ".join(_named(e.kind, e.joint) for e in others) or "none"),
        ("robot sha256", fingerprint(robot.model_dump_json())),
    )


def _named(kind: str, joint: int | None) -> str:
    return kind if joint is None else f"{kind} of joint {joint}"
