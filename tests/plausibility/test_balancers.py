"""A balancer that has lost strength is no channel that is misread: the log is the arm's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.effects.balancer import Balancer
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.robot import load_robot

STATED = Balancer(joint=2, torque_Nm=600.0, neutral_rad=0.1, lever_ratio=0.25, free_ratio=-2.0)
ROBOT = load_robot("irb2400").with_effects(STATED)
OTHER = "another strength of the balancer that the file states (joint 2)"


def recorded(seed: int, share: float, on_third: float = 0.0) -> Log:
    """A motion of the arm with so much of the balancer's strength, and of such a one on joint 3."""
    seen = Case(seed, duration=16.0, validation_duration=3.0).simulate()[0]
    d = seen.q[:, 1:3] - 0.1
    length = np.sqrt(1.0 + 0.25**2 - 0.5 * np.cos(d))
    tau = seen.tau.copy()
    strength = 600.0 * np.array([share, on_third])
    tau[:, 1:3] += strength * (1.0 + 2.0 * 0.75 / length) * np.sin(d)
    return Log(seen.time, seen.q, tau, q_ref=seen.q_ref)


@pytest.mark.parametrize(("seed", "share"), [(3529001, 0.0), (3529001, 0.3), (3529000, 0.5)])
def test_a_balancer_that_has_lost_strength_is_told(seed: int, share: float) -> None:
    """Torques of joint 2 looked turned over, or scaled."""
    found = check_log(ROBOT, recorded(seed, share))
    assert found.problem is None
    assert any(OTHER in remark for remark in found.remarks)


def test_of_two_balancers_one_alone_may_have_lost_strength() -> None:
    """No strength for both fits then."""
    both = ROBOT.with_effects(STATED.model_copy(update={"joint": 3, "torque_Nm": 300.0}))
    as_stated = check_log(both, recorded(3529001, 1.0, 0.5)).remarks
    assert not any("another strength" in remark for remark in as_stated)
    for shares in ((0.0, 0.5), (1.0, 0.0)):
        found = check_log(both, recorded(3529001, *shares))
        assert found.problem is None, shares
        assert any("(joint 2 and joint 3)" in remark for remark in found.remarks)


def test_one_as_strong_as_stated_is_not() -> None:
    found = check_log(ROBOT, recorded(3529001, 1.0))
    assert found.problem is None
    assert not any(OTHER in remark for remark in found.remarks)


def test_what_another_strength_hardly_says_better_is_not_taken_for_it() -> None:
    """An arm as it was identified, of which a gas spring's shape left a little more than is usual,
    was told that its balancer has another strength."""
    log = recorded(3529001, 0.93)
    tau = log.tau.copy()
    tau[:, 1] += 248.0 * np.sin(2.0 * log.time)
    found = check_log(ROBOT, Log(log.time, log.q, tau, q_ref=log.q_ref))
    assert found.problem is None
    assert not any(OTHER in remark for remark in found.remarks)


@pytest.mark.parametrize(
    ("wrong", "kind"),
    [
        (lambda q, tau: (q, tau * [1, -1, 1, 1, 1, 1]), "torque_sign"),
        (lambda q, tau: (q * [1, -1, 1, 1, 1, 1], tau), "angle_sign"),
        (lambda q, tau: (q, tau * [1, 0.1, 1, 1, 1, 1]), "torque_scale"),
        (lambda q, tau: (q + np.eye(6)[1] * np.pi / 2, tau), "angle_zero"),
    ],
)
def test_a_wrong_channel_is_told_beside_a_balancer(wrong: Any, kind: str) -> None:
    """A free strength takes none of them in."""
    log = recorded(3529001, 1.0)
    q, tau = wrong(log.q, log.tau)
    problem = check_log(ROBOT, Log(log.time, q, tau)).problem
    assert problem is not None
    assert problem.kind == kind
