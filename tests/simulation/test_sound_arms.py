"""Sound arms of other sizes follow the fastest move that their robot file allows, guards on."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from simulation.other_arms import PALLETISER, SINGLE, arm_of

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded
from irb2400_ctrl.controllers.design import over_poses
from irb2400_ctrl.controllers.sampling import check_sampled_loop
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import joint_move
from irb2400_ctrl.robot import Robot


def fastest_move(robot: Robot, seed: int) -> irb.Trajectory:
    rng = np.random.default_rng(seed)
    middle = (robot.q_max + robot.q_min) / 2
    half = (robot.q_max - robot.q_min) / 4
    ends = middle + half * rng.uniform(-1, 1, (2, robot.n))
    return joint_move(irb.Model(robot), *ends).trajectory


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_palletiser_of_a_ton_keeps_its_brake_open(name: str, tmp_path: Path) -> None:
    """Its torques change by 400 kNm/s, which the guard cut at 100; and 5e-6 rad of an encoder are
    momentum that the guard took for a lie."""
    robot = arm_of(PALLETISER, "palletiser", tmp_path)
    block = guarded(controller(name, robot), robot)
    for seed in (2, 3):
        run = irb.simulate(robot, fastest_move(robot, seed), block, hold=0.3)
        reached = run.summary()["bounds_reached"]
        assert reached["brake_closed_s"] is None
        # it cruises at its limit, which is read by 2e-6 above it between the samples
        assert reached["reference_above_speed_limit"] == []
        if name not in {"pid", "gravity_pd"}:
            assert run.tcp_error.max() < 2e-3


def test_the_guard_of_a_smaller_arm_is_as_it_was() -> None:
    robot = irb.load_robot("irb2400")
    values = {f.name: f.start for f in guarded(controller("pid", robot), robot).parameters}
    np.testing.assert_array_equal(values["torque_rate"], 1e5)
    of_friction = 0.1 * robot.friction[:, 0]
    np.testing.assert_allclose(values["unexplained_limit"], 0.035 * robot.tau_max + of_friction)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_single_axis_is_an_arm(name: str, tmp_path: Path) -> None:
    """Its simulation and its margins ended with CasADi's words about a dimension."""
    robot = arm_of(SINGLE, "single", tmp_path)
    bare = controller(name, robot)
    assert over_poses(robot, bare, [[0.0]]).stable
    block = guarded(bare, robot)
    run = irb.simulate(robot, fastest_move(robot, 2), block, hold=0.3)
    assert np.degrees(np.abs(run.q - run.q_ref)).max() < 8.0
    assert run.summary()["bounds_reached"]["brake_closed_s"] is None


def test_a_joint_that_turns_nothing_is_refused_by_its_name(tmp_path: Path) -> None:
    """It was "a fault of irb2400 itself": a singular matrix."""
    (axis, body), *others = SINGLE
    tip = (("0.3 0 0", *axis[1:]), (0.0, "0 0 0", (0.0, 0.0, 0.0)))
    robot = arm_of(((axis, body), *others, tip), "tip", tmp_path)
    for name in CONTROLLERS:
        with pytest.raises(InputError, match="found no mass that j2 turns"):
            controller(name, robot)
        with pytest.raises(InputError, match="found no mass that j2 turns"):
            check_sampled_loop(robot, partial(controller, name, robot), 0.001)
