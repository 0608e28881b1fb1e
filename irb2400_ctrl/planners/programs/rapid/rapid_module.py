"""The text of a RAPID module: its lines, procedures and declarations; and of its parts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.planners.programs.rapid.rapid_module_names import Names
from irb2400_ctrl.planners.programs.rapid.rapid_steps import Step
from irb2400_ctrl.robot import Robot

_START = ["ConfL\\On;", "ConfJ\\On;", "SingArea\\Off;"]


def module_texts(
    models: Sequence[Model],
    named: Sequence[Names],
    X_BW: Array | None,
    steps: list[Step],
    coupled: bool = False,
    rail: float | None = None,
) -> tuple[str, dict[str, str]]:
    """The module, and the modules that it loads in turn by the names of their files; models and
    names are those of each tool; `coupled`: the work object moves with the positioner; `rail`:
    where its carriage stands [m]."""
    names = named[0]
    options = names.options
    shared = []
    for model, of_tool in zip(models, named, strict=True):
        if of_tool.own_tool:
            shared += data.tooldata(of_tool.tool, model.robot)
    if X_BW is not None:
        unit = options.positioner if coupled else ""
        shared += data.wobjdata(names.work_object, X_BW, unit)
    head = _head(options.module, models[0].robot, rail)
    if options.targets_per_module == 0:
        calls, parts = _procedures(steps, options.moves_per_procedure, 0)
        body = ["", *_procedure(options.entry, [*_START, *calls]), *parts]
        return _module(head, shared + _local_data(names, steps), body), {}
    loads = list(_START)
    files = {}
    count = 0
    for k, portion in enumerate(_portions(steps, names), start=1):
        name = f"{options.module[:27]}_{k}"
        calls, parts = _procedures(portion, options.moves_per_procedure, count)
        count += len(calls)
        body = ["", *_procedure(f"Stretch{k}", calls), *parts]
        of_part = _head(name, models[0].robot, rail)
        files[f"{name}.mod"] = _module(of_part, _local_data(names, portion), body)
        place = [f'"{options.folder}"', f'  \\File:="{name}.mod";']
        loads += [f"Load\\Dynamic,{place[0]}", place[1], f'%"Stretch{k}"%;']
        loads += [f"UnLoad {place[0]}", place[1]]
    return _module(head, shared, ["", *_procedure(options.entry, loads)]), files


def _portions(steps: list[Step], names: Names) -> list[list[Step]]:
    """Steps with at most so many targets each, parted where the arm stands anyway if that is in the
    second half of a portion; else it has to stand there."""
    most = names.options.targets_per_module
    found = []
    rest = steps
    while rest:
        targets = [k for k, step in enumerate(rest) if step.row is not None]
        if len(targets) <= most:
            found.append(rest)
            break
        last = targets[most]
        standing = [k for k in range(targets[most // 2], last) if rest[k].stops]
        cut = standing[-1] + 1 if standing else last
        found.append(_ending_in_a_stop(rest[:cut], names))
        rest = rest[cut:]
    return found


def _ending_in_a_stop(portion: list[Step], names: Names) -> list[Step]:
    """While a module is loaded nothing moves: the last move of a portion ends in a stop point."""
    last = max(k for k, step in enumerate(portion) if step.row is not None)
    step = portion[last]
    if step.stops:
        return portion
    lines = [line.replace(f"{names.zone(step.zone)},", "fine,") for line in step.lines]
    return [*portion[:last], Step(lines, step.target, step.row), *portion[last + 1 :]]


def _local_data(names: Names, steps: list[Step]) -> list[str]:
    """Speed, zones and targets that the steps use."""
    options = names.options
    used = sorted({step.zone for step in steps if step.zone > 0})
    lines = []
    if any("vApproach" in line for step in steps for line in step.lines):
        speed = f"[{options.approach_speed_mm_s:.3f},20,5000,1000]"
        lines.append(f"LOCAL CONST speeddata vApproach:={speed};")
    for radius in used:
        lines += data.zonedata(names.zone(radius), radius)
    return lines + [line for step in steps for line in step.target]


def _procedures(steps: list[Step], size: int, before: int) -> tuple[list[str], list[str]]:
    """Calls of the procedures that hold the steps, and their lines."""
    portions = [steps[k : k + size] for k in range(0, len(steps), size)]
    calls = [f"Part{before + k}" for k in range(1, len(portions) + 1)]
    lines: list[str] = []
    for call, portion in zip(calls, portions, strict=True):
        lines += ["", *_procedure(call, [line for step in portion for line in step.lines])]
    return [f"{call};" for call in calls], lines


def _procedure(name: str, lines: list[str]) -> list[str]:
    return [f"  PROC {name}()", *("    " + line for line in lines), "  ENDPROC"]


def _module(head: list[str], declarations: list[str], body: list[str]) -> str:
    return "\n".join([*head, *("  " + line for line in declarations), *body, "ENDMODULE", ""])


_LEANING = (
    "  ! The arm hangs or leans: all places are in its base frame, as if that were",
    "  ! the world's; which way gravity pulls, the controller has to know itself.",
)
_ON_RAIL = (
    "  ! The carriage of the rail stands at {:.6g} mm: all places are in the",
    "  ! base frame there, not in that of a carriage at zero.",
)


def _head(name: str, robot: Robot, rail: float | None) -> list[str]:
    """The first lines; how axis 3 counts is the arm's own, and how it is mounted. The controller's
    world is not the base where a track carries the robot."""
    rod = robot.n > 2 and robot.A[2, 1] != 0
    counts = "counts from the vertical (parallel rod)" if rod else "counts from the upper arm"
    return [
        f"MODULE {name}",
        "  ! Written from a plan. Run it slowly and without the work-piece first.",
        f"  ! Base frame = world frame; axis 3 {counts}.",
        *([] if rail is None else [line.format(1e3 * rail) for line in _ON_RAIL]),
        *([] if np.array_equal(robot.upright, np.eye(3)) else _LEANING),
    ]
