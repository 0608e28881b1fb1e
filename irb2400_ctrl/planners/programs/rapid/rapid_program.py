"""A RAPID module (ABB IRC5) from a planned motion: MoveAbsJ to the start, then MoveL or MoveAbsJ
along the plan.

RAPID states where to go, how fast and how closely; the controller makes its own timing from that.
Only EGM (`irb2400_ctrl.planners.programs.egm.egm_stream`) follows the plan's time law. See
docs/programs_out.md for what was checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_ends import with_ends
from irb2400_ctrl.planners.programs.rapid.rapid_module import module_texts
from irb2400_ctrl.planners.programs.rapid.rapid_module_names import Names
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_rows import (
    PlanRows,
    Rows,
    checked,
    checked_feeds,
    row_flags,
    speeds_between,
    wrist_rows,
)
from irb2400_ctrl.planners.programs.rapid.rapid_signals import EventWriter, ProgramEvent
from irb2400_ctrl.planners.programs.rapid.rapid_steps import program_steps
from irb2400_ctrl.planners.programs.rapid.rapid_thinning import rows_to_keep, thinned
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed


@dataclass(frozen=True)
class RapidProgram:
    """The text of a module and which samples of the plan became its targets."""

    text: str
    samples: npt.NDArray[np.int64] = field(repr=False)
    """rows of the plan that the targets stand for, first and last included, shape (m,); with an
    approach the plan begins at row `first`"""
    q: Array = field(repr=False, default_factory=lambda: np.empty((0, 6)))
    """actuator angles of the targets [rad], shape (m, 6)"""
    parts: Mapping[str, str] = field(default_factory=dict)
    """modules that the program loads in turn, by the names of their files"""
    first: int = 0
    """rows of the approach, before the plan"""
    not_written: tuple[str, ...] = ()
    """events for which no signal is named: the module shows them and does nothing"""

    def save(self, path: Path | str) -> Path:
        """Write the module (ASCII, file name ending .mod), and the parts beside it."""
        path = Path(path)
        if path.suffix.lower() not in {".mod", ".modx"}:
            raise InputError(f"RAPID module {path.name}: expected a file name ending in .mod")
        for name, text in self.parts.items():
            if name.lower() == path.name.lower():
                raise InputError(
                    f"RAPID module {path.name}: a part has the same name, expected another"
                )
            write_atomic(path.parent / name, text.encode("ascii"))
        return write_atomic(path, self.text.encode("ascii"))


@typed
def rapid_program(
    model: Model,
    motion: Trajectory | ArrayLike,
    q: ArrayLike | None = None,
    options: RapidOptions | None = None,
    *,
    X_BW: Array | None = None,
    wrist_crossing: npt.NDArray[np.bool_] | None = None,
    external: ArrayLike = (),
    joint_rows: npt.NDArray[np.bool_] | None = None,
    stops: npt.NDArray[np.bool_] | None = None,
    feeds: ArrayLike | None = None,
    events: Sequence[ProgramEvent] = (),
    tools: Sequence[tuple[int, Model]] = (),
    carried: ExternalAxes | None = None,
    rail: float | None = None,
) -> RapidProgram:
    """The module that moves along the plan.

    Args:
        model: the arm and its tool; options: how the module is written.
        motion: the plan; or only its times [s], shape (n,), increasing, and then
        q: its actuator angles [rad], shape (n, 6). q3 is absolute, as ABB counts axis 3 of it.
        X_BW: work object in the robot base, whose targets are written in it; default wobj0.
        wrist_crossing: rows where the path passes the wrist singularity, shape (n,): linear moves
            there run with `SingArea \\Wrist`; default where axis 5 changes sign.
        external: positions of external axes for the whole program, shape (k,), or at every row,
            shape (n, k), in the controller's unit [deg or mm].
        joint_rows: rows to which the joints move although the others are linear, shape (n,).
        stops: rows at which the plan is at rest, shape (n,): stop points.
        feeds: programmed feed of the way to each row [m/s], inf for none, (n,): moves keep it.
        events: what the program asks for besides motion, at times of the plan; the arm stops there.
        tools: rows at which the tool changes, increasing, and the arm with the next one.
        carried: axes that turn the work object, which `X_BW` states at zero, or carry the arm.
        rail: where its carriage stands all the time [m], which the head of the module says.

    Raises:
        InputError: arrays, names, events or an approach that cannot be; says which and why.
    """
    options = options or RapidOptions()
    time, q = checked(model, motion, q)
    at_events = _rows_of(events, time)
    flags = _Flags.of(q, wrist_crossing, joint_rows, stops, feeds)
    flags.standing[list(at_events)] = True
    models = [model, *(arm for _, arm in tools)]
    part = _Part.of(carried, external, options, len(q))
    X_BW = np.eye(4) if part is not None and X_BW is None else X_BW
    rows, first, samples = _rows(models, tools, (time, q), flags, options, X_BW, part)
    writer = EventWriter(options.signals)
    said = _said(writer, at_events, first)
    names = _names(options, models, X_BW is not None)
    configuration = data.configuration(model, rows.q[samples])
    extax = _external_axes(external, len(q), first, len(rows.q))
    about = (names, said, writer.at_end(), part is not None)
    plate = part is not None and part.turns
    steps = program_steps(rows, samples, configuration, extax, *about)
    text, parts = module_texts(models, names, _on_plate(X_BW, part), steps, plate, rail)
    at = np.array([step.row for step in steps if step.row is not None])
    return RapidProgram(text, at, rows.q[at], parts, first, tuple(writer.not_written))


def _said(
    writer: EventWriter, events: dict[int, list[ProgramEvent]], first: int
) -> dict[int, list[str]]:
    """The lines of the events at each row of the program."""
    return {
        row + first: [line for event in found for line in writer.lines(event)]
        for row, found in events.items()
    }


def _external_axes(external: ArrayLike, count: int, first: int, rows: int) -> list[str]:
    """Data of the external axes at every row of the program, its ends as the plan's.

    Raises:
        InputError: neither for the whole program nor for every row.
    """
    values = np.asarray(external, dtype=float)
    if values.ndim < 2:
        return [data.external_axes(values.tolist())] * rows
    if values.shape[0] != count:
        raise InputError(f"RAPID: external is {values.shape}, expected ({count}, k) or (k,)")
    padded = np.pad(values, ((first, rows - first - count), (0, 0)), mode="edge")
    known = {row: data.external_axes(row) for row in set(map(tuple, padded.tolist()))}
    return [known[tuple(row)] for row in padded.tolist()]


@dataclass(frozen=True)
class _Part:
    """A work object that turns, or an arm that is carried, during the moves."""

    axes: ExternalAxes
    angles: Array
    """at the rows of the plan [deg, mm of a rail], shape (n, k)"""

    @property
    def turns(self) -> bool:
        """Whether the work object is turned."""
        return len(self.axes) > self.axes.slides

    @classmethod
    def of(
        cls, axes: ExternalAxes | None, external: ArrayLike, options: RapidOptions, count: int
    ) -> _Part | None:
        """None where it stands.

        Raises:
            InputError: no angles for every row, or moves that are straight for the joints.
        """
        if axes is None:
            return None
        angles = np.asarray(external, dtype=float)
        if angles.shape != (count, len(axes)):
            raise InputError(
                f"RAPID: external is {angles.shape}, expected ({count}, {len(axes)}) for axes that "
                "turn the work object or carry the arm"
            )
        if options.motion == "joint":
            raise InputError(
                "RAPID: found motion joint with further axes that move, expected linear: moves "
                "that are straight for the joints leave the path on the part"
            )
        return cls(axes, angles)

    def padded(self, ends: tuple[int, int]) -> Array:
        """Places at the rows of the program, its ends as the plan's [rad, m of a rail]."""
        return self.axes.from_shown(np.pad(self.angles, (ends, (0, 0)), mode="edge"))

    def speeds(self, time: Array, ends: tuple[int, int]) -> Array:
        """Of a rail [mm/s], 5000 without one, and the largest of those that turn [deg/s], between
        the rows of the program, shape (n - 1, 2)."""
        shown = np.pad(self.angles, (ends, (0, 0)), mode="edge")
        rates = np.abs(np.diff(shown, axis=0)) / np.diff(time)[:, None]
        slides = self.axes.slides
        rail = rates[:, 0] if slides else np.full(len(rates), 5000.0)
        turning = rates[:, slides:].max(axis=1) if self.turns else np.full(len(rates), 1000.0)
        return np.column_stack([rail, turning])


def _names(options: RapidOptions, models: Sequence[Model], own: bool) -> list[Names]:
    """Of each tool; `own`: the work object is the module's."""
    several = len(models) > 1
    return [
        Names(options, arm.robot.tool is not None, own, k if several else 0)
        for k, arm in enumerate(models, start=1)
    ]


def _on_plate(X_BW: Array | None, part: _Part | None) -> Array | None:
    """The frame that the work object is declared in: the base, or the plate of a positioner that
    moves."""
    if part is None or X_BW is None or not part.turns:
        return X_BW
    return np.asarray(np.linalg.inv(part.axes.plate) @ X_BW)


@dataclass(frozen=True)
class _Flags:
    """Of the rows of the plan, each of shape (n,); feeds in m/s."""

    crossing: Rows
    joints: Rows
    standing: Rows
    feeds: Array

    @classmethod
    def of(
        cls,
        q: Array,
        crossing: Rows | None,
        joints: Rows | None,
        standing: Rows | None,
        feeds: ArrayLike | None,
    ) -> _Flags:
        """As the caller states them, each None for its default.

        Raises:
            InputError: of another shape or type; says which.
        """
        return cls(
            wrist_rows(q, crossing),
            row_flags("joint_rows", joints, len(q)),
            row_flags("stops", standing, len(q)),
            checked_feeds(feeds, len(q)),
        )


def _rows(
    models: Sequence[Model],
    tools: Sequence[tuple[int, Model]],
    plan: tuple[Array, Array],
    flags: _Flags,
    options: RapidOptions,
    X_BW: Array | None,
    part: _Part | None,
) -> tuple[PlanRows, int, npt.NDArray[np.int64]]:
    """The plan with its approach and retract, the row at which it begins, and the rows that become
    targets."""
    model = models[0]
    time, q, first = with_ends(model, *plan, options)
    ends = (first, len(q) - first - len(plan[1]))
    joints = np.pad(flags.joints, ends) | (options.motion == "joint")
    # moves of the joints pass the wrist singularity like any other place
    crossing = np.pad(flags.crossing, ends) & ~joints
    standing = np.pad(flags.standing, ends)
    # the arm stands where the approach meets the plan, and the plan the retract
    standing[first] |= ends[0] > 0
    standing[len(q) - 1 - ends[1]] |= ends[1] > 0
    # the arm goes to the row of a change with the tool before it
    tool = np.searchsorted(
        np.array([row for row, _ in tools], dtype=int) + first, np.arange(len(q))
    )
    X_BT = model.tcp_pose(q)
    for number, arm in enumerate(models[1:], start=1):
        X_BT[tool == number] = arm.tcp_pose(q[tool == number])
    moved = q if part is None else np.hstack([q, part.padded(ends)])
    rest = np.append(False, np.abs(np.diff(moved, axis=0)).max(axis=1) < 1e-10)
    # the way to the plan's first row is that of the approach
    feeds = np.pad(flags.feeds[1:], (ends[0] + 1, ends[1]), constant_values=np.inf)
    kept = rows_to_keep(rest, crossing, joints, feeds) | standing
    tolerance = 1e-3 * options.tolerance_mm
    angle = np.radians(options.tolerance_deg)
    # where the part moves, the controller goes straight in its eyes
    X_PT = X_BT if part is None else part.axes.seen(part.padded(ends), X_BT)
    samples = thinned(model, q, (X_BT, X_PT), kept, joints, tolerance, angle)
    X_WT = X_PT[samples]
    if X_BW is not None:
        X_WT = np.linalg.inv(data.check_pose("work object", X_BW)) @ X_WT
    speeds = speeds_between(time, X_PT)
    # a change of the tool moves the tip, but not the arm
    for row in np.flatnonzero(np.diff(tool)):
        X = models[tool[row + 1]].tcp_pose(q[row : row + 2])
        X = X if part is None else part.axes.seen(part.padded(ends)[row : row + 2], X)
        speeds[row] = speeds_between(time[row : row + 2], X)[0]
    if part is not None:
        speeds = np.column_stack([speeds, part.speeds(time, ends)])
    flags_of = (rest, crossing, joints, standing)
    return PlanRows(time, q, X_WT, speeds, *flags_of, tool, feeds), first, samples


def _rows_of(events: Sequence[ProgramEvent], time: Array) -> dict[int, list[ProgramEvent]]:
    """The events of each row, in their order."""
    found: dict[int, list[ProgramEvent]] = {}
    for event in sorted(events, key=lambda event: event.time):
        if not time[0] - 1e-6 <= event.time <= time[-1] + 1e-6:
            raise InputError(
                f"RAPID: {event.kind} is at {event.time:.3f} s, expected a time of the plan, "
                f"{time[0]:.3f} to {time[-1]:.3f} s"
            )
        row = min(int(np.searchsorted(time, event.time - 1e-6)), len(time) - 1)
        found.setdefault(row, []).append(event)
    return found
