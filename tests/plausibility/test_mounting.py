"""An arm on a wall or below a ceiling beside a file in which it stands."""

from __future__ import annotations

import numpy as np
import pytest
from other_arm_logs import other_arm_log

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.plausibility.mounting import turned
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.trajectory import from_angles

UP = np.array([0.0, 0.0, -9.81])
TIME = np.linspace(0.0, 20.0, 2501)
REST = np.sin(np.pi * TIME / TIME[-1])[:, None] ** 2
Q = 0.6 * REST * np.sin(np.outer(TIME, 1.0 + 0.17 * np.arange(6))) + [0.1, 0.2, -0.1, 0.0, 0.5, 0.0]


@pytest.mark.parametrize(
    ("seed", "gravity"),
    [
        (880001, (9.81, 0, 0)),
        (880001, (0, 0, 9.81)),
        pytest.param(880002, (0, 6.94, -6.94), marks=pytest.mark.slow),
    ],
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


def test_a_spring_of_the_file_is_no_part_of_gravity() -> None:
    """It pulls however the arm is mounted."""
    arm = load_robot("irb2400")
    spring = LIBRARY["cable_spring"].of(2, stiffness_Nm_rad=300.0, neutral_rad=-1.0)
    sprung = arm.with_effects(spring)
    m = from_angles(TIME, Q)
    wall = turned(sprung, np.array([9.81, 0.0, 0.0]))
    tau = np.asarray(Model(wall).inverse_dynamics(m.q, m.qd, m.qdd))
    noise = np.random.default_rng(5).standard_normal(tau.shape)
    log = Log(TIME, Q, tau + noise)
    found = log_problem(sprung, log)
    assert found is not None
    assert found.kind == "mounting"
    assert found.fits["gravity_m_s2"] == pytest.approx([9.81, 0.0, 0.0], abs=0.3)
