"""The map of tool rotations along a path says what a plan with each of them would meet."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.planners import Plan, builders, plan_path
from irb2400_ctrl.planners.redundancy.rotation_map import LIMITS, RotationMap
from irb2400_ctrl.report.pages.plan_page import plan_page

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
START = (0.9, -0.15, 0.5)
END = (0.9, 0.15, 0.5)


@pytest.fixture(scope="module")
def plan() -> Plan:
    path = builders.line(START, END, feed=0.1)
    return plan_path(ROBOT, path, torque_rate=np.inf, rotation_map=True)


def of(plan: Plan) -> RotationMap:
    assert plan.rotation_map is not None
    return plan.rotation_map


def test_the_map_spans_the_path_and_the_circle(plan: Plan) -> None:
    found = of(plan)
    assert found.worth.shape == (len(found.way), len(found.rotation)) == found.limit.shape
    assert found.way[[0, -1]] == pytest.approx([0.0, plan.length], abs=1e-4)
    assert found.rotation[[0, -1]] == pytest.approx(np.radians([0, 355]))
    # the line that is driven is that of the plan
    assert found.chosen[[0, -1]] == pytest.approx(plan.rotation[[0, -1]], abs=1e-6)
    # and it meets nothing
    near = np.rint(np.degrees(found.chosen) / 5).astype(int) % 72
    assert not found.limit[np.arange(len(near)), near].any()


def test_the_way_is_the_tip_s_where_the_tool_tilts() -> None:
    """It counted the tilting: the map of the raster that comes along was 3461 mm long, of 2821."""
    y = np.linspace(-0.1, 0.1, 21)
    points = np.stack([0.9 + 0 * y, y, 0.5 + 0 * y], axis=1)
    tilt = 0.3 * np.sin(30.0 * y)
    axes = np.stack([np.sin(tilt), 0 * y, np.cos(tilt)], axis=1)
    path = builders.way_points(points, axes, feed=0.1)
    tilted = plan_path(ROBOT, path, torque_rate=np.inf, rotation_map=True)
    assert of(tilted).way[[0, -1]] == pytest.approx([0.0, tilted.length], abs=1e-4)


def test_each_place_is_what_the_arm_says_of_it(plan: Plan) -> None:
    """Every fifth place by the closed form of a single pose, all branches, against the map."""
    found = of(plan)
    q0 = plan.trajectory.q[0]
    X0 = np.asarray(MODEL.tcp_pose(q0))
    spindle = ROBOT.spindle_axis
    place = np.array(START)
    seen = set()
    for k in range(0, 72, 3):
        angle = found.rotation[k] - found.chosen[0]
        K = np.cross(np.eye(3), spindle)
        X = X0.copy()
        X[:3, :3] = X0[:3, :3] @ (np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K)
        X[:3, 3] = place
        kind = LIMITS[found.limit[0, k]]
        branches = MODEL.inverse_kinematics_branches(X[None]).q[0]
        reached = np.isfinite(branches).all(axis=1)
        assert (kind == "out of reach") <= (not reached.all())
        turns = 2 * np.pi * np.arange(-1, 2)
        every = branches[:, :, None] + turns
        inside = (every >= ROBOT.q_min[:, None]) & (every <= ROBOT.q_max[:, None])
        boxed = inside.any(axis=2).all(axis=1) & reached
        if not kind:
            assert boxed.any()
        if not boxed.any():
            assert kind in {"joint limits", "out of reach"}
        seen.add(kind)
    assert "" in seen
    assert len(seen) > 1


def test_a_feed_that_cannot_be_kept_is_on_the_map() -> None:
    fast = plan_path(
        ROBOT, builders.line(START, END, feed=30.0), torque_rate=np.inf, rotation_map=True
    )
    assert (of(fast).limit == LIMITS.index("feed")).any()


def test_the_map_is_written_and_drawn(plan: Plan, tmp_path: Path) -> None:
    plan.write(tmp_path)
    told = json.loads((tmp_path / "rotation_map.json").read_text())
    assert np.array(told["limit"]).shape == of(plan).limit.shape
    assert told["limits"] == list(LIMITS)
    page = plan_page(plan, "A plan").write(tmp_path / "report.html").read_text()
    assert "What every tool rotation would meet" in page


def test_a_plan_without_the_question_has_no_map() -> None:
    bare = plan_path(ROBOT, builders.line(START, END), torque_rate=np.inf)
    assert bare.rotation_map is None
