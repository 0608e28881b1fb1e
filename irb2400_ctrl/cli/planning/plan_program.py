"""`irb2400 plan` of a program: its operations as one motion, linked above the part."""

from __future__ import annotations

import gc
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irb2400_ctrl.cli.planning.rapid_out import write_motion_module, write_plan_module
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.system import give_back_freed
from irb2400_ctrl.wording import counted

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.planners import CamProgram, LinkOptions, Plan, ProgramMotion, ProgramPlan
    from irb2400_ctrl.planners.plan_options import PlanOptions
    from irb2400_ctrl.planners.programs.rapid import RapidOptions
    from irb2400_ctrl.robot import Robot


@dataclass(frozen=True, eq=False)
class Job:
    """One call of `irb2400 plan`."""

    arm: Robot
    program: CamProgram
    links: LinkOptions
    options: PlanOptions
    out: Path
    rapid: RapidOptions | None


def link_options(
    arm: Robot,
    operations: int,
    links: bool | None,
    clearance_mm: float | None,
    approach_mm: float | None,
    start_deg: str | None,
) -> LinkOptions:
    """What the options say; whoever states a height or a start wants the links.

    Raises:
        InputError: a number or a start that cannot be, or one of them together with --no-links.
    """
    from irb2400_ctrl.planners import LinkOptions
    from irb2400_ctrl.planners.linking.link_operations import check_start
    from irb2400_ctrl.planners.linking.link_options import APPROACH, CLEARANCE

    stated = [v for v in (clearance_mm, approach_mm, start_deg) if v is not None]
    if links is False and stated:
        raise InputError(
            "found --no-links together with --clearance, --approach or --start, which shape the "
            "links; expected one or the other"
        )
    if links is None:
        links = operations > 1 or bool(stated)
    start = None if start_deg is None else _angles(start_deg)
    if start is not None:
        check_start(arm, start)  # said before the long work
    return LinkOptions(
        CLEARANCE if clearance_mm is None else 1e-3 * clearance_mm,
        APPROACH if approach_mm is None else 1e-3 * approach_mm,
        start,
        ends=links,
    )


def _angles(text: str) -> Any:
    import numpy as np

    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if not values or not all(math.isfinite(value) for value in values):
        raise InputError(
            f"--start: found {text!r}, expected joint angles in degrees, such as 0,0,0,0,30,0"
        )
    return np.radians(values)


def plan_all(job: Job) -> Summary:
    """The whole into the folder itself, each operation into its own, and program.json."""
    from irb2400_ctrl.planners.program_plan import plan_operations

    task = f"planning {counted(len(job.program.operations), 'operation')}"
    with step(task) as say:
        found = plan_operations(
            job.arm,
            job.program,
            job.options,
            job.links,
            started=lambda o: say(f"{task}: {o.number} {o.name}"),
        )
        say(f"{task}: writing")
        written = _write(found, job)
    return _told(found, job, written)


def plan_parts(job: Job, because: UnreachableError) -> Summary:
    """The only operation in parts, between which axes are unwound.

    Raises:
        UnreachableError: `because`, where unwinding does not help.
    """
    from irb2400_ctrl.planners.program_plan import plan_unwound

    found = plan_unwound(job.arm, job.program, job.options, job.links, because)
    written = _write(found, job)
    return _told(found, job, written)


def _write(found: ProgramPlan, job: Job) -> list[Path]:
    """All files. The RAPID modules come before the reports, whose figures take memory of their
    own."""
    out = job.out
    written = found.write(out)
    give_back_freed()
    written += _modules(found, job)
    for done in found.operations:
        title = f"Plan of operation {done.operation.number}, {done.operation.name}"
        for folder, run in done.folders():
            written.append(
                out / folder / report(run.plan, out / folder, job.arm, title, done.options)
            )
    if found.motion is not None:
        title = f"Plan of {found.program.name}"
        written.append(out / report(found.motion, out, job.arm, title, job.options))
    return written


def _modules(found: ProgramPlan, job: Job) -> list[Path]:
    """One RAPID module of the whole, or one of each plan where nothing links them; none where none
    is asked for."""
    out = job.out
    if job.rapid is None:
        return []
    if found.motion is not None:
        frame = _common_frame(found)
        return [out / name for name in write_motion_module(found.motion, job.rapid, frame, out)]
    written = []
    for done in found.operations:
        whole = done.operation if len(done.runs) == 1 else None
        for folder, run in done.folders():
            names = write_plan_module(run.plan, whole, job.rapid, done.options.frame, out / folder)
            written += [out / folder / name for name in names]
    return written


def _common_frame(found: ProgramPlan) -> Array | None:
    """The work frame of all operations; None where a positioner turns the part between them."""
    frames = [done.options.frame for done in found.operations]
    first = frames[0]
    alike = first is not None and all(f is not None and (f == first).all() for f in frames)
    return first if alike else None


def _told(found: ProgramPlan, job: Job, written: Sequence[Path]) -> Summary:
    """What was planned: plan.json of the whole, and program.json under `program`; stops where an
    operation, or a way between two, has no plan."""
    for done in found.operations:
        if done.planned:
            points = len(done.operation.path)
            print(f"{done.folder}: {points} points, {done.duration:.2f} s")
    if found.motion is not None:
        print_motion(found.motion, found.program.name, job.options.tolerance)
    print(f"written: {_files(written, job.out)}")
    whole = {} if found.motion is None else found.motion.summary()
    return Summary({**whole, "program": found.summary()}, written, _refusal(found))


def print_motion(motion: ProgramMotion, name: str, tolerance: float) -> None:
    """Duration, unwindings and what is sure of the whole.

    Args:
        motion: of the whole program.
        name: of the program.
        tolerance: how far corners might be cut [m].
    """
    s = motion.summary()
    print(
        f"{name}: one motion of {counted(len(motion.segments), 'segment')}, {motion.duration:.2f} s"
    )
    for unwound in motion.unwindings:
        print(f"operation {unwound.operation}, {unwound.start:.2f} s: {unwound.note}")
    rests = [event for event in motion.events if event.at_rest]
    if rests:
        told = ", ".join(f"{event.kind} at {event.time:.2f} s" for event in rests[:6])
        more = f" and {len(rests) - 6} more" if len(rests) > 6 else ""
        print(f"the arm stands for: {told}{more}")
    print_deviation(s, tolerance)
    print_clearance(s["clearance_mm"])
    print_external(s["external_axes"])
    print_feed(s["feed"])
    print(f"{used(s)}{held(s)}")


def used(s: dict[str, Any]) -> str:
    """How much of the limits a motion uses at most."""
    found = (
        f"torque at most {100 * s['max_torque_ratio']:.1f} % of its limit, speed "
        f"{100 * s['max_velocity_ratio']:.1f} %"
    )
    bend = s["max_acceleration_ratio"]
    return found if bend is None else f"{found}, acceleration {100 * bend:.1f} %"


def held(s: dict[str, Any]) -> str:
    """Whether that is guaranteed, or why it is not."""
    if s["guaranteed"]:
        return f"; guaranteed for the rows read as {s['interpolation']}"
    return f"; not guaranteed: {s['guarantee_note']}" if s["guarantee_note"] else ""


def print_deviation(s: dict[str, Any], tolerance: float) -> None:
    """How far the rows leave the path, where that is clearly more than was asked for [m], and how
    far the tool its stated orientation."""
    from irb2400_ctrl.report.pages.plan_page import deviation_words, turned_words

    for said in (deviation_words(s, tolerance), turned_words(s)):
        if said:
            print(said)


def print_clearance(found: dict[str, Any]) -> None:
    """The smallest distance in words, or why it is not known."""
    if found["value"] is None:
        print(f"clearance: not known, {found['reason']}")
        return
    first, other = found["pair"]
    print(
        f"clearance: at least {found['value']:.1f} mm everywhere, least between {first} and "
        f"{other} at {found['at_mm']:.0f} mm of the way"
    )


def print_external(axes: Sequence[dict[str, Any]]) -> None:
    """How much of their limits the axes that move beside the arm use."""
    for axis in axes:
        unit = "mm" if "between_mm" in axis else "deg"
        low, high = axis[f"between_{unit}"]
        print(
            f"{axis['name']} between {low:.1f} and {high:.1f} {unit}: speed at most "
            f"{100 * axis['max_speed_ratio']:.1f} %, acceleration "
            f"{100 * axis['max_acceleration_ratio']:.1f} % of its limit"
        )


def print_feed(feed: dict[str, Any] | None) -> None:
    """On how much of the path the programmed feed is held, and what limits the rest."""
    if feed is None:
        return
    text = f"programmed feed held on {100 * feed['share_at_feed']:.1f} % of its path"
    below = [
        f"{name} ({length:.1f} mm)"
        for name, length in list(feed.get("below_by_limit_mm", {}).items())[:3]
    ]
    print(f"{text}; below it: {', '.join(below)}" if below else text)


def report(
    planned: Plan | ProgramMotion, out: Path, arm: Robot, title: str, options: PlanOptions
) -> str:
    """The report; its name."""
    # figures of the report before hold on to each other
    gc.collect()
    give_back_freed()
    from irb2400_ctrl.cli.command_line import provenance
    from irb2400_ctrl.report.pages.plan_page import plan_page

    # a program may change its tool; the picture of the whole has the one that was asked for
    tool = options.in_spindle
    page = plan_page(planned, title, arm, options.cell, tool, options.tolerance)
    page.provenance(provenance(arm))
    page.write(out / "report.html")
    return "report.html"


def _files(written: Sequence[Path], out: Path) -> str:
    """What lies in the folder itself; those of the operations in a word."""
    names = [str(path) for path in written if path.parent == out]
    return f"{', '.join(names)} and a folder per operation"


def _refusal(found: ProgramPlan) -> InputError | None:
    """What has no plan, as the user's to change."""
    if found.refused:
        reasons = "; ".join(
            f"{o.operation.number} ({o.operation.name}): {o.refused}" for o in found.refused
        )
        return InputError(f"{len(found.refused)} of {len(found.operations)} operations: {reasons}")
    if found.motion is None:
        return InputError(f"the operations are planned, but not linked: {found.refused_links}")
    return None
