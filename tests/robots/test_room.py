"""Excitations keep to a place where the arm has room, and are planned for arms of other shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.imported import MOST, robot

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.excitation import excite
from irb2400_ctrl.excitation.motion_design import Budget
from irb2400_ctrl.excitation.room import (
    floor_and_column,
    height_and_radius,
    in_room,
    ranges_kept,
    with_room,
)
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
    assert ((height >= floor) & (radius >= column)).mean() > 0.85
    # whole turns away is the same place
    assert (np.abs(narrow.q_min + narrow.q_max) / 2 <= np.pi).all()


def test_the_floor_lies_below_a_low_shoulder() -> None:
    floor, column = floor_and_column(robot("ur5"))
    assert (floor, column) == pytest.approx((0.0446, 0.2197), abs=1e-4)
    # half a reach below a base frame in the shoulder
    floor, _ = floor_and_column(robot("puma560"))
    assert floor == pytest.approx(-0.483, abs=1e-3)


def test_an_arm_stretched_out_in_the_middle_of_its_box_is_narrowed() -> None:
    arm = robot("ur5")
    assert (with_room(arm).q_max < arm.q_max).any()


def test_a_part_of_the_ranges_is_said_with_its_ends() -> None:
    arm = irb.load_robot("ur10e")
    found = excite(arm, "payload", seconds=10.0, budget=Budget(6, 0, 0))
    kept = np.array(ranges_kept(found.robot))
    assert (np.ptp(kept, axis=1) < 180.0).all()
    (said,) = [line for line in found.lines() if "only a part of the joints' ranges" in line]
    assert f"{kept[0, 0]:.0f} … {kept[0, 1]:.0f}, {kept[1, 0]:.0f} … {kept[1, 1]:.0f}" in said
    summary = found.summary()
    np.testing.assert_array_equal(summary["ranges_kept_deg"], kept)
    q = np.degrees(found.course.q)
    nearest = np.minimum(q - kept[:, 0], kept[:, 1] - q).min()
    assert summary["smallest_distance_from_joint_box_deg"] == pytest.approx(nearest, abs=0.01)


def test_nothing_is_said_of_an_arm_that_uses_its_whole_ranges() -> None:
    found = excite(irb.load_robot("irb2400"), "payload", seconds=10.0, budget=Budget(6, 0, 0))
    assert not any("only a part" in line for line in found.lines())
    assert found.summary()["ranges_kept_deg"] is None


def test_flange_and_tip_both_count() -> None:
    arm = irb.load_robot("irb2400")
    model = irb.Model(arm)
    q = np.random.default_rng(3).uniform(arm.q_min, arm.q_max, (50, 6))
    heights = np.stack([model.tcp_pose(q)[:, 2, 3], model.flange_pose(q)[:, 2, 3]])
    assert set(np.argmin(heights, axis=0)) == {0, 1}
    np.testing.assert_allclose(height_and_radius(model, q)[0], heights.min(axis=0), atol=1e-12)


def test_an_arm_that_only_reaches_into_the_floor_has_no_room() -> None:
    arm = irb.load_robot("irb2400")
    model = irb.Model(arm)
    q = np.random.default_rng(4).uniform(arm.q_min, arm.q_max, (200, 6))
    lowest = np.degrees(q[np.argmin(height_and_radius(model, q)[0])])
    joints = [
        joint.model_copy(
            update={"limits": joint.limits.model_copy(update={"range_deg": (v - 0.1, v + 0.1)})}
        )
        for joint, v in zip(arm.joints, lowest, strict=True)
    ]
    held = arm.model_copy(update={"joints": tuple(joints)})
    with pytest.raises(InfeasibleError, match=r"less than 0.10 m above the base plane or 0.40 m"):
        with_room(held)


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


def test_what_finds_no_way_is_planned_once_more_in_narrow_ranges() -> None:
    arm = irb.load_robot("irb2400")
    tried = []

    def planned(room: irb.Robot) -> int:
        tried.append(room)
        if len(tried) == 1:
            raise InfeasibleError("no way")
        return len(tried)

    assert in_room(arm, planned) == 2
    assert tried == [arm, with_room(arm, narrow=True)]
    assert tried[0] != tried[1]
