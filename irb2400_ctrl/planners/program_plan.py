"""`plan_program`: a CAM program as one motion; its operations planned one by one, and linked."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import one_thread
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.files import write_json
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.link_operations import link_operations
from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.operation_runs import operation_runs, unwound_runs
from irb2400_ctrl.planners.linking.program_motion import ProgramMotion
from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Operation
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

ArmOf = Callable[[Operation], Robot]
"""the arm with the tool of an operation"""


@dataclass(frozen=True)
class PlannedOperation:
    """An operation and its plans, or why there are none."""

    operation: Operation
    options: PlanOptions
    """those that are asked for it alone"""
    runs: tuple[Run, ...] = ()
    """parts that are followed without a stop, one unless axes have to be unwound"""
    refused: str = ""

    @property
    def plan(self) -> Plan | None:
        """The plan of an operation that is followed in one go."""
        return self.runs[0].plan if len(self.runs) == 1 else None

    @property
    def planned(self) -> bool:
        """Whether there is a motion."""
        return bool(self.runs)

    @property
    def duration(self) -> float | None:
        """Of its parts, without what is between them [s]."""
        return sum(run.plan.duration for run in self.runs) if self.runs else None

    @property
    def folder(self) -> str:
        """A name for its files: number and name, without what file systems dislike."""
        name = re.sub(r"[^\w.-]+", "_", self.operation.name).strip("._")
        return f"{self.operation.number:02d}_{name}"[:60]

    def folders(self) -> list[tuple[str, Run]]:
        """The folder of each of its parts."""
        if len(self.runs) < 2:
            return [(self.folder, run) for run in self.runs]
        return [(f"{self.folder}/part_{k}", run) for k, run in enumerate(self.runs, 1)]

    def summary(self) -> dict[str, Any]:
        """Its entry in `program.json`."""
        return {
            **self.operation.summary(),
            "planned": self.planned,
            "refused": self.refused,
            "folder": self.folder if self.planned else None,
            "parts": len(self.runs),
            "duration_s": self.duration,
        }


@dataclass(frozen=True)
class ProgramPlan:
    """What `plan_program` found."""

    program: CamProgram
    operations: tuple[PlannedOperation, ...]
    motion: ProgramMotion | None = None
    """the whole program as one motion; None where an operation, or a way between them, has none"""
    refused_links: str = ""
    """why the planned operations are not linked; empty where they are"""

    @property
    def refused(self) -> list[PlannedOperation]:
        """Operations without a plan."""
        return [o for o in self.operations if not o.planned]

    def transfers(self) -> list[dict[str, Any]]:
        """From the end of each operation to the start of the next, where they are apart."""
        found = []
        for before, after in zip(
            self.program.operations[:-1], self.program.operations[1:], strict=True
        ):
            start = before.path.position[-1]
            end = after.path.position[0]
            distance = float(np.linalg.norm(end - start))
            if distance > 1e-9:
                found.append(
                    {"from": before.number, "to": after.number, "distance_mm": 1e3 * distance}
                )
        return found

    def summary(self) -> dict[str, Any]:
        """The content of `program.json`."""
        linked = self.motion is not None
        return {
            **self.program.summary(),
            "operations": [o.summary() for o in self.operations],
            "transfers": self.transfers(),
            "linked": linked,
            "links_refused": self.refused_links,
            "transfers_not_planned": [] if linked else self.transfers(),
        }

    def write(self, out_dir: Path | str) -> list[Path]:
        """`program.json`; `trajectory.csv` and `plan.json` of the whole, and a folder with the
        same per operation."""
        folder = Path(out_dir)
        written: list[Path] = []
        if self.motion is not None:
            written += self.motion.write(folder)
        for done in self.operations:
            for name, run in done.folders():
                written += run.plan.write(folder / name)
        return [write_json(folder / "program.json", self.summary()), *written]


@typed
def plan_program(
    robot: Robot,
    program: CamProgram,
    *,
    links: LinkOptions | None = None,
    arm_of: ArmOf | None = None,
    started: Callable[[Operation], None] | None = None,
    **options: Any,
) -> ProgramPlan:
    """Plan every operation and link them; one that cannot be planned does not hold the others up.

    Args:
        robot: the arm.
        program: operations in one frame.
        links: heights and ends of the moves beside the operations.
        arm_of: the arm with the tool of each operation; `robot` for all of them if absent.
        started: called with each operation as it begins.
        options: those of `plan_path`.

    Raises:
        InputError: an option is wrong for all of them.
    """
    links = LinkOptions() if links is None else links
    return plan_operations(robot, program, PlanOptions(**options), links, arm_of, started)


@one_thread()
def plan_operations(
    robot: Robot,
    program: CamProgram,
    options: PlanOptions,
    links: LinkOptions,
    arm_of: ArmOf | None = None,
    started: Callable[[Operation], None] | None = None,
) -> ProgramPlan:
    """`plan_program` of a request in one piece: `options`; the other arguments as there."""
    asked = [options.for_operation(operation, robot) for operation in program.operations]
    plane = clearance_plane(robot, program, links, asked)
    done = []
    for operation, found in zip(program.operations, asked, strict=True):
        if started is not None:
            started(operation)
        arm = robot if arm_of is None else arm_of(operation)
        try:
            runs = operation_runs(arm, operation, plane, links, found)
            done.append(PlannedOperation(operation, found, runs))
        except InputError as error:
            done.append(PlannedOperation(operation, found, (), str(error)))
    motion = None
    refused = ""
    if all(o.planned for o in done):
        runs = tuple(run for o in done for run in o.runs)
        try:
            motion = link_operations(program.name, runs, plane, links)
        except InputError as error:
            refused = str(error)
    return ProgramPlan(program, tuple(done), motion, refused)


@one_thread()
def plan_unwound(
    robot: Robot,
    program: CamProgram,
    options: PlanOptions,
    links: LinkOptions,
    because: UnreachableError,
) -> ProgramPlan:
    """The only operation of a program in parts, between which axes are unwound.

    Args:
        because: why `plan_path` does not follow it in one go.
        robot, program, options, links: as in `plan_operations`.

    Raises:
        UnreachableError: `because`, where unwinding does not help; or there is no way between the
            parts above the clearance plane.
    """
    operation = program.operation()
    found = options.for_operation(operation, robot)
    plane = clearance_plane(robot, program, links, [found])
    runs = unwound_runs(robot, operation, plane, links, found, because)
    motion = link_operations(program.name, runs, plane, links)
    return ProgramPlan(program, (PlannedOperation(operation, found, runs),), motion)


def clearance_plane(
    robot: Robot, program: CamProgram, links: LinkOptions, asked: Sequence[PlanOptions]
) -> ClearancePlane:
    """The plane above everything that the operations cut, each as its options place it."""
    paths = [
        (options.seen(o.path, robot), o.rapid)
        for o, options in zip(program.operations, asked, strict=True)
    ]
    return ClearancePlane.over(paths, robot.spindle_axis, links.clearance, robot.upright[2])
