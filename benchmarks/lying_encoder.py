"""How far an axis goes before the guard's brake holds where its encoder lies, and how many brakes
close where none does: drawn arms of the independent plant under the guarded controller.

    python benchmarks/lying_encoder.py lying|sound [ARMS] [FIRST SEED] [UNKNOWN LOAD]

`lying`: each axis in turn lies in each way from 3.5 s on, in motions of 8 s. `sound`: nothing lies,
but loads at the flange that nobody told, friction off the model's, or an effect that the robot file
does not have. UNKNOWN LOAD [kg] replaces the guard's. Twenty arms take six and three minutes.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from closing_the_loop.faults import LIES, PASSING, Fault, Outcome, off_model, run_with_fault
from independent_plant.case import Case
from independent_plant.effects import LIBRARY, Effect

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.parts import with_gains

BEGIN = 3500
SECONDS = 8.0
LIMIT_DEG = 10.0
OFF_MODEL = ((0, 1.0), (0, 0.7), (0, 1.3), (3, 1.0), (3, 0.7), (3, 1.3), (12, 1.0))
"""load that nobody told [kg], friction as a multiple of the drawn one"""
EFFECTS = (0.04, 0.15)
"""rms torque of an effect that nobody told, as a share of its joint's"""


def arm(seed: int, load: float = 0.0, friction: float = 1.0, effect: Effect | None = None) -> Case:
    """A drawn arm off its model."""
    effects = (effect,) if effect else ()
    case = Case(seed, effects, duration=10.0 if effects else 1.0, validation_duration=SECONDS)
    return off_model(case, load, friction)


def outcome(case: Case, package: Package, fault: Fault) -> Outcome:
    """Of one run."""
    return run_with_fault(case, package, BEGIN, fault)


def lying(package: Package, seeds: range) -> None:
    """A line per lie: for each axis how many arms go beyond the limit, median and largest angle."""
    total = 0
    for name, lie in LIES.items():
        for axis in range(6):
            cases = (arm(seed) for seed in seeds)
            far = [outcome(case, package, lie(axis)).largest_error_deg for case in cases]
            beyond = sum(angle > LIMIT_DEG for angle in far)
            total += beyond
            print(
                f"axis {axis + 1}, {name}: {beyond} of {len(seeds)} arms beyond "
                f"{LIMIT_DEG:.0f} deg (median {np.median(far):.1f}, largest {max(far):.1f})",
                flush=True,
            )
    print(f"{total} of {len(LIES) * 6 * len(seeds)} lies lead beyond {LIMIT_DEG:.0f} deg")


def sound(package: Package, seeds: range) -> None:
    """Brakes that close where nothing lies."""
    for load, friction in OFF_MODEL:
        cases = (arm(seed, load, friction) for seed in seeds)
        _tell(f"{load} kg, friction x {friction}", cases, package, len(seeds))
    for share in EFFECTS:
        kinds = [list(LIBRARY)[seed % len(LIBRARY)] for seed in seeds]
        cases = (
            arm(seed, effect=Effect(kind, None, share, -np.inf))
            for seed, kind in zip(seeds, kinds, strict=True)
        )
        _tell(f"an effect of {share:.0%} of its joint's torque", cases, package, len(seeds))


def _tell(what: str, cases: Iterable[Case], package: Package, n: int) -> None:
    brakes = sum(outcome(c, package, PASSING["none"]).brake_ms is not None for c in cases)
    print(f"no lie, {what}: {brakes} of {n} brakes close", flush=True)


def main(what: str, arms: int = 20, first: int = 3, load: float | None = None) -> None:
    """Drive every arm with every lie, or without one."""
    robot = irb.load_robot("irb2400")
    block = guarded(controller("computed_torque", robot), robot)
    if load is not None:
        block = with_gains(block, unknown_load=load)
    {"lying": lying, "sound": sound}[what](Package(block, "float"), range(first, first + arms))


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:4]), *map(float, sys.argv[4:5]))
