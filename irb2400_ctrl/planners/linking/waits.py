"""A program that waits in the middle of an operation: the run is cut there, and the arm stands."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, rotation_onto
from irb2400_ctrl.cell import Rail
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance.clearance import unknown
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.external_bounds import turn
from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.plan_path import plan_ways
from irb2400_ctrl.planners.redundancy.known_way import known_way
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

# of the timing of each part
_CELLS = 1000


@dataclass(frozen=True)
class Rest:
    """The arm stands, and its brakes may hold it: a piece of a motion without motion."""

    robot: Robot
    trajectory: Trajectory
    max_torque_ratio: float
    """what holds the arm against gravity, as a part of the robot's own limit"""
    clearance: dict[str, Any] = field(default_factory=lambda: unknown("the arm stands"))
    guaranteed: bool = True
    guarantee_note: str = ""
    max_velocity_ratio: float = 0.0
    max_acceleration_ratio: float | None = None
    length: float = 0.0

    @classmethod
    def at(cls, run: Run, q: Array, seconds: float, rate: float) -> Rest:
        """For so long [s], rounded up to whole rows, at a configuration (n,) [rad] where the run
        has ended."""
        robot = run.plan.robot
        count = max(int(np.ceil(seconds * rate - 1e-9)), 1) + 1
        still = np.zeros((count, robot.n))
        held = path_dynamics(robot).torque(q[None], 0 * q[None], 0 * q[None], np.zeros(1))[0]
        trajectory = Trajectory(
            np.arange(count) / rate,
            np.tile(q, (count, 1)),
            still,
            still.copy(),
            np.tile(held, (count, 1)),
            np.zeros(count),
            check_speeds=False,
        )
        ratio = float(np.abs(held / robot.tau_max).max())
        return cls(robot, trajectory, ratio, run.plan.clearance, ratio <= run.plan.torque_share)

    @classmethod
    def turning(
        cls,
        run: Run,
        q: Array,
        ends: tuple[tuple[float, float], tuple[float, float]],
        rate: float,
    ) -> Rest:
        """While the positioner of a run's cell turns from rest to rest between two angles (tilt,
        turn) [deg], within its limits."""
        assert run.options.cell is not None
        assert run.options.cell.positioner is not None
        axes = run.options.cell.positioner.moving
        turned = turn(axes, np.radians(ends[0]), np.radians(ends[1]), rate)
        return cls._while(run, q, turned, rate)

    @classmethod
    def going(cls, run: Run, q: Array, ends: tuple[float, float], most: float, rate: float) -> Rest:
        """While the carriage under the arm goes from rest to rest between two places [m], within
        its limits and `most`, the acceleration that the arm holds [m/s2]."""
        assert run.options.cell is not None
        assert run.options.cell.rail is not None
        axes = run.options.cell.rail.moving
        gentle = replace(axes, acceleration=np.minimum(axes.acceleration, most))
        gone = turn(gentle, np.array(ends[:1]), np.array(ends[1:]), rate)
        found = cls._while(run, q, gone, rate)
        robot = run.plan.robot
        dynamics = path_dynamics(robot, 1, axes.carriage)
        rows = found.trajectory.together()
        tau = dynamics.torque(rows.q, rows.qd, rows.qdd, rows.time)[:, : robot.n]
        # linear in the acceleration, which is between its limits all the time
        hard = np.zeros((2, robot.n + 1))
        hard[:, -1] = gentle.acceleration * [1, -1]
        at = np.tile(rows.q[0], (2, 1))
        worst = dynamics.torque(at, 0 * hard, hard, np.zeros(2))[:, : robot.n]
        ratio = float(np.abs(worst / robot.tau_max).max())
        return replace(
            found,
            trajectory=replace(found.trajectory, tau=tau, check_speeds=False),
            max_torque_ratio=ratio,
            guaranteed=ratio <= run.plan.torque_share * (1 + 1e-9),
        )

    @classmethod
    def _while(cls, run: Run, q: Array, moved: Trajectory, rate: float) -> Rest:
        """While axes beside the arm move."""
        found = cls.at(run, q, moved.duration, rate)
        still = found.trajectory
        moved = replace(moved, time=still.time, check_speeds=False)
        return replace(found, trajectory=replace(still, external=moved, check_speeds=False))


def carriage_acceleration(run: Run, rail: Rail, q: Array) -> float:
    """How hard the carriage under an arm that stands at q (n,) [rad] may accelerate, so that no
    joint needs more than its torque to stay [m/s2].

    A base that accelerates by a is, for an arm that stands on it, gravity g - a: its torque is
    linear in that.
    """
    robot = run.plan.robot
    along = np.array(rail.direction) / np.linalg.norm(rail.direction)
    pulled = tuple(float(v) for v in np.array(robot.gravity_m_s2) - along)
    leaning = robot.model_copy(update={"gravity_m_s2": pulled})
    held, pushed = (
        path_dynamics(arm).torque(q[None], 0 * q[None], 0 * q[None], np.zeros(1))[0]
        for arm in (robot, leaning)
    )
    left = run.plan.torque_share * robot.tau_max - np.abs(held)
    return max(float((left / np.maximum(np.abs(pushed - held), 1e-9)).min()), 0.0)


def waits(operation: Operation) -> dict[int, float]:
    """Seconds that an operation waits at its way-points, behind the first one."""
    found: dict[int, float] = {}
    for event in operation.events:
        if event.seconds > 0 and event.point > 0:
            found[event.point] = found.get(event.point, 0.0) + event.seconds
    return found


def waiting(run: Run, tolerance: float) -> tuple[Run, ...]:
    """A run cut at the way-points where its operation waits, each part with the tool rotations of
    the whole; the run itself where it does not wait.

    Args:
        tolerance: how far corners of the parts may be cut [m].

    Raises:
        UnreachableError: a part cannot be followed with these rotations.
    """
    asked = waits(run.operation)
    cuts = [k for k, point in enumerate(run.points) if k > 0 and int(point) in asked]
    ends = sorted({*cuts, len(run.points) - 1})
    if not cuts:
        return (run,)
    if ends == cuts[-1:]:
        return (replace(run, wait=asked[int(run.points[-1])]),)
    path = _turned(run)
    q = run.plan.trajectory.q[0]
    parts = []
    for first, last in zip([0, *ends[:-1]], ends, strict=True):
        part = _part(run, path, first, last, q, tolerance)
        parts.append(replace(part, wait=asked.get(int(run.points[last]), 0.0)))
        q = part.plan.trajectory.q[-1]
    return tuple(parts)


def _part(run: Run, path: ToolPath, first: int, last: int, q: Array, tolerance: float) -> Run:
    """Between two way-points of a run, from the configuration q (n,) [rad]."""
    rows = slice(first, last + 1)
    plan = plan_ways(
        run.arm,
        path.part(rows),
        lambda model, orientation, scene: [known_way(model, orientation, q, "first", scene)],
        replace(run.options, tolerance=tolerance),
        replace(run.timing, cells=_CELLS),
    )
    return replace(run, plan=plan, points=run.points[rows])


def _turned(run: Run) -> ToolPath:
    """The path with full orientations: those that the whole plan has at its way-points, the tool
    axes exactly the stated ones."""
    plan = run.plan
    path = plan.path
    if path.rotation is not None and plan.chosen == "given orientation":
        return path
    law = plan.certificate.law
    q = law.motion(plan.certificate.path, plan.point_times)[1]
    q[0] = plan.trajectory.q[0]
    R = Model(plan.robot).tcp_pose(q)[:, :3, :3]
    spindle = plan.robot.spindle_axis
    stated = path.tool_axis(spindle)
    pairs = zip(R, stated, strict=True)
    exact = np.array([rotation_onto(-r @ spindle, axis) @ r for r, axis in pairs])
    exact[0] = R[0]
    return ToolPath(path.position, None, exact, path.feed, path.name)
