"""An arm on a wall or below a ceiling beside a file in which it stands."""

from __future__ import annotations

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.mounting import turned

UP = np.array([0.0, 0.0, -9.81])


@pytest.mark.parametrize(
    ("seed", "gravity"),
    [(880001, (9.81, 0, 0)), (880001, (0, 0, 9.81)), (880002, (0, 6.94, -6.94))],
)
def test_gravity_along_another_axis_is_told_and_no_zero(
    seed: int, gravity: tuple[float, float, float]
) -> None:
    """Of a Rokae AR5 on the side of a torso the zero of joint 2 was called 90 degrees off."""
    drawn = other_arm_log(seed)
    found = log_problem(turned(drawn.robot, np.array(gravity)), drawn.log)
    assert found is not None
    assert found.kind == "mounting"
    told = np.array(found.fits["gravity_m_s2"])
    assert told @ UP > np.cos(np.radians(10.0)) * (UP @ UP)
    assert log_problem(turned(drawn.robot, told), drawn.log) is None


def test_a_base_that_leans_is_an_effect_and_no_mounting() -> None:
    drawn = other_arm_log(880001)
    lean = np.radians(8.0)
    gravity = 9.81 * np.array([np.sin(lean), 0.0, -np.cos(lean)])
    found = log_problem(turned(drawn.robot, gravity), drawn.log)
    assert found is None or found.kind != "mounting"
