"""`link_operations`: planned operations become one motion, with everything that leads to, between
and away from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_box import can_hold, inside_box
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.joint_plan import JointPlan, plan_joints
from irb2400_ctrl.planners.linking.line_plan import lead_in, retract
from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.program_events import at_rest, on_the_way
from irb2400_ctrl.planners.linking.program_motion import ProgramMotion
from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.linking.segment import Kind, Segment, TimedEvent
from irb2400_ctrl.planners.linking.waits import Rest, carriage_acceleration
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.robot import Robot

# joints that differ less than this are at the same place [rad]
_SAME = 1e-9


def link_operations(
    name: str,
    runs: Sequence[Run],
    plane: ClearancePlane,
    links: LinkOptions,
) -> ProgramMotion:
    """One motion through all runs, in their order.

    Args:
        name: of the program.
        runs: with their plans; limits and back-end of the moves between are those of the plans.
        plane: above all that is cut.
        links: heights and ends.

    Raises:
        UnreachableError: a line to the clearance plane, or a move above it, is out of reach.
        InputError: `links.start` is no configuration of the arm.
    """
    rate = runs[0].options.rate
    home = start_of(runs[0].plan.robot, links.start)
    along = any((run.plan.carried_names or ("",))[0] == "rail" for run in runs)
    start = home if links.ends else None
    chain = _Chain(plane, links, rate, home, along, start)
    before: Run | None = None
    for k, run in enumerate(runs):
        last = k == len(runs) - 1
        if not (before is not None and goes_on(before, run)):
            chain.reach(run, before, lead=links.ends or before is not None)
        chain.follow(run)
        goes = not last and goes_on(run, runs[k + 1])
        if not goes and (not last or links.ends):
            chain.leave(run)
        before = run
    chain.events += at_rest(runs[-1].operation, None, chain.time)
    if start is not None:
        chain.joints("return", runs[-1].beside("last"), start)
    return ProgramMotion(name, tuple(chain.segments), tuple(chain.events), plane, links, rate)


def goes_on(before: Run, after: Run) -> bool:
    """Whether a run goes on where the one before it has ended, without lifting the tool."""
    same = before.operation is after.operation
    return same and before.wait > 0 and int(before.points[-1]) == int(after.points[0])


def start_of(robot: Robot, start: Array | None) -> Array:
    """The configuration to come from [rad], shape (n,).

    Raises:
        InputError: of another length, outside the joint box, or too heavy to hold.
    """
    if start is None:
        zero = np.zeros(robot.n)
        middle = (robot.q_min + robot.q_max) / 2
        outside = (zero < robot.q_min) | (zero > robot.q_max)
        return np.where(outside, middle, zero)
    q = check_start(robot, start)
    can_hold(Model(robot), "start", q)
    return q


def check_start(robot: Robot, start: Array) -> Array:
    """The configuration to come from, if the arm has it, whatever it holds.

    Raises:
        InputError: of another length, or outside the joint box.
    """
    q = np.asarray(start, dtype=float)
    if q.shape != (robot.n,) or not np.isfinite(q).all():
        raise InputError(f"start: found {q.size} angles, expected {robot.n} finite ones")
    inside_box(Model(robot), "start", q)
    return q


@dataclass
class _Chain:
    """Segments and events so far."""

    plane: ClearancePlane
    links: LinkOptions
    rate: float
    home: Array
    """where the arm stands while the positioner turns"""
    along: bool
    """whether the rows say where the carriage is, because it moves in some run"""
    here: Array | None
    """configuration at the end [rad]; None before the first segment"""
    segments: list[Segment] = field(default_factory=list)
    events: list[TimedEvent] = field(default_factory=list)
    rows: int = 0
    """of the trajectory so far, its first one apart"""

    @property
    def time(self) -> float:
        """[s]"""
        return self.rows / self.rate

    def reach(self, run: Run, before: Run | None, *, lead: bool) -> None:
        """To the first way-point of a run; what happens at rest before it happens here."""
        q = run.plan.trajectory.q[0]
        new = before is None or before.operation is not run.operation
        if new:
            ended = None if before is None else before.operation
            self.events += at_rest(ended, run.operation, self.time)
            self._go_along(run, before)
            self._turn_part(run, before)
        if not lead:
            return
        out = self._way_out(run, q)
        line = None
        if len(out) > 1:
            line = lead_in(run.beside("first"), q, out, self.links.approach)
        kind: Kind = "approach" if before is None else "link" if new else "unwind"
        here = run.beside("first")
        self.joints(kind, here, q if line is None else line.trajectory.q[0])
        if line is not None:
            self._add("lead-in", here, line)

    def follow(self, run: Run) -> None:
        """The run itself, and what happens on its way."""
        self.events += on_the_way(run, self.time)
        self._add("operation", run, run.plan)
        if run.wait > 0:
            rest = Rest.at(run, run.plan.trajectory.q[-1], run.wait, self.rate)
            self._add("wait", run.beside("last"), rest, f"the program waits for {run.wait:g} s")

    def leave(self, run: Run) -> None:
        """From the last way-point of a run up to the plane."""
        q = run.plan.trajectory.q[-1]
        out = self._way_out(run, q)
        if len(out) > 1:
            here = run.beside("last")
            self._add("retract", here, retract(here, q, out))

    def joints(self, kind: Kind, run: Run, target: Array) -> None:
        """A move of the joints above the plane; none where they are there already."""
        if self.here is not None and np.abs(target - self.here).max() > _SAME:
            move = plan_joints(run.plan.robot, self.here, target, self.plane, run.timing, run.scene)
            note = _turned(run, self.here, target) if kind == "unwind" else ""
            self._add(kind, run, move, note)

    def _go_along(self, run: Run, before: Run | None) -> None:
        """The carriage of a rail goes where a run wants it, the arm away at home."""
        rail = None if run.options.cell is None else run.options.cell.rail
        if rail is None or before is None:
            return
        start = before.carriage("last")
        end = run.carriage("first")
        if start is None or end is None or start == end:
            return
        self.joints("link", before.beside("last"), self.home)
        most = carriage_acceleration(run, rail, self.home)
        text = f"carriage to {1e3 * end:g} mm, with at most {most:.1f} m/s2"
        line = int(run.operation.line[0])
        self.events.append(TimedEvent("rail", text, line, run.operation.number, self.time, True))
        if self.along:
            piece = Rest.going(run, self.home, (start, end), most, self.rate)
            self._add("turn", before.beside("last"), piece, f"carriage to {1e3 * end:.1f} mm")

    def _turn_part(self, run: Run, before: Run | None) -> None:
        """The positioner turns to the angles of a run, the arm away at home."""
        angles = run.stands("first")
        stood = None if before is None else before.stands("last")
        if angles is None or angles == stood:
            return
        if before is not None:
            self.joints("link", before.beside("last"), self.home)
        text = f"tilt {angles[0]:g} deg, turn {angles[1]:g} deg"
        line = int(run.operation.line[0])
        number = run.operation.number
        self.events.append(TimedEvent("positioner", text, line, number, self.time, True))
        if stood is not None and before is not None and (run.turning or before.turning):
            piece = Rest.turning(before, self.home, (stood, angles), self.rate)
            self._add("turn", before.beside("last"), piece)

    def _way_out(self, run: Run, q: Array) -> Array:
        X = Model(run.plan.robot).tcp_pose(q)
        axis = -X[:3, :3] @ run.plan.robot.spindle_axis
        return self.plane.way_out(X[:3, 3], axis, self.links.approach)

    def _add(self, kind: Kind, run: Run, piece: Plan | JointPlan | Rest, note: str = "") -> None:
        because = run.because if kind == "unwind" else ""
        number = run.operation.number
        angles = run.options.positioner or run.stands("first")
        place = run.options.rail if run.options.rail is not None else run.carriage("first")
        stands = (angles, place)
        self.segments.append(Segment(kind, number, piece, self.time, note, *stands, because))
        self.here = piece.trajectory.q[-1]
        self.rows += len(piece.trajectory.time) - 1


def _turned(run: Run, before: Array, after: Array) -> str:
    """Where the tool was lifted, and which axes were turned by more than a quarter."""
    change = np.degrees(after - before)
    told = [
        f"axis {j + 1} from {np.degrees(before[j]):.0f} to {np.degrees(after[j]):.0f} deg"
        for j in np.flatnonzero(np.abs(change) > 90.0)
    ]
    return f"lifted at point {run.start + 1} to turn {', '.join(told) or 'the joints'}"
