"""`plan_path`: from a tool path to a timed trajectory, in five verbs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.cell import Cell, Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.certify import certify
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.margins_as_read import margins_as_read
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.plan_report import deflection, report
from irb2400_ctrl.planners.price_remedies import price_remedies
from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.choices import choices
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.rotation_map import rotation_map as rotations_seen
from irb2400_ctrl.planners.redundancy.way_out import WayOut
from irb2400_ctrl.planners.stage_clock import Progress, StageClock
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.path_timer import PathTimer
from irb2400_ctrl.planners.timing.time_choices import best_first, limit_rates, time_choices
from irb2400_ctrl.planners.timing.timing_options import Backend, TimingOptions
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

Ways = Callable[[Model, Orientation, Scene | None], Iterable[Choice]]
"""the joint paths that are compared for a tool path"""


@typed
@one_thread()
def plan_path(
    robot: Robot,
    path: ToolPath,
    *,
    rate: float = PlanOptions.rate,
    free_tool_rotation: bool = PlanOptions.free_tool_rotation,
    work_frame: Array | None = None,
    tolerance: float = PlanOptions.tolerance,
    axis_tolerance: float = PlanOptions.axis_tolerance,
    timing: Backend = PlanOptions.timing,
    cells: int = PlanOptions.cells,
    limits: MotionLimits | None = None,
    torque_rate: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    way_out: WayOut | None = None,
    cell: Cell | None = None,
    tool: str | None = None,
    torque_share: float = PlanOptions.torque_share,
    interpolation: str = PlanOptions.interpolation,
    load: CuttingLoad | None = None,
    rotation_map: bool = PlanOptions.rotation_map,
    progress: Progress | None = None,
) -> Plan:
    """The fastest motion along a tool path, rest to rest, clear of singularities.

    Args:
        robot: the arm, tool and effects included.
        path: way-points of the TCP in the robot base, or in `work_frame`.
        rate: rows of the trajectory per second [1/s].
        free_tool_rotation: choose the rotation about the spindle; else hold what is stated.
        work_frame: pose X_BW that the path is stated in, (4, 4); default the cell's work object.
        tolerance: how far corners of the polygon may be cut [m].
        axis_tolerance: how far a stated orientation may be left at the wrist singularity [rad].
        timing: "certified" (torque bound at every instant) or "toppra".
        cells: smallest number of grid cells of the timing.
        limits: other limits than the robot's.
        torque_rate: of the change of torque [Nm/s]; None is what rows can follow, inf is no limit.
        jerk: limit of the change of the joints' acceleration [rad/s3].
        cell: what must not be touched; the arm itself is looked at if it has an outline.
        way_out: lines from the ends of the path to reach along as well.
        tool: of the cell, by name; default what the robot file describes.
        torque_share: part of the torque limits that is used, 0.9 for 90 %.
        interpolation: how the controller reads the rows, "cubic" or "linear": `Interpolation`.
        load: a force on the tip: of the comfortable ways the one that gives way least is taken.
        rotation_map: whether to say what other tool rotations would bring.
        progress: called with each stage as it begins, and within long ones with how far they are.

    Raises:
        InputError: an argument or the path itself is wrong.
        UnreachableError: no continuous motion, or (CollisionError) none that touches nothing.
        InfeasibleError: the torque limits leave no motion; says where.
    """
    shape = (rate, free_tool_rotation, work_frame, tolerance, axis_tolerance)
    time = (timing, cells, limits, torque_rate, jerk)
    written = (torque_share, interpolation, load, rotation_map, progress)
    return plan_asked(robot, path, PlanOptions(*shape, *time, cell, tool, *written), way_out)


@one_thread()
def plan_asked(
    robot: Robot, path: ToolPath, options: PlanOptions, way_out: WayOut | None = None
) -> Plan:
    """`plan_path` of a request: the best of the most promising joint paths of every kind.

    Args:
        robot, path, way_out: as there.
        options: all that is asked for.

    Raises:
        InputError, UnreachableError, InfeasibleError: as `plan_path`.
    """
    options.check_axes()

    def ways(model: Model, orientation: Orientation, scene: Scene | None) -> Iterable[Choice]:
        free = options.free_tool_rotation
        return choices(model, orientation, free, scene=scene, way_out=way_out, load=options.load)

    return plan_ways(robot, path, ways, options, options.timed(robot))


def plan_ways(
    robot: Robot,
    path: ToolPath,
    ways: Ways,
    options: PlanOptions,
    timing: TimingOptions,
) -> Plan:
    """Shape the curve, time the ways to follow it, certify the best, report it.

    Raises:
        UnreachableError, InfeasibleError: as `plan_path`.
    """
    clock = StageClock(options.progress)
    with clock.stage("model"):
        external = options.external
        beside = () if external is None else (len(external), external.carriage)
        dynamics = path_dynamics(options.armed(robot), *beside)
        model = dynamics.model
        scene = Scene.of(model, robot, options.cell, options.in_spindle)
    with clock.stage("curve"):
        orientation = options.shaped(path, robot.spindle_axis, model)
    with clock.stage("branch and rotation") as told:
        found = list(_counted(ways(model, orientation, scene), told))
    with clock.stage("timing") as told:
        timer = PathTimer(dynamics, timing)
        timed = time_choices(timer, orientation, found, told)
        ranked = best_first(timed, options.axis_tolerance)
        best = ranked[0]
    if timing.limits.smooth:
        with clock.stage("smooth timing"):
            best = limit_rates(timer, ranked)
    with clock.stage("rows"):
        settled = timer.settled(best.path, best.law)
        best = replace(best, law=settled.law)
    with clock.stage("check"):
        bounds = certify(dynamics, orientation, best, settled, timing)
    with clock.stage("remedies"):
        remedies = price_remedies(timer, orientation, timed, best, options.axis_tolerance)
    with clock.stage("margins"):
        margins = margins_as_read(model, orientation, scene, best, settled)
        way_of = best.path.tcp.way
        seen = None
        if options.rotation_map:
            seen = rotations_seen(model, orientation, scene, best.choice, way_of)
    with clock.stage("trajectory"):
        rows = settled.reference
        planned = report(
            dynamics, orientation, timed, best, bounds, margins, remedies, timing, rows, clock
        )
    return replace(
        planned,
        rail=options.rail,
        positioner=options.positioner,
        carried=external,
        deflection=deflection(best, options.load),
        rotation_map=seen,
    )


def _counted(found: Iterable[Choice], told: Progress) -> Iterator[Choice]:
    """The choices, each told as it is found."""
    for count, choice in enumerate(found, start=1):
        yield choice
        told(f"{count} way{'s' * (count > 1)}")
