"""Names of links and joints in an exported file."""

from __future__ import annotations

import re

from irb2400_ctrl.robot.description import Robot


def exported_name(text: str) -> str:
    """A name of letters, digits and underscores."""
    return re.sub(r"\W+", "_", text).strip("_")


def exported_joints(robot: Robot) -> list[str]:
    """The joints' own names, as logs and other programs know them; numbers where two would be
    called the same."""
    names = [exported_name(name) for name in robot.joint_names]
    if len(set(names)) < robot.n or not all(names):
        return [f"joint_{i + 1}" for i in range(robot.n)]
    return names
