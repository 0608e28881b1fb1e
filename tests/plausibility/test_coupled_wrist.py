"""Gears of a wrist that the robot file does not have are no channel that is misread, nor another
arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.plausibility.log_check import LogCheck

SAID = "beside gears of the wrist, whose axes turn each other's motors"


def coupled(log: Log, near: float, far: float) -> Log:
    """The log of an arm whose motor of axis 6 turns with axes 5 and 4: its friction, so many times
    the torques of axes 5 and 6."""
    qd = np.gradient(log.q, log.time, axis=0)
    tau = log.tau.copy()
    size = np.sqrt(np.mean(tau**2, axis=0))
    for here, times in ((4, near), (3, far)):
        motor = np.tanh((qd[:, 5] + qd[:, here]) / 0.05) + (qd[:, 5] + qd[:, here])
        for joint in (here, 5):
            tau[:, joint] += times * size[joint] * motor
    return replace(log, tau=tau)


def told(found: LogCheck) -> bool:
    return any(SAID in remark for remark in found.remarks)


@pytest.mark.parametrize(
    ("seed", "near", "far"), [(72107, 2.0, 0.0), (72107, 0.0, 2.0), (72124, 1.5, 1.5)]
)
def test_a_wrist_with_gears_that_no_file_states_is_told(seed: int, near: float, far: float) -> None:
    """Of the recording of a small arm 52 and 57 % of axes 5 and 6 were left, which looked like
    another robot's."""
    drawn = other_arm_log(seed)
    found = check_log(drawn.robot, coupled(drawn.log, near, far))
    assert found.problem is None
    assert told(found)
    assert found.left is not None
    assert found.left.max() < 0.4


@pytest.mark.parametrize("order", [[0, 1, 2, 4, 3, 5], [0, 1, 2, 3, 5, 4], [0, 1, 2, 5, 4, 3]])
def test_columns_of_a_wrist_with_gears_in_another_order_are_refused(order: list[int]) -> None:
    """Gears explain the torques of a neighbour, too."""
    drawn = other_arm_log(72107)
    log = coupled(drawn.log, 0.5, 0.0)
    found = check_log(drawn.robot, replace(log, tau=log.tau[:, order]))
    assert found.problem is not None
    assert not told(found)


def test_angles_of_a_wrist_with_gears_in_another_order_are_refused() -> None:
    drawn = other_arm_log(72107)
    log = coupled(drawn.log, 0.5, 0.0)
    found = check_log(drawn.robot, replace(log, q=log.q[:, [0, 1, 2, 3, 5, 4]], qd=None))
    assert found.problem is not None
