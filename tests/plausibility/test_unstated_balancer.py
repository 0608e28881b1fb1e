"""A balancer that the robot file does not have is no channel that is misread, nor another arm."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.plausibility.balancer import beside_a_balancer
from irb2400_ctrl.plausibility.evidence import Fit

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


@pytest.mark.parametrize(
    ("cost", "price", "left", "told"),
    [
        (500.0, 140.0, 0.35, True),
        (500.0, 160.0, 0.35, False),
        (500.0, 140.0, 0.45, False),
        # not clearly better than another reading
        (575.0, 140.0, 0.35, False),
    ],
)
def test_what_a_balancer_has_to_explain(cost: float, price: float, left: float, told: bool) -> None:
    none = np.zeros((3, 6))
    rows: Any = SimpleNamespace(tau=none, q=none, size=np.ones(6))
    found = SimpleNamespace(fit=Fit(cost, price, np.full(6, left)))
    nominal: Any = SimpleNamespace(
        robot=SimpleNamespace(n=6), columns=lambda rows: None, account=lambda *of: found
    )
    best = Fit(600.0, 200.0, np.full(6, 0.5))
    assert (beside_a_balancer(nominal, rows, best) is not None) == told


def test_of_a_file_that_has_a_balancer_it_is_not_said_that_it_has_none() -> None:
    """One that rests elsewhere than the file says is another matter."""
    drawn = other_arm_log(72107)
    size = float(np.abs(drawn.log.tau[:, 1]).max())
    stated = LIBRARY["balancer"].of(2, torque_Nm=0.3 * size, neutral_rad=2.0)
    robot = drawn.robot.model_copy(update={"effects": (stated,)})
    found = check_log(robot, balanced(drawn.log, 1.3))
    assert not any(SAID in remark for remark in found.remarks)
