"""What is asked of margins and guards in another unit, or for another arm, is said."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.design import over_poses, place_poles
from irb2400_ctrl.errors import InputError

ROBOT = irb.load_robot("irb2400")
LAW = controller("gravity_pd", ROBOT)


@pytest.mark.parametrize(
    ("poses", "said"),
    [
        # the margins were those of another pose
        ([[0, 0, 20, 0, 40, 0]], "axis 5 at 40 rad; expected -2.094 to 2.094 rad"),
        (np.zeros((0, 6)), "poses: found none"),
        ("home", "poses: found 'home', expected an array of numbers"),
    ],
)
def test_poses_of_margins(poses: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        over_poses(ROBOT, LAW, poses)  # type: ignore[arg-type]


def test_a_pose_next_to_the_joint_box_is_taken() -> None:
    assert over_poses(ROBOT, LAW, [ROBOT.q_max + 0.04]).stable


@pytest.mark.parametrize(
    "ask",
    [
        lambda: guarded(LAW, irb.load_robot("ur10e")),
        lambda: place_poles("60"),  # type: ignore[arg-type]
    ],
)
def test_another_arm_and_text(ask: Callable[[], object]) -> None:
    with pytest.raises(InputError, match=r"made for ABB IRB 2400, to be guarded on|found '60'"):
        ask()
