"""RAPID modules of what the planner makes: a plan of one operation, or a whole program's motion."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.linking.program_events import at_rest
from irb2400_ctrl.planners.linking.program_motion import ProgramMotion
from irb2400_ctrl.planners.linking.segment import TimedEvent
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.programs.rapid.rapid_feeds import feeds_of_rows, rows_that_stop
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_program import RapidProgram, rapid_program
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.typed import typed

JOINT_MOVES = frozenset({"approach", "link", "unwind", "return", "turn"})
"""segments in which the joints move, not the tool on a line"""


@typed
def rapid_of_plan(
    plan: Plan,
    operation: Operation | None = None,
    options: RapidOptions | None = None,
    *,
    X_BW: Array | None = None,
) -> RapidProgram:
    """The module of one plan, with its operation's events where that is given.

    Raises:
        InputError: as `rapid_program`.
    """
    events = [] if operation is None else _events(plan, operation)
    model = Model(plan.robot)
    moving = plan.trajectory.external
    stands = () if plan.positioner is None else plan.positioner
    if moving is not None and stands:
        raise _one_of_two()
    return rapid_program(
        model,
        plan.trajectory,
        options=options,
        X_BW=X_BW,
        stops=rows_that_stop(plan),
        feeds=feeds_of_rows(plan),
        events=events,
        external=stands if moving is None else moving.shown,
        carried=plan.carried,
        rail=None if moving is not None and moving.lengths else plan.rail,
    )


@typed
def rapid_of_motion(
    motion: ProgramMotion, options: RapidOptions | None = None, *, X_BW: Array | None = None
) -> RapidProgram:
    """The module of a whole program: MoveL where the tool follows a path, MoveAbsJ where the joints
    move, a stop point between segments, and the events in their places. A positioner that turns
    between operations is two external axes; the targets are then in the base (`X_BW` None). A
    carriage that moves is the first external axis; the base is then where it stands at zero.

    Raises:
        InputError: an approach is asked for that the motion has itself, or as `rapid_program`.
    """
    options = options or RapidOptions()
    kinds = [segment.kind for segment in motion.segments]
    if (options.approach_mm or options.retract_mm) and kinds[0] != "operation":
        raise InputError(
            "RAPID: found approach_mm or retract_mm for a motion that comes and goes by itself, "
            "expected one or the other; shape its links instead (--clearance, --approach)"
        )
    moving = motion.trajectory.external
    carriage = moving is not None and bool(moving.lengths)
    if not carriage and len({segment.rail for segment in motion.segments}) > 1:
        raise InputError(
            "RAPID: the carriage of the rail goes from operation to operation, which a module does "
            "not say; expected one place, or a module of each operation (--no-links)"
        )
    time = motion.trajectory.time
    joints = np.zeros(len(time), dtype=bool)
    stops = np.zeros(len(time), dtype=bool)
    feeds = np.full(len(time), np.inf)
    stands = [segment.positioner for segment in motion.segments]
    carried = _carried(motion)
    if carried is not None and len(carried) == carried.slides and stands[0] is not None:
        raise _one_of_two()
    external = np.zeros((len(time), 0 if stands[0] is None else 2))
    for segment in motion.segments:
        first, last = np.searchsorted(time, np.array([segment.start, segment.end]) - 1e-6)
        joints[first + 1 : last + 1] = segment.kind in JOINT_MOVES
        stops[last] = True
        if isinstance(segment.piece, Plan):
            own = feeds_of_rows(segment.piece)[1:]
            feeds[first + 1 : first + 1 + len(own)] = own
            turning = rows_that_stop(segment.piece)
            stops[first : first + len(turning)] |= turning
        if segment.positioner is not None and moving is None:
            external[first + (first > 0) :] = segment.positioner
    return rapid_program(
        Model(motion.segments[0].piece.robot),
        motion.trajectory,
        options=options,
        X_BW=X_BW,
        joint_rows=joints,
        stops=stops,
        feeds=feeds,
        events=_besides_waits(motion, options),
        external=external if moving is None else moving.shown,
        carried=carried,
        tools=_tools(motion, time),
        rail=None if carriage else motion.segments[0].rail,
    )


def _carried(motion: ProgramMotion) -> ExternalAxes | None:
    """The axes whose places the rows have.

    Raises:
        InputError: no operation moves all of them.
    """
    rows = motion.trajectory.external
    if rows is None:
        return None
    count = rows.q.shape[1]
    for plan in motion.plans:
        if plan.carried is not None and len(plan.carried) == count:
            return plan.carried
    raise InputError(
        "RAPID: found operations of which some move the carriage and others the positioner, "
        "expected one that moves both, or a module of each operation (--no-links)"
    )


def _one_of_two() -> InputError:
    return InputError(
        "RAPID: found a carriage that moves and a positioner that stands at stated angles, which a "
        'module does not say; expected that it moves, too (position_deg = "move"), or none'
    )


def _tools(motion: ProgramMotion, time: Array) -> list[tuple[int, Model]]:
    """Rows at which the tool changes, and the arm with the next one."""
    found = []
    known = motion.segments[0].piece.robot
    for segment in motion.segments[1:]:
        robot = segment.piece.robot
        if robot.tool != known.tool:
            known = robot
            found.append((int(np.searchsorted(time, segment.start - 1e-6)), Model(robot)))
    return found


def _besides_waits(motion: ProgramMotion, options: RapidOptions) -> list[TimedEvent]:
    """Events without the dwells during which the rows stand: their pause is written already."""
    if any(rule.event == "dwell" for rule in options.signals):
        return list(motion.events)
    starts = np.array([s.start for s in motion.segments if s.kind == "wait"])
    return [
        event
        for event in motion.events
        if event.kind != "dwell" or not (np.abs(starts - event.time) < 2 / motion.rate).any()
    ]


def _events(plan: Plan, operation: Operation) -> list[TimedEvent]:
    """Of an operation that is planned in one go, without links."""
    end = float(plan.trajectory.time[-1])
    waiting = at_rest(operation, None, end)
    told = {(event.kind, event.line) for event in waiting}
    on_the_way = [
        TimedEvent(
            event.kind,
            event.text,
            event.line,
            operation.number,
            min(float(plan.point_times[event.point]), end),
            at_rest=False,
        )
        for event in operation.events
        if event.point >= 0 and (event.kind, event.line) not in told
    ]
    return [*at_rest(None, operation, 0.0), *on_the_way, *waiting]
