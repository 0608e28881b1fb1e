"""What a controller was made from, and its arm, in words that travel with its C code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.block import Block, Origin
from irb2400_ctrl.codegen.provenance import fingerprint
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.robot import Robot

SAME_M = 0.02
"""between two axes of one arm, as two files have it [m]; a calibration moves them a millimetre"""
SAME_RAD = 0.1
"""the same for the angle between them [rad]"""
PARALLEL = 0.1
"""sine of the angle below which the next axis is as far as its frame is [-]"""
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


def axes_of(robot: Robot) -> tuple[tuple[float, float], ...]:
    """Distance [m] and angle [rad] from each axis to the next: of an arm, whatever it is called,
    whoever identified it, and wherever a file puts its frames."""
    found = []
    for link in robot.links[1:]:
        X = link.frame.matrix()
        sine = float(np.hypot(X[0, 2], X[1, 2]))
        # along the common normal z x z'; along the way between the frames of parallel axes
        across = abs(X[1, 3] * X[0, 2] - X[0, 3] * X[1, 2]) / sine if sine > PARALLEL else None
        distance = float(np.hypot(X[0, 3], X[1, 3])) if across is None else float(across)
        found.append((distance, float(np.arctan2(sine, X[2, 2]))))
    return tuple(found)


def other_arm(block: Block, robot: Robot) -> str:
    """What to say of a law that was made from an arm with other axes than this robot's; empty where
    they are alike, or nothing is known of its own."""
    here = axes_of(robot)
    # of another number of joints: nothing takes such a law for this one's
    if len(block.axes) != len(here):
        return ""
    for j, (own, found) in enumerate(zip(block.axes, here, strict=True), 1):
        if abs(own[0] - found[0]) > SAME_M or abs(own[1] - found[1]) > SAME_RAD:
            return (
                f"{block.name} was made from {dict(block.origin).get('robot', 'an arm')}, whose "
                f"axes {j} and {j + 1} are {_apart(*own)} apart; those of {robot.name}, which it "
                f"is to move, {_apart(*found)}: it is the law of another arm"
            )
    return ""


def _apart(distance: float, angle: float) -> str:
    return f"{1e3 * distance:.4g} mm and {np.degrees(angle):.3g} deg"


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
