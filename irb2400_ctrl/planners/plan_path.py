"""`plan_path`: from a tool path to a timed trajectory."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.deviation import deviation, singularity_margins
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.redundancy import wrist_remedies as remedies
from irb2400_ctrl.planners.redundancy.choices import Choice, choices
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE
from irb2400_ctrl.planners.timing.certificate import Certificate, Checked, check
from irb2400_ctrl.planners.timing.feed import feed_bound, feed_ratio
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.sampled_check import SAMPLED_NOTE
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import rates_of, time_rate_limited
from irb2400_ctrl.planners.timing.sampled_timing import guarantee_note, time_with_samples
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.time_optimal import Timed
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import smooth_curve
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

Array = npt.NDArray[np.float64]
Progress = Callable[[str], None]
Backend = Literal["certified", "toppra"]


@dataclass
class _Clock:
    progress: Progress | None
    seconds: dict[str, float] = field(default_factory=dict)

    def within(self, name: str, done: str) -> None:
        """Tell how far a long stage is."""
        if self.progress is not None:
            self.progress(f"{name}: {done}")

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        if self.progress is not None:
            self.progress(name)
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start


def plan_path(
    robot: Robot,
    path: ToolPath,
    *,
    rate: float = 250.0,
    free_tool_rotation: bool = True,
    work_frame: Array | None = None,
    tolerance: float = 5e-5,
    axis_tolerance: float = np.radians(0.1),
    timing: Backend = "certified",
    cells: int = 1000,
    limits: MotionLimits | None = None,
    torque_rate: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    progress: Progress | None = None,
) -> Plan:
    """The fastest motion along a tool path, rest to rest, clear of singularities and within the
    limits.

    Args:
        robot: the arm, tool and effects included.
        path: way-points of the TCP in the robot base, or in `work_frame`.
        rate: rows of the trajectory per second [1/s].
        free_tool_rotation: choose the rotation about the spindle along the path; otherwise a stated
            orientation is held, and for a path of tool axes the best constant rotation is taken.
        work_frame: pose X_BW of the frame the path is stated in, shape (4, 4).
        tolerance: how far corners of the polygon may be cut [m].
        axis_tolerance: how far a stated orientation may be left to pass exactly through the wrist
            singularity [rad].
        timing: "certified" (torque bound at every instant) or "toppra".
        cells: smallest number of grid cells of the timing.
        limits: other limits than the robot's.
        torque_rate: limit of the change of the torque, dry friction apart, for all axes or for each
            [Nm/s]. The torque then starts and ends at what holds the arm.
        jerk: limit of the change of the joints' acceleration, for all axes or for each [rad/s3].
        progress: called with the name of each stage as it begins, and within long ones with how far
            they are.

    Raises:
        InputError: an argument or the path itself is wrong.
        UnreachableError: no configuration or no continuous motion; says at which point.
        InfeasibleError: the torque limits leave no motion; says where.
    """
    if not np.isfinite(rate) or rate <= 0:
        raise InputError(f"rate: found {rate}, expected a positive number of rows per second")
    if not np.isfinite(tolerance) or tolerance <= 0:
        raise InputError(f"tolerance: found {tolerance} m, expected a positive length")
    if timing not in {"certified", "toppra"}:
        raise InputError(f"timing: found {timing!r}, expected 'certified' or 'toppra'")
    clock = _Clock(progress)
    limits = (MotionLimits.of(robot) if limits is None else limits).with_rates(torque_rate, jerk)
    if limits.smooth and timing != "certified":
        raise InputError(
            f"timing: found {timing!r} with a limit of torque rate or jerk, expected 'certified'"
        )
    with clock.stage("model"):
        dynamics = path_dynamics(robot)
        model = dynamics.model
        spindle = np.array((0.0, 0.0, 1.0) if robot.tool is None else robot.tool.spindle_axis)
    with clock.stage("curve"):
        placed = path if work_frame is None else path.moved(work_frame)
        orientation = Orientation.of(smooth_curve(placed, tolerance), spindle)
    with clock.stage("branch and rotation"):
        found = []
        for choice in choices(model, orientation, free_tool_rotation):
            found.append(choice)
            clock.within("branch and rotation", f"{len(found)} way{'s' * (len(found) > 1)}")
    with clock.stage("timing"):
        options: list[tuple[Choice, Timed]] = []
        problem: InfeasibleError | None = None
        for number, choice in enumerate(found):
            clock.within("timing", f"{100 * number / len(found):.0f} %")
            try:
                options.append(
                    (choice, _timed(model, dynamics, choice, orientation, limits, cells, timing))
                )
            except InfeasiblePointError as error:
                way = TcpPath(model, choice.followed.joints, orientation.spindle).way(error.s)
                problem = InfeasiblePointError(float(way), error.reason)
            except InfeasibleError as error:
                problem = error
        if not options:
            raise problem or InfeasibleError("no motion within the limits")
    allowed = [o for o in options if o[0].turn <= axis_tolerance] or options
    choice, timed = min(allowed, key=lambda o: _rank(*o))
    law: TimeLaw | RateLimitedLaw = timed.law
    if limits.smooth:
        with clock.stage("smooth timing"):
            choice, timed, law = _smoothed(dynamics, allowed, orientation, limits, cells)
    with clock.stage("check"):
        certificate = Certificate(choice.followed.joints, law, limits)
        checked = check(certificate, model, dynamics)
        rated = bool(np.isfinite(checked.torque_rate_ratio)) or not np.isfinite(
            checked.torque_ratio
        )
        margins = singularity_margins(model, choice.followed)
        off = deviation(model, orientation, choice.followed)
    with clock.stage("remedies"):
        priced = _remedies(dynamics, options, choice, orientation, limits, axis_tolerance, cells)
    with clock.stage("trajectory"):
        tip = TcpPath(model, choice.followed.joints, orientation.spindle)
        trajectory, s = _trajectory(dynamics, certificate, tip, rate)
        torque_ratio, velocity_ratio = _ratios(dynamics, certificate, checked)
    return Plan(
        robot=robot,
        path=placed,
        trajectory=trajectory,
        length=float(tip.lengths[-1]),
        certificate=certificate,
        duration=law.duration,
        guaranteed=timing == "certified" and checked.holds(),
        guarantee_note=guarantee_note(dynamics, timing == "certified", checked.holds())
        if rated
        else SAMPLED_NOTE,
        rates=rates_of(certificate, dynamics, timed.law) if limits.smooth else {},
        timing=timing,
        max_tcp_deviation=off.largest,
        max_tool_axis_deviation=off.axis,
        singularity_margin=margins,
        max_torque_ratio=torque_ratio,
        max_velocity_ratio=velocity_ratio,
        max_feed_ratio=feed_ratio(feed_bound(model, choice.followed, orientation), law),
        chosen=choice.kind,
        branch=choice.branch,
        rotation=choice.rotation(s),
        alternatives=tuple(
            {
                "kind": c.kind,
                "branch": c.branch,
                "relative_margin": float(c.margins.min()),
                "turn_deg": float(np.degrees(c.turn)),
                "duration_s": t.law.duration,
            }
            for c, t in options
        ),
        passages=tuple(
            {**p, "at_mm": 1e3 * float(tip.way(p["at_mm"] / 1e3))} for p in remedies.taken(choice)
        ),
        remedies=tuple(r.summary() for r in priced),
        wall_time=clock.seconds,
    )


def _rank(choice: Choice, timed: Timed) -> tuple[float, float]:
    """Larger margin first as long as it is not comfortable, then the shorter duration."""
    return (-round(min(choice.margin, COMFORTABLE), 2), timed.law.duration)


def _smoothed(
    dynamics: PathDynamics,
    options: list[tuple[Choice, Timed]],
    orientation: Orientation,
    limits: MotionLimits,
    cells: int,
) -> tuple[Choice, Timed, RateLimitedLaw]:
    """The best option that has a motion with limits of the rates, too.

    Raises:
        InfeasibleError: none has one; says where.
    """
    problem: InfeasibleError | None = None
    for choice, timed in sorted(options, key=lambda o: _rank(*o)):
        feed = feed_bound(dynamics.model, choice.followed, orientation)
        try:
            law = time_rate_limited(
                dynamics, choice.followed.joints, limits, count=max(cells // 2, 50), feed=feed
            ).law
            return choice, timed, law
        except InfeasiblePointError as error:
            way = TcpPath(dynamics.model, choice.followed.joints, orientation.spindle).way(error.s)
            problem = InfeasiblePointError(float(way), error.reason)
    raise problem or InfeasibleError("no motion within the limits")


def _remedies(
    dynamics: PathDynamics,
    options: list[tuple[Choice, Timed]],
    chosen: Choice,
    orientation: Orientation,
    limits: MotionLimits,
    tolerance: float,
    cells: int,
) -> list[remedies.Remedy]:
    """The cheapest of each kind of remedy, for a path that comes close to the wrist singularity."""
    model = dynamics.model
    if chosen.passing is None or not chosen.passing.passages:
        return []
    best: dict[str, remedies.Remedy] = {}
    for choice, timed in options:
        remedy = remedies.of_choice(choice, timed.law.duration, tolerance)
        if remedy is not None and (
            remedy.name not in best or remedy.duration < best[remedy.name].duration
        ):
            best[remedy.name] = remedy
    for choice, angle in remedies.turned_about_axis(model, orientation):
        feed = feed_bound(model, choice.followed, orientation)
        with suppress(InfeasibleError):
            timed, _ = time_joint_path(
                dynamics, choice.followed.joints, limits, count=cells, feed=feed
            )
            name = f"turn the tool about its axis ({choice.kind})"
            best[name] = remedies.Remedy(
                name, timed.law.duration, choice.followed.error, angle, False
            )
    with suppress(InfeasibleError):
        damped = remedies.damped(model, orientation, chosen.followed)
        feed = feed_bound(model, damped, orientation)
        timed, _ = time_joint_path(dynamics, damped.joints, limits, count=cells, feed=feed)
        name = "damped least squares"
        best[name] = remedies.Remedy(
            name, timed.law.duration, damped.error, damped.axis_error, False
        )
    return sorted(best.values(), key=lambda r: r.duration)


def _timed(
    model: Model,
    dynamics: PathDynamics,
    choice: Choice,
    orientation: Orientation,
    limits: MotionLimits,
    count: int,
    timing: Backend,
) -> Timed:
    joints = choice.followed.joints
    feed = feed_bound(model, choice.followed, orientation)
    if timing == "toppra":
        from irb2400_ctrl.planners.timing.toppra_timing import time_with_toppra

        s = grid(joints, count)
        return time_with_toppra(enclose(dynamics, joints, s), limits, model.robot.friction, feed(s))
    if dynamics.irregular:
        s = grid(joints, count)
        return time_with_samples(
            dynamics, joints, enclose(dynamics, joints, s), limits, model.robot.friction, feed(s)
        )
    return time_joint_path(dynamics, joints, limits, count=count, feed=feed)[0]


def _trajectory(
    dynamics: PathDynamics, certificate: Certificate, tip: TcpPath, rate: float
) -> tuple[Trajectory, Array]:
    """Rows at k / rate up to the first one at or after the end, and where on the joint path they
    are."""
    rows = int(np.ceil(certificate.law.duration * rate - 1e-9)) + 1
    if rows > 20_000_000:
        raise InputError(f"rate: {rate} rows per second make {rows} rows; expected a lower rate")
    t = np.arange(rows) / rate
    s, q, qd, qdd = certificate.law.motion(certificate.path, t)
    tau = dynamics.torque(q, qd, qdd, t)
    return Trajectory(t, q, qd, qdd, tau, tip.way(s), check_speeds=False), s


def _ratios(
    dynamics: PathDynamics, certificate: Certificate, checked: Checked
) -> tuple[float, float]:
    """Largest torque and speed ratios: the bound over all times, or, where there is none, 10,000
    looks per second."""
    if np.isfinite(checked.torque_ratio):
        return checked.torque_ratio, checked.velocity_ratio
    duration = certificate.law.duration
    worst = 0.0
    for first in np.arange(0.0, duration, 10.0):
        t = np.arange(first, min(first + 10.0, duration), 1e-4)
        _, q, qd, qdd = certificate.law.motion(certificate.path, t)
        tau = dynamics.torque(q, qd, qdd, t)
        worst = max(worst, float((np.abs(tau) / certificate.limits.tau_max).max()))
    return worst, checked.velocity_ratio
