"""What a controller was made from, and its arm, in words that travel with its C code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.block import Origin
from irb2400_ctrl.codegen.provenance import fingerprint
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.robot import Robot

ARM = """\
## Its arm

The elements of every vector of the arm are its joints from the base to the tool: {joints}.
Angles have the sense and the zero of the robot file. Torques act on the joints, behind the gears
(a motor's is less by its gear ratio), and drive them: what holds the arm against gravity is part of
`tau`.
{coupling}"""
COUPLING = """
Angles, speeds and torques are those of the *actuators*, which move more than a joint each. A URDF
as `irb2400 robot export` writes it, and what reads one (ROS, Gazebo), have the angles `theta`
between neighbouring links, counted from `q` = 0, and their torques `tau_theta`:

```text
{angles}
{torques}
```

All others are the same; speeds and accelerations go as the angles.
"""


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


def arm_notes(robot: Robot) -> str:
    """A section for the README of a package: which joint an element belongs to, and what of the
    joint it is."""
    joints = ", ".join(f"`{_plain(name)}`" for name in robot.joint_names)
    return ARM.format(joints=joints, coupling=_coupling(robot) if robot.coupled else "")


def _coupling(robot: Robot) -> str:
    back = np.asarray(np.linalg.inv(robot.A), dtype=np.float64)
    return COUPLING.format(
        angles="\n".join(_rows("q", back, "theta")),
        torques="\n".join(_rows("tau_theta", back.T, "tau")),
    )


def _rows(left: str, matrix: Array, right: str) -> list[str]:
    """`q[2] = theta[2] + theta[1]` for each row that is none of the unit matrix.

    Args:
        left: name of the vector that is made.
        matrix: that makes it, shape (n, n).
        right: name of the vector that it is made of.
    """
    unit = np.eye(len(matrix))
    return [
        f"{left}[{i}] = {_sum(row, i, right)}"
        for i, row in enumerate(matrix)
        if not np.array_equal(row, unit[i])
    ]


def _sum(row: Array, first: int, name: str) -> str:
    """`theta[2] + theta[1]`, `0.5*theta[1]`; the element of that number ahead.

    Args:
        row: factors.
        first: number of the element.
        name: of the vector.
    """
    order = sorted(np.flatnonzero(row), key=lambda j: (j != first, j))
    text = "".join(f" {'-' if row[j] < 0 else '+'} {_factor(row[j])}{name}[{j}]" for j in order)
    return text.removeprefix(" + ").lstrip()


def _factor(value: float) -> str:
    return "" if abs(value) == 1.0 else f"{abs(value):.9g}*"


def _plain(name: str) -> str:
    """A name that ends no code of Markdown."""
    return " ".join(name.replace("`", "'").split())
