"""A balancer that the robot file does not have is no channel that is misread, nor another arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log

SAID = "beside a balancer on joint 2, which the robot file does not have"


def balanced(log: Log, share: float) -> Log:
    """The log of an arm whose joint 2 has a spring that carries so much of what goes with the sine
    of its angle."""
    angle = log.q[:, 1]
    A = np.column_stack([np.sin(angle), np.cos(angle)])
    tau = log.tau.copy()
    tau[:, 1] -= share * A @ np.linalg.lstsq(A, tau[:, 1], rcond=None)[0]
    return replace(log, tau=tau)


@pytest.mark.parametrize(("seed", "share"), [(72107, 1.3), (72107, 1.0), (72124, 1.0)])
def test_an_arm_with_a_balancer_that_no_file_states_is_told(seed: int, share: float) -> None:
    """Such logs looked like another robot's, or of another unit."""
    drawn = other_arm_log(seed)
    found = check_log(drawn.robot, balanced(drawn.log, share))
    assert found.problem is None
    assert any(SAID in remark for remark in found.remarks)
    assert found.left is not None
    assert found.left.max() < 0.4


@pytest.mark.parametrize("factor", [-1.0, 0.1])
def test_a_torque_that_is_turned_over_or_scaled_is_no_balancer(factor: float) -> None:
    drawn = other_arm_log(72107)
    found = check_log(drawn.robot, replace(drawn.log, tau=drawn.log.tau * [1, factor, 1, 1, 1, 1]))
    assert found.problem is not None
    assert found.problem.joints == (2,)
