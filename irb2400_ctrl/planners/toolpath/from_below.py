"""Whether a program works from below, which is most often an axis stated the other way round."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.robot import Robot

STEEP = 0.5
"""all tool axes point down by more than 30 deg below level [-]"""


def from_below(robot: Robot, program: CamProgram, frame: Array | None) -> str | None:
    """What to ask where the spindle is below its tip all along; None where it is not.

    Args:
        robot: whose gravity says what is below.
        program: its points in the frame of the CAM file.
        frame: X_BW that they are planned in, shape (4, 4) [m]; None where they are stated in the
            robot base.
    """
    if not program.operations:
        return None
    axes = np.concatenate(
        [operation.path.tool_axis(robot.spindle_axis) for operation in program.operations]
    )
    up = robot.upright[2] if frame is None else robot.upright[2] @ frame[:3, :3]
    if (axes @ up).max() > -STEEP:
        return None
    return (
        "the spindle is below the tip all along: i,j,k point from the tip towards the spindle; "
        "state them the other way round, or turn --work-frame, unless the arm works from below"
    )
