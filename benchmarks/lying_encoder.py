"""How far an axis goes before the guard's brake holds where its encoder lies: axis 2 reports half
of every move from 3.5 s on, on drawn arms of the independent plant under the guarded controller.

    python benchmarks/lying_encoder.py [ARMS] [FIRST SEED] [SHARE]

SHARE scales `unexplained_limit` of the large axes (1-3). Prints a line per arm, then how many arms
go beyond 10 degrees, and how many brakes close where nothing lies.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from closing_the_loop.faults import LASTING, PASSING, Outcome, run_with_fault
from independent_plant.case import Case

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller, guarded

BEGIN = 3500
SECONDS = 8.0
LIE = LASTING["lies: half of every move"]
LIMIT_DEG = 10.0


def guard(share: float) -> Block:
    """The guarded controller with that share of its limit on the large axes."""
    robot = irb.load_robot("irb2400")
    block = guarded(controller("computed_torque", robot), robot)
    scale = np.array([share] * 3 + [1.0] * 3)
    parameters = [
        replace(field, default=tuple(scale * field.start))
        if field.name == "unexplained_limit"
        else field
        for field in block.parameters
    ]
    return replace(block, parameters=tuple(parameters))


def braked(outcome: Outcome) -> str:
    """When the signal came."""
    return "no brake" if outcome.brake_ms is None else f"brake after {outcome.brake_ms:.0f} ms"


def main(arms: int, first: int, share: float) -> None:
    """Drive every arm with and without the lie."""
    block = guard(share)
    angles = []
    false = 0
    for seed in range(first, first + arms):
        case = Case(seed, duration=1.0, validation_duration=SECONDS)
        sound, lied = (
            run_with_fault(case, block, BEGIN, fault) for fault in (PASSING["none"], LIE)
        )
        false += sound.brake_ms is not None
        angles.append(lied.largest_error_deg)
        print(f"arm {seed}: {angles[-1]:.1f} deg, {braked(lied)}", flush=True)
    far = sum(angle > LIMIT_DEG for angle in angles)
    print(
        f"{far} of {arms} arms beyond {LIMIT_DEG:.0f} deg (median {np.median(angles):.1f}, largest "
        f"{max(angles):.1f}); {false} brakes without a lie"
    )


if __name__ == "__main__":
    given = [float(word) for word in sys.argv[1:]] + [20, 3, 1.0][len(sys.argv) - 1 :]
    main(int(given[0]), int(given[1]), given[2])
