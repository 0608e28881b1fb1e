"""Plan, run, identify: are the true numbers inside the intervals that come out?

    python benchmarks/plan_run_identify.py [--arms 10] [--first 500] [--no-runs]

`excite_identification` plans both motions for the robot file; arms of the independent plant
(`tests/independent_plant`), drawn within the uncertainty of a data sheet, follow them in closed
loop; `identify` reads the two logs. Printed: how many true base parameters and friction numbers
lie inside the stated 95 % intervals.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from identification.possible_arms import PossibleCase, log_of, possible_robot, scores_of

import irb2400_ctrl as irb
from irb2400_ctrl.excitation import excite_identification


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=10)
    parser.add_argument("--first", type=int, default=500)
    parser.add_argument("--no-runs", action="store_true", help="leave out the slow runs")
    args = parser.parse_args()
    robot = possible_robot()
    planned = excite_identification(robot)
    print("\n".join(planned.lines()[:3]), flush=True)
    found = []
    names: list[str] = []
    for seed in range(args.first, args.first + args.arms):
        case = PossibleCase(robot, seed, 40.0)
        logs = [log_of(case, planned.course)]
        if not args.no_runs:
            logs.append(log_of(case, planned.runs.course, "runs"))
        start = time.process_time()
        names, z = scores_of(robot, case, irb.identify(robot, logs))
        seconds = time.process_time() - start
        found.append(z)
        known = np.isfinite(z)
        share = float(np.mean(np.abs(z[known]) < 1.96))
        print(
            f"arm {seed}: {100 * share:.1f} % of {known.sum()} inside, {seconds:.0f} s", flush=True
        )
    z = np.array(found)
    known = np.isfinite(z)
    inside = (np.abs(z) < 1.96) & known
    print(f"all: {inside.sum()} of {known.sum()} inside: {100 * inside.sum() / known.sum():.1f} %")
    for name, hits, count in zip(names, inside.sum(axis=0), known.sum(axis=0), strict=True):
        print(f"  {name:<12} {hits} of {count}")


if __name__ == "__main__":
    main()
