"""`plan_program`: every operation of a CAM program planned for itself, rest to rest."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_path import plan_path
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Operation
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class PlannedOperation:
    """An operation and its plan, or why there is none."""

    operation: Operation
    plan: Plan | None
    refused: str = ""

    @property
    def folder(self) -> str:
        """A name for its files: number and name, without what file systems dislike."""
        name = re.sub(r"[^\w.-]+", "_", self.operation.name).strip("._")
        return f"{self.operation.number:02d}_{name}"[:60]

    def summary(self) -> dict[str, Any]:
        """Its entry in `program.json`."""
        return {
            **self.operation.summary(),
            "planned": self.plan is not None,
            "refused": self.refused,
            "folder": self.folder if self.plan is not None else None,
            "duration_s": None if self.plan is None else self.plan.duration,
        }


@dataclass(frozen=True)
class ProgramPlan:
    """What `plan_program` found; the ways from one operation to the next are not planned."""

    program: CamProgram
    operations: tuple[PlannedOperation, ...]

    @property
    def refused(self) -> list[PlannedOperation]:
        """Operations without a plan."""
        return [o for o in self.operations if o.plan is None]

    def transfers(self) -> list[dict[str, Any]]:
        """From the end of each operation to the start of the next: tool change, stop or way."""
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
        return {
            **self.program.summary(),
            "operations": [o.summary() for o in self.operations],
            "transfers_not_planned": self.transfers(),
        }

    def write(self, out_dir: Path | str) -> list[Path]:
        """`program.json`, and a folder with `trajectory.csv` and `plan.json` per operation."""
        folder = Path(out_dir)
        written: list[Path] = []
        for done in self.operations:
            if done.plan is not None:
                written += done.plan.write(folder / done.folder)
        text = json.dumps(self.summary(), indent=2) + "\n"
        return [write_atomic(folder / "program.json", text), *written]


def plan_program(
    robot: Robot,
    program: CamProgram,
    *,
    started: Callable[[Operation], None] | None = None,
    **options: Any,
) -> ProgramPlan:
    """Plan every operation; one that cannot be planned does not hold the others up.

    Args:
        started: called with each operation as it begins.
        options: those of `plan_path`.

    Raises:
        InputError: an option is wrong for all of them.
    """
    done = []
    for operation in program.operations:
        if started is not None:
            started(operation)
        try:
            plan = plan_path(robot, operation.path, **with_its_tool(operation, options))
            done.append(PlannedOperation(operation, plan))
        except InputError as error:
            done.append(PlannedOperation(operation, None, str(error)))
    return ProgramPlan(program, tuple(done))


def with_its_tool(operation: Operation, options: dict[str, Any]) -> dict[str, Any]:
    """Options of `plan_path` with the cell's tool that the operation asks for, unless one is
    named."""
    cell = options.get("cell")
    if cell is None or options.get("tool") is not None:
        return options
    return {**options, "tool": cell.tool_of(operation.tool.number, operation.tool.name)}
