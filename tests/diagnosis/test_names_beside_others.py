"""A name beside another effect is judged by what that one may leave where both act."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names, sound, turned_over

from irb2400_ctrl.diagnosis import diagnose


def test_a_hysteresis_beside_a_cable_of_another_joint_is_named() -> None:
    """The cable's evidence, as large as it is, says nothing about another joint."""
    log = sound()
    tau = log.tau.copy()
    tau[:, 3] += 1.5 * turned_over(4, 0.02)
    tau[:, 5] += 1.4 * (log.q[:, 5] - 0.1)
    found = diagnose(ROBOT, replace(log, tau=tau))
    assert set(names(found)) == {("cable_spring", 6), ("hysteresis", 4)}


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_cylinder_of_nearly_constant_force_is_a_balancer(sign: float) -> None:
    """Pulling or pushing: sign F dl/dq over a lever of half the distance of its pins."""
    log = sound()
    angle = log.q[:, 1] - 0.2
    length = np.sqrt(1 + 0.5**2 - 2 * 0.5 * np.cos(angle))
    tau = log.tau.copy()
    tau[:, 1] += sign * 150.0 * 0.5 * np.sin(angle) / length
    (finding,) = diagnose(ROBOT, replace(log, tau=tau)).findings
    effect: Any = finding.effect
    assert (effect.kind, effect.joint) == ("balancer", 2)
    d = log.q[:, 1] - effect.neutral_rad
    rho = effect.lever_ratio
    spring = 1 - effect.free_ratio * (1 - rho) / np.sqrt(1 + rho**2 - 2 * rho * np.cos(d))
    said = effect.torque_Nm * spring * np.sin(d)
    true = tau[:, 1] - log.tau[:, 1]
    # the arm's own numbers take a part: of the swing, not of the mean, there is most
    assert np.corrcoef(said, true)[0, 1] > 0.9
