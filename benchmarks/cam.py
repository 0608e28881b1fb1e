"""Real CAM files: read, and planned where the part fits (docs/cam.md).

    python benchmarks/cam.py FOLDER            a row per operation
    python benchmarks/cam.py FOLDER --read     without planning

The part stands with the middle of its extent one metre in front of the robot, 0.6 m above the
floor, turned so that the mean tool axis points up.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl import load_robot
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, Operation, ProgramPlan, plan_program, read_program

Array = npt.NDArray[np.float64]
PLACE = np.array([1.0, 0.0, 0.6])
SUFFIXES = {".cls", ".clsf", ".ncl", ".aptsource", ".nc", ".apt", ".ngc", ".gcode"}


def upright(operation: Operation) -> Array:
    """The work frame (4, 4) with the part in its place, tool axis up on average."""
    path = operation.path
    assert path.axis is not None
    mean = path.axis.mean(axis=0)
    length = np.linalg.norm(mean)
    z = mean / length if length > 1e-6 else path.axis[0]
    x = np.cross([0.0, 1.0, 0.0], z)
    if np.linalg.norm(x) < 1e-6:
        x = np.array([1.0, 0.0, 0.0])
    x = x / np.linalg.norm(x)
    X = np.eye(4)
    X[:3, :3] = np.stack([x, np.cross(z, x), z])
    turned = path.position @ X[:3, :3].T
    X[:3, 3] = PLACE - (turned.min(axis=0) + turned.max(axis=0)) / 2
    return X


def row(program: CamProgram, operation: Operation, plan: bool) -> list[str]:
    """Points, cut and rapid length, feed, extent, and what planning says."""
    s = operation.summary()
    feed = s["feed_mm_s"]
    low, high = s["extent_mm"]
    size = " × ".join(f"{b - a:.0f}" for a, b in zip(low, high, strict=True))
    cells = [
        operation.name,
        str(s["points"]),
        f"{s['cutting_length_mm']:.0f}",
        f"{s['rapid_length_mm']:.0f}",
        "–" if feed is None else f"{feed[0]:.3g} … {feed[1]:.3g}",
        size,
    ]
    if not plan:
        return cells
    start = time.perf_counter()
    alone = replace(program, operations=(operation,))
    found = plan_program(load_robot("irb2400"), alone, work_frame=upright(operation), rate=50.0)
    return [*cells, *told(found), f"{time.perf_counter() - start:.0f}"]


def told(found: ProgramPlan) -> list[str]:
    """Duration of the operation and of the whole motion, and whether its bounds hold."""
    done = found.operations[0]
    if not done.planned:
        return [f"refused: {done.refused}", "–"]
    motion = found.motion
    if motion is None:
        return [f"{done.duration:.1f} s", f"not linked: {found.refused_links}"]
    held = "held" if motion.guaranteed else "not held"
    turned = f", unwound {len(motion.unwindings)} times" if motion.unwindings else ""
    return [f"{done.duration:.1f} s", f"{motion.duration:.1f} s, {held}{turned}"]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--read", action="store_true", help="do not plan")
    arguments = parser.parse_args()
    head = ["file", "language", "operation", "points", "cut mm", "rapid mm", "feed mm/s", "size mm"]
    head += [] if arguments.read else ["cut in", "whole motion", "s"]
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for file in sorted(arguments.folder.iterdir()):
        if not SUFFIXES & set(file.suffixes):
            continue
        try:
            program = read_program(file)
        except InputError as error:
            print(f"| {file.name} | – | not read: {error} |", flush=True)
            continue
        for operation in program.operations:
            cells = row(program, operation, not arguments.read)
            print(f"| {file.name} | {program.dialect} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
