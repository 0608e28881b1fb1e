"""What is left on an arm without an effect is what its log cannot tell, though it is several times
what neighbouring torques disagree about."""

from __future__ import annotations

import numpy as np
import pytest
from third_plant.case import Case
from third_plant.sensors import SHOWN
from third_plant.suites import plan

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import Log, prepare
from irb2400_ctrl.robot import load_robot

EVERY = 5
"""samples at which the inertia is looked at"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["clean/10", "clean/6"], ids=["without_command", "filtered"])
def test_it_is_the_noise_of_torques_and_of_angles(name: str) -> None:
    """left = noise - M (qdd of the log - qdd): on axis 1 two to four times the torque noise."""
    (planned,) = (one for one in plan(20263691) if one.name == name)
    case = Case(planned)
    seen = case.identification()
    run = case.made.runs[0]
    log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref, name=name)
    compared = diagnose(load_robot("irb2400"), log).identification
    motion = prepare(log)

    def at_log(truth: Array) -> Array:
        columns = [np.interp(motion.time, seen.time, one) for one in truth.T]
        return np.column_stack(columns)[::EVERY]

    q, _, qdd = (at_log(one[SHOWN]) for one in run.motion)
    inertia = np.array([case.made.arm.mass_matrix(one) for one in q])
    of_angles = np.einsum("nij,nj->ni", inertia, motion.qdd[::EVERY] - qdd)
    of_torques = at_log(seen.tau - run.tau)
    left = (compared.measured - compared.after)[::EVERY]
    known = compared.known[::EVERY]
    for j in range(6):
        here = known[:, j]
        other = left[here, j] - of_torques[here, j] + of_angles[here, j]
        assert np.mean(other**2) < 0.02 * np.mean(left[here, j] ** 2)
    assert np.std(left[known[:, 0], 0]) > 2.0 * np.std(of_torques[known[:, 0], 0])
