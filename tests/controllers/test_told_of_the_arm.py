"""The README of a package says whose angles and torques it takes and gives."""

from __future__ import annotations

import re

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded, momentum_observer


def _readme(name: str, robot: irb.Robot) -> str:
    block = momentum_observer(robot) if name == "observer" else controller(name, robot)
    if name == "pid":
        block = guarded(block, robot)
    return Package(block, "double").files()["README.md"]


@pytest.mark.parametrize("name", ["pid", "computed_torque", "observer"])
def test_joints_stand_in_their_order(name: str) -> None:
    robot = irb.load_robot("ur10e")
    text = _readme(name, robot)
    places = [text.index(f"`{joint}`") for joint in robot.joint_names]
    assert places == sorted(places)
    assert "Torques act on the joints, behind the gears" in text
    assert "theta" not in text
    # sections stand apart
    assert not re.search(r"[^\n]\n## ", text)


def test_of_a_parallelogram_with_the_angles_and_torques_of_a_urdf() -> None:
    robot = irb.load_robot("irb2400")
    rows = _readme("pid", robot).split("```text\n")[1].split("\n```")[0].splitlines()
    rng = np.random.default_rng(1)
    q, tau = rng.normal(size=(2, robot.n))
    theta = robot.A @ q
    told = {"theta": theta, "tau": tau, "q": theta.copy(), "tau_theta": tau.copy()}
    for row in rows:
        exec(row, {"__builtins__": {}}, told)
    np.testing.assert_allclose(told["q"], q)
    # the same power, whichever angles it is reckoned in
    speed = rng.normal(size=robot.n)
    np.testing.assert_allclose(told["tau_theta"] @ (robot.A @ speed), tau @ speed)
