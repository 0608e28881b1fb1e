"""Tool paths with limits of torque rate and jerk, through `plan_path` and the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners import Plan, ToolPath, check, plan_path
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.toolpath import builders

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)


def corner(side: float = 0.2) -> ToolPath:
    """Two sides of a square [m]: between them the tool nearly stops."""
    points = np.array([[0.9, 0.1 - side, 0.5], [0.9, 0.1, 0.5], [0.9 + side, 0.1, 0.5]])
    return builders.way_points(points, np.tile([0.0, 0.0, 1.0], (3, 1)))


def without_dry_friction(plan: Plan) -> np.ndarray:
    t = plan.trajectory
    return t.tau - MODEL.friction(t.qd) + ROBOT.friction[:, 2] * t.qd


@pytest.fixture(scope="module")
def plan() -> Plan:
    return plan_path(
        ROBOT, corner(), rate=10_000.0, free_tool_rotation=False, torque_rate=20 * ROBOT.tau_max
    )


def test_torque_changes_slowly_along_a_tool_path(plan: Plan) -> None:
    tau = without_dry_friction(plan)
    change = np.abs(np.diff(tau, axis=0)) * 10_000.0
    assert (change <= 20 * ROBOT.tau_max * (1 + 1e-6)).all()
    assert (np.abs(plan.trajectory.tau) <= ROBOT.tau_max).all()
    # holding at both ends
    held = MODEL.gravity(plan.trajectory.q[[0, -1]])
    np.testing.assert_allclose(tau[[0, -1]], held, atol=1e-9)
    assert plan.guaranteed
    assert check(plan.certificate, MODEL).holds()


def test_plan_states_rates_and_price(plan: Plan) -> None:
    said = plan.summary()
    most = np.array(said["max_torque_rate_Nm_s"])
    limit = np.array(said["torque_rate_limit_Nm_s"])
    np.testing.assert_allclose(limit, 20 * ROBOT.tau_max)
    assert (most <= limit * (1 + 1e-9)).all()
    assert (most / limit).max() > 0.99
    assert "max_jerk_deg_s3" not in said
    assert said["duration_without_rates_s"] < plan.duration < 1.4 * said["duration_without_rates_s"]
    seen = np.abs(np.diff(without_dry_friction(plan), axis=0)).max(axis=0) * 10_000.0
    assert (seen <= most * (1 + 1e-6)).all()
    jumping = plan_path(ROBOT, corner(), free_tool_rotation=False, torque_rate=np.inf)
    assert not any("rate" in name for name in jumping.summary())


def test_feed_and_jerk() -> None:
    path = builders.line((0.9, 0, 0.5), (0.9, 0.3, 0.5), feed=0.2)
    plan = plan_path(ROBOT, path, rate=5000.0, jerk=np.radians(3000))
    jerk = np.abs(np.diff(plan.trajectory.qdd, axis=0)) * 5000.0
    assert jerk.max() <= np.radians(3000) * (1 + 1e-6)
    assert plan.max_feed_ratio is not None
    assert 0.999 < plan.max_feed_ratio <= 1 + 1e-9
    said = plan.summary()
    assert max(said["max_jerk_deg_s3"]) <= 3000 * (1 + 1e-9)
    assert said["jerk_limit_deg_s3"] == pytest.approx([3000.0] * 6)


def test_effects_without_a_bound_of_their_slope_are_looked_at() -> None:
    effects = [
        LIBRARY["load_friction"].of(2, coefficient=0.08),
        LIBRARY["viscous_power"].of(1, coefficient=60, exponent=1.5),
    ]
    robot = ROBOT.with_effects(*effects)
    plan = plan_path(
        robot, corner(0.05), rate=10_000.0, free_tool_rotation=False, torque_rate=20 * robot.tau_max
    )
    # torque is bounded, its rate is not: nothing is promised
    assert plan.max_torque_ratio <= 1.0
    assert not plan.guaranteed
    assert "rate" in plan.guarantee_note
    tau = plan.trajectory.tau - MODEL.friction(plan.trajectory.qd)
    same_way = (np.sign(plan.trajectory.qd[1:]) == np.sign(plan.trajectory.qd[:-1])).all(axis=1)
    change = np.abs(np.diff(tau + ROBOT.friction[:, 2] * plan.trajectory.qd, axis=0)) * 10_000.0
    assert (change[same_way] <= 20 * ROBOT.tau_max).all()


def test_wrong_limits_are_refused() -> None:
    path = corner()
    with pytest.raises(
        InputError, match=r"torque_rate: found -1\.0 Nm/s, expected a positive number"
    ):
        plan_path(ROBOT, path, torque_rate=-1.0)
    with pytest.raises(InputError, match="one for each of the 6 axes"):
        plan_path(ROBOT, path, jerk=[1.0, 2.0])
    with pytest.raises(InputError, match="'toppra' with a limit of torque rate or jerk"):
        plan_path(ROBOT, path, jerk=10.0, timing="toppra")
    with pytest.raises(
        InfeasibleError,
        match=r"at \d+\.\d mm, axis \d would have to be slower .* jerk of .* deg/s3",
    ):
        plan_path(ROBOT, path, free_tool_rotation=False, jerk=1e-12)
    limits = MotionLimits.of(ROBOT)
    assert limits.with_rates(None, None) == limits


def test_command_line(tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    rows = ["x_mm,y_mm,z_mm,i,j,k", *(f"{900 + 2 * k},{-50 + 4 * k},700,0,0,1" for k in range(26))]
    path.write_text("\n".join(rows) + "\n")
    options = ["--fixed", "--torque-rate", "10", "--jerk", "5000", "--out", str(tmp_path / "plan")]
    result = CliRunner().invoke(app, ["plan", str(path), *options])
    assert result.exit_code == 0, result.output
    said = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert said["torque_rate_limit_Nm_s"] == pytest.approx((10 * ROBOT.tau_max).tolist())
    assert said["jerk_limit_deg_s3"] == pytest.approx([5000.0] * 6)
    assert said["guaranteed"]
    assert "longer than without limits of the rates" in result.output


def test_rates_that_cost_nothing_are_not_told(tmp_path: Path) -> None:
    """`0.00 s longer than without limits of the rates`."""
    path = tmp_path / "slow.csv"
    path.write_text("x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n900,0,700,0,0,1,5\n910,0,700,0,0,1,5\n")
    out = str(tmp_path / "plan")
    result = CliRunner().invoke(app, ["plan", str(path), "--fixed", "--out", out])
    assert result.exit_code == 0, result.output
    said = json.loads((tmp_path / "plan" / "plan.json").read_text())
    assert said["duration_s"] - said["duration_without_rates_s"] < 0.005
    assert "longer than without" not in result.output
