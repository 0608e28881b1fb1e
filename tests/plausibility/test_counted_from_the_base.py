"""Axis 3 counted from the base, as controllers of FANUC show it, beside a file of a serial arm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.plausibility import log_problem


@pytest.mark.parametrize("seed", [800004, 800024])
@pytest.mark.parametrize("torques", [False, True])
def test_the_third_angle_is_told_where_bodies_make_up_for_it(seed: int, torques: bool) -> None:
    """It was sound, and identify made up a balancer or lost a half of joint 3."""
    drawn = other_arm_log(seed)
    q = drawn.log.q.copy()
    tau = drawn.log.tau.copy()
    way = np.sign(drawn.robot.links[2].frame.matrix()[2, 2])
    q[:, 2] += way * q[:, 1]
    if torques:
        tau[:, 1] -= way * tau[:, 2]
    problem = log_problem(drawn.robot, replace(drawn.log, q=q, tau=tau, qd=None))
    assert problem is not None
    assert (problem.kind, problem.joints) == ("coupling", (3,))
    assert ("torques" in problem.fits) == torques
    sign = "-" if way > 0.0 else "+"
    mended = [f"--coupling 3,2,{sign}1"]
    if not torques:
        mended = [f"is q3 {sign} q2 of the log", f"plus = {{ 2 = {sign}1.0 }}"]
    assert all(said in problem.says for said in mended)


@pytest.mark.parametrize("seed", [800004, 800024])
def test_as_the_file_counts_it_is_sound(seed: int) -> None:
    drawn = other_arm_log(seed)
    assert log_problem(drawn.robot, drawn.log) is None
