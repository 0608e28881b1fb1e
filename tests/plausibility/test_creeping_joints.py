"""A log whose joints creep, as a mill's do, is no log of joints that move faster."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from robots.imported import robot

import irb2400_ctrl as irb
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import check_log


def creeping(seed: int) -> Log:
    """Of a KR 16 whose joints move by 0.01 to 0.04 rad/s, with friction sharper than is assumed."""
    rng = np.random.default_rng([seed, 30])
    arm = robot("kr16")
    time = np.arange(0.0, 25.0, 0.004)
    low = np.maximum(arm.q_min, -2.0)
    high = np.minimum(arm.q_max, 2.0)
    omega = 2 * np.pi * rng.uniform(0.03, 0.12, (3, arm.n))
    phase = rng.uniform(0, 2 * np.pi, (3, arm.n))
    amplitude = rng.uniform(0.01, 0.04, arm.n) / omega / 3 * np.sqrt(2)
    angle = time[:, None, None] * omega + phase
    middle = (low + high) / 2 + rng.uniform(-0.3, 0.3, arm.n) * (high - low) / 2
    q = middle + (amplitude * np.sin(angle)).sum(axis=1)
    qd = (amplitude * omega * np.cos(angle)).sum(axis=1)
    qdd = -(amplitude * omega**2 * np.sin(angle)).sum(axis=1)
    tau = np.asarray(irb.Model(arm).inverse_dynamics(q, qd, qdd, friction=False))
    size = np.sqrt(np.mean(tau**2, axis=0)) + 0.05 * np.abs(tau).max()
    dry = rng.uniform(0.1, 0.3, arm.n) * size
    tau = tau + dry * np.tanh(qd / 0.003) * (1.0 + 0.3 * np.exp(-((qd / 0.03) ** 2)))
    noise = rng.uniform(0.003, 0.01) * size * rng.normal(size=tau.shape)
    return Log(time, q, tau + noise, name="creeping")


@pytest.mark.parametrize("seed", [3, 4])
def test_joints_that_creep_are_in_no_other_unit(seed: int) -> None:
    """A reading 57 times as fast had a friction as sharp as the true one: of 60 logs of a heavy arm
    that mills 18 were refused for angles in radians under the name of degrees."""
    log = creeping(seed)
    assert check_log(robot("kr16"), log).problem is None
    # where the name is wrong it is said all the same
    problem = check_log(robot("kr16"), replace(log, q=np.degrees(log.q))).problem
    assert problem is not None
    assert problem.kind == "angle_unit"
