"""Where real CAM files should stand: `irb2400 place` from a usual place, and what it gains.

    python benchmarks/place.py FOLDER [NAME…]

The part begins with its middle 1 m in front of the robot and 0.6 m above its foot, mean tool axis
up (as in `benchmarks/cam.py`). Worst margins are parts of what is comfortable, at stations; the
margins on the right are those of the continuous path.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path

from cam import SUFFIXES, upright

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import CamProgram, read_program
from irb2400_ctrl.planners.placement import Outlook, place
from irb2400_ctrl.planners.placement.proof import Proof


def told(outlook: Outlook, proof: Proof) -> str:
    """Worst margin, which it is, and the least of the continuous path."""
    if outlook.refused or proof.refused:
        return f"{outlook.refused or proof.refused}"[:60]
    margins = ", ".join(f"{name} {value:.3g}" for name, value in proof.margins.items())
    return f"{outlook.worth:.2f} ({outlook.worst}); {margins}"


def row(program: CamProgram) -> str:
    """Start and found of the first operation."""
    operation = program.operations[0]
    alone = replace(program, operations=(operation,))
    begin = time.process_time()
    found = place(irb.load_robot("irb2400"), [alone], start=upright(operation))
    seconds = time.process_time() - begin
    return (
        f"{program.name}: {len(operation.path)} points, {len(found.seen)} places, "
        f"{seconds:.0f} CPU s\n   start {told(found.start, found.start_proof)}\n   found "
        f"{told(found.found, found.proof)}"
    )


def main(folder: str, *names: str) -> None:
    """Two lines a file."""
    for path in sorted(Path(folder).iterdir()):
        known = any(suffix.lower() in SUFFIXES for suffix in path.suffixes)
        if not known or (names and path.name not in names):
            continue
        try:
            print(row(read_program(path)), flush=True)
        except InputError as error:
            print(f"{path.name}: {error}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
