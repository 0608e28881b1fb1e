"""URDF export: what Pinocchio reads from it is the same arm."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from model.second_robots import ur_like
from model.states import random_states

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.robot.urdf_export import save_urdf, to_urdf

pin: Any = pytest.importorskip("pinocchio")


@pytest.fixture(params=["irb2400", "ur_like"])
def arm(request: pytest.FixtureRequest, robot: irb.Robot) -> irb.Robot:
    return robot if request.param == "irb2400" else ur_like()


def test_torques_agree_through_the_coupling(arm: irb.Robot) -> None:
    """The file's joints are A q; tau_q = A^T tau_joint, as its head says."""
    engine = pin.buildModelFromXML(to_urdf(arm))
    data = engine.createData()
    states = random_states(arm, 50)
    model = irb.Model(arm)
    A = arm.A
    tau = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    for row, expected in zip(zip(states.q, states.qd, states.qdd, strict=True), tau, strict=True):
        found = A.T @ pin.rnea(engine, data, *(A @ value for value in row))
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(tau).max())


def test_poses_agree(arm: irb.Robot) -> None:
    engine = pin.buildModelFromXML(to_urdf(arm))
    data = engine.createData()
    model = irb.Model(arm)
    for q in random_states(arm, 20).q:
        pin.framesForwardKinematics(engine, data, arm.A @ q)
        for name, expected in (("tcp", model.tcp_pose(q)), ("flange", model.flange_pose(q))):
            found = data.oMf[engine.getFrameId(name)].homogeneous
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_limits_of_uncoupled_joints_are_those_of_the_actuators(robot: irb.Robot) -> None:
    engine = pin.buildModelFromXML(to_urdf(robot))
    free = [0, 1, 3, 4, 5]
    np.testing.assert_allclose(engine.lowerPositionLimit[free], robot.q_min[free])
    np.testing.assert_allclose(engine.upperPositionLimit[free], robot.q_max[free])
    np.testing.assert_allclose(engine.upperPositionLimit[2], robot.q_max[2] - robot.q_min[1])
    np.testing.assert_allclose(engine.upperVelocityLimit[2], robot.qd_max[1] + robot.qd_max[2])


def test_the_head_explains_the_parallelogram_and_names_what_is_lost(
    robot: irb.Robot, tmp_path: Path
) -> None:
    arm = robot.with_effects(LIBRARY["payload"].of(None, mass_kg=1.0))
    text = save_urdf(arm, tmp_path / "arm.urdf").read_text()
    assert "axis_3 = q3 - q2" in text
    assert "tau_q = A^T tau_joint" in text
    assert "payload" in text
    assert ET.fromstring(text).get("name") == robot.name


def test_a_serial_arm_needs_no_such_note() -> None:
    assert "parallelogram" not in to_urdf(ur_like())
