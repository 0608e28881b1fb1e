"""Whether what a caller gives as a robot is one."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.description import Robot


def check_robot(name: str, robot: object) -> None:
    """Refuse what is no robot, such as the path of its file.

    Raises:
        InputError: not a `Robot`.
    """
    if not isinstance(robot, Robot):
        raise InputError(
            f"{name}: found a {type(robot).__name__}; expected a Robot, such as "
            '`load_robot("irb2400")`, which takes the path of a robot file, too'
        )
