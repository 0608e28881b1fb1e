"""Every named tool path of `toolpaths.toml` does what the file says."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from toolpath_cases import CASES, build

from irb2400_ctrl import errors, load_robot
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import MotionLimits, Plan, check, plan_path
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.toolpath.task_curve import ROTATION_LENGTH

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
SPINDLE = np.array([0.0, 0.0, 1.0])


def test_there_are_at_least_25_with_different_names() -> None:
    assert len({case["name"] for case in CASES}) == len(CASES) >= 25


@cache
def planned(name: str) -> Plan:
    """The plan of a named tool path, made once for all that is asked of it."""
    case: dict[str, Any] = next(c for c in CASES if c["name"] == name)
    options = dict(case.get("plan", {}))
    limits = MotionLimits.of(ROBOT)
    if "tau_max_Nm" in options:
        limits = replace(limits, tau_max=np.array(options["tau_max_Nm"], dtype=float))
    return plan_path(
        ROBOT,
        build(MODEL, **case["build"]),
        free_tool_rotation=not options.get("fixed", False),
        axis_tolerance=np.radians(options.get("axis_tolerance_deg", 0.1)),
        limits=limits,
    )


def test_a_joint_that_moves_by_rounding_alone_is_at_rest() -> None:
    """Its dry friction would follow the sign of rounding, in the digits that are written too."""
    plan = planned("exactly through the wrist")
    assert (np.ptp(plan.trajectory.q[:, :3], axis=0) == 0).all()
    assert (plan.reference.states(np.linspace(0, plan.duration, 200))[1][:, :3] == 0).all()


def test_a_path_that_hits_the_wrist_exactly_needs_no_tolerance() -> None:
    case = next(c for c in CASES if c["name"] == "exactly through the wrist")
    path = build(MODEL, **case["build"])
    plan = plan_path(ROBOT, path, free_tool_rotation=False, axis_tolerance=0.0)
    assert [p["taken"] for p in plan.passages] == ["through"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_named_toolpath(case: dict[str, Any]) -> None:
    if case["expect"] != "planned":
        with pytest.raises(getattr(errors, case["expect"]), match=case["says"]):
            planned(case["name"])
        return
    plan = planned(case["name"])
    _holds_what_every_plan_promises(plan)
    if "duration" in case:
        low, high = case["duration"]
        assert low <= plan.duration <= high
    assert 1e3 * plan.max_tcp_deviation <= case.get("deviation_mm", 0.1)
    if "axis_deg" in case:
        assert np.degrees(plan.max_tool_axis_deviation) <= case["axis_deg"]
    for name, least in case.get("margin", {}).items():
        assert (
            plan.singularity_margin[name] >= least
            if name != "elbow"
            else plan.singularity_margin[name] > 0
        )
    if "wrist" in case:
        assert [p["taken"] for p in plan.passages] == [case["wrist"]]
        assert {"damped least squares"} & {r["remedy"] for r in plan.remedies}


def _holds_what_every_plan_promises(plan: Plan) -> None:
    trajectory = plan.trajectory
    limits = plan.certificate.limits
    assert plan.guaranteed
    assert check(plan.certificate, MODEL).holds()
    assert (trajectory.qd[[0, -1]] == 0).all()
    assert (trajectory.q >= ROBOT.q_min).all()
    assert (trajectory.q <= ROBOT.q_max).all()
    assert (np.abs(trajectory.qd) <= limits.qd_max * (1 + 1e-9)).all()
    # what the controller reads between the rows, ten thousand times a second, is inside, too
    read = np.arange(0.0, trajectory.time[-1], 1e-4)
    needed = np.abs(MODEL.inverse_dynamics(*plan.reference.states(read)))
    assert (needed <= limits.tau_max).all()
    assert (needed / ROBOT.tau_max).max() <= plan.max_torque_ratio
    # sampled ten thousand times a second the torque never exceeds its limit
    time = np.arange(0.0, plan.duration, 1e-4)
    _, q, qd, qdd = plan.certificate.law.motion(plan.certificate.path, time)
    ratio = np.abs(MODEL.inverse_dynamics(q, qd, qdd)) / limits.tau_max
    assert ratio.max() <= 1.0
    # the margins are bounds over the whole path
    factors = np.abs(MODEL.singularity_factors(q)).min(axis=0)
    assert (factors >= np.array(list(plan.singularity_margin.values())) - 1e-9).all()


@pytest.mark.parametrize("name", ["closed circle", "zigzag of tight "
                                                   "corners", "corner with tiny segments in it",
                                  "repeated points", "turning on the spot", "freeform raster",
                                  "missing the wrist by 0.01 deg"])  # fmt: skip
def test_deviation_is_an_upper_bound_and_sharp(name: str) -> None:
    plan = planned(name)
    position, axis = looked_at(plan)
    assert position <= plan.max_tcp_deviation + 1e-12
    assert axis <= plan.max_tool_axis_deviation + 1e-12
    # the way-points' distance from the motion counts, too: look at the motion finely
    places = plan.reference.places
    fine = TcpPath(MODEL, places, SPINDLE).pose(np.linspace(0, places.length, 40_001))[0]
    corner = max(np.linalg.norm(fine - p, axis=1).min() for p in plan.path.position)
    assert plan.max_tcp_deviation <= 1.01 * max(position, corner) + 2e-7
    assert plan.max_tool_axis_deviation <= 1.02 * axis + 2e-5


def looked_at(plan: Plan) -> tuple[float, float]:
    """Distance from the polygon and angle at its nearest place, 20,000 looks over all its sides."""
    path = plan.reference.places
    tip = TcpPath(MODEL, path, SPINDLE)
    s = np.linspace(path.knots[0], path.knots[-1], 20_001)
    p, axis = tip.pose(s)
    stated = plan.path.tool_axis(SPINDLE)
    nearest = np.full(len(s), np.inf)
    angle = np.zeros(len(s))
    gap = np.full(len(s), np.inf)
    both = np.hstack([p, ROTATION_LENGTH * axis])
    corner = np.hstack([plan.path.position, ROTATION_LENGTH * stated])
    for k in range(len(corner) - 1):
        nearest = np.minimum(nearest, _foot(p, corner[k, :3], corner[k + 1, :3])[0])
        d, t = _foot(both, corner[k], corner[k + 1])
        line = stated[k] + t[:, None] * (stated[k + 1] - stated[k])
        line /= np.linalg.norm(line, axis=1, keepdims=True)
        turned = 2 * np.arcsin(np.minimum(np.linalg.norm(line - axis, axis=1) / 2, 1))
        angle = np.where(d < gap, turned, angle)
        gap = np.minimum(d, gap)
    return float(nearest.max()), float(angle.max())


def _foot(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    side = b - a
    t = np.clip((p - a) @ side / max(side @ side, 1e-30), 0, 1)
    return np.linalg.norm(p - a - t[:, None] * side, axis=1), t


def test_a_path_through_the_shoulder_is_refused_after_few_looks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks = 0
    solve = Model.inverse_kinematics_branches

    def counted(model: Model, X: Any, seed: Any = None) -> Any:
        nonlocal looks
        looks += len(X)
        return solve(model, X, seed)

    monkeypatch.setattr(Model, "inverse_kinematics_branches", counted)
    path = build(MODEL, kind="poses_through_shoulder")
    with pytest.raises(
        errors.UnreachableError, match=r"near point 11 axis 1 turns by 90.0 deg within 0\.\d+ um"
    ):
        plan_path(ROBOT, path, free_tool_rotation=False)
    # new stations all along the path, as a spline through a jump asks for them, took 3,800,000
    assert looks < 10_000
    # a near miss is no jump: driven slowly
    beside = np.eye(4)
    beside[0, 3] = 1e-5
    plan = plan_path(ROBOT, path, free_tool_rotation=False, work_frame=beside)
    assert plan.guaranteed
    assert 9e-6 < plan.singularity_margin["shoulder"] < 1.1e-5
