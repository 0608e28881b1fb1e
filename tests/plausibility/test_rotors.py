"""No URDF has the rotors, which are most of the torque of a quick wrist: no column is wrong for
them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from other_arm_logs import other_arm_log
from scipy.signal import savgol_filter

from irb2400_ctrl.effects.rotor_inertia import RotorInertia
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.evidence import Nominal
from irb2400_ctrl.plausibility.rows import rows_of
from irb2400_ctrl.robot import load_robot


def rotor_torque(log: Log, joint: int) -> npt.NDArray[np.float64]:
    """Of a rotor that needs as much as all else together, shape (m,) [Nm]."""
    width = max(5, int(0.12 * log.rate) | 1)
    qdd = savgol_filter(log.q[:, joint], width, 3, deriv=2, delta=1 / log.rate)
    rms = [np.sqrt(np.mean(x**2)) for x in (log.tau[:, joint], qdd)]
    return np.asarray(rms[0] / rms[1] * qdd)


@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (5, 9))]
)
def test_a_rotor_that_the_file_does_not_state_is_no_wrong_column(seed: int) -> None:
    """Arms whose rotors need three times the torque of all else were another robot, or their
    torques in another unit."""
    drawn = other_arm_log(seed)
    tau = drawn.log.tau.copy()
    for joint in (3, 4, 5):
        tau[:, joint] += 3.0 * rotor_torque(drawn.log, joint)
    assert log_problem(drawn.robot, replace(drawn.log, tau=tau)) is None
    # what pulls the joint along as it accelerates is no rotor
    tau = drawn.log.tau.copy()
    for joint in (3, 4, 5):
        tau[:, joint] -= 3.0 * rotor_torque(drawn.log, joint)
    assert log_problem(drawn.robot, replace(drawn.log, tau=tau)) is not None


def test_an_arm_with_such_rotors_below_a_ceiling_is_told() -> None:
    drawn = other_arm_log(1)
    tau = drawn.log.tau.copy()
    for joint in (3, 4, 5):
        tau[:, joint] += 3.0 * rotor_torque(drawn.log, joint)
    other_way = tuple(-g for g in drawn.robot.gravity_m_s2)
    hanging = drawn.robot.model_copy(update={"gravity_m_s2": other_way})
    problem = log_problem(hanging, replace(drawn.log, tau=tau))
    assert problem is not None
    assert problem.kind == "mounting"


def test_beside_unknown_friction_rotors_stay_as_unknown() -> None:
    nominal = Nominal(load_robot("irb2400"))
    for one in (nominal, nominal.with_unknown_rotors()):
        assert one.with_unknown_friction([2]).free_rotors == one.free_rotors


def test_a_rotor_that_the_file_states_is_known_to_a_third() -> None:
    robot = load_robot("irb2400")
    nominal = Nominal(
        robot.with_effects(
            RotorInertia(joint=2, inertia_kgm2=4.0), RotorInertia(joint=2, inertia_kgm2=2.0)
        )
    )
    assert nominal.rotors.tolist() == [0.0, 6.0, 0.0, 0.0, 0.0, 0.0]
    rows = rows_of(other_arm_log(1).log)
    assert rows is not None
    rows = rows.with_torque(np.full_like(rows.tau, 10.0))
    spreads = nominal.with_unknown_rotors()._drive_spreads(rows)
    assert spreads.shape == (4, 6)
    assert spreads[2, 1] == pytest.approx(1.8)
    push = np.sqrt(np.mean(rows.qdd**2, axis=0))
    assert np.delete(spreads[2], 1) == pytest.approx(np.delete(1.5 / push, 1), rel=1e-3)
