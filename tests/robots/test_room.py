"""Excitations keep to a place where the arm has room, and are planned for arms of other shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.imported import MOST, robot

import irb2400_ctrl as irb
from irb2400_ctrl.excitation import excite
from irb2400_ctrl.excitation.motion_design import Budget
from irb2400_ctrl.excitation.room import floor_and_column, height_and_radius, with_room
from irb2400_ctrl.robot import Transform


def test_the_irb_2400_moves_in_its_whole_box() -> None:
    arm = irb.load_robot("irb2400")
    assert with_room(arm) is arm
    assert floor_and_column(arm) == (0.10, 0.40)


@pytest.mark.parametrize("name", ["ur5", "tx90", "puma560", "panda"])
def test_a_narrowed_box_is_clear(name: str) -> None:
    arm = robot(name)
    narrow = with_room(arm, narrow=True)
    assert (narrow.q_min >= arm.q_min - 1e-12).all()
    assert (narrow.q_max <= arm.q_max + 1e-12).all()
    q = np.random.default_rng(1).uniform(narrow.q_min, narrow.q_max, (500, arm.n))
    height, radius = height_and_radius(irb.Model(arm), q)
    floor, column = floor_and_column(arm)
    assert ((height >= floor) & (radius >= column)).mean() > 0.8


def test_the_distance_is_that_from_axis_1_wherever_the_arm_stands() -> None:
    arm = irb.load_robot("irb2400")
    X = np.eye(4)
    X[:3, 3] = [0.4, -0.3, 0.2]
    frame = X @ arm.links[0].frame.matrix()
    link = arm.links[0].model_copy(
        update={"frame": Transform.model_validate({"transform": frame.tolist()})}
    )
    moved = arm.model_copy(update={"links": (link, *arm.links[1:])})
    q = np.random.default_rng(2).uniform(arm.q_min, arm.q_max, (20, 6))
    height, radius = height_and_radius(irb.Model(moved), q)
    here = height_and_radius(irb.Model(arm), q)
    np.testing.assert_allclose(height, here[0] + 0.2, atol=1e-12)
    np.testing.assert_allclose(radius, here[1], atol=1e-12)


@pytest.mark.parametrize("name", [*MOST, "panda"])
def test_an_excitation_of_every_arm(name: str, tmp_path: Path) -> None:
    arm = robot(name)
    found = excite(arm, "payload", seconds=10.0, budget=Budget(6, 0, 0))
    tau = irb.Model(arm).inverse_dynamics(found.course.q, found.course.qd, found.course.qdd)
    assert (np.abs(tau) <= arm.tau_max).all()
    height, radius = height_and_radius(irb.Model(arm), found.course.q)
    floor, column = floor_and_column(arm)
    assert height.min() >= floor
    assert radius.min() >= column
    assert all(path.is_file() for path in found.write(tmp_path))
