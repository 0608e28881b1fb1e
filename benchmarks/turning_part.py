"""A random search for a bound of a plan with a positioner that moves below what its file does: 0
aimed at.

    python benchmarks/turning_part.py [count] [first seed]

Tables with skew axes and ways around cones are drawn anew (without a first seed: from the clock,
and printed), planned, written, read back as text and followed 10,000 times a second with the
kinematics of `tests/turning_part.py`: the tip in the eyes of the part, its speed there, speed,
acceleration and range of both axes.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import plan_path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from turning_part import drawn, looked_at


def main(count: int = 20, first: int | None = None) -> None:
    """Print each draw, then how many bounds are below the truth."""
    robot = irb.load_robot("irb2400")
    begin = int(time.time()) if first is None else first
    print(f"seeds {begin} to {begin + count - 1}", flush=True)
    planned = guaranteed = below = 0
    used = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(begin, begin + count):
            table, path = drawn(seed)
            start = time.process_time()
            try:
                plan = plan_path(robot, path, cell=table.cell())
            except InputError as error:
                print(f"seed {seed}: refused, {error}", flush=True)
                continue
            planned += 1
            guaranteed += plan.guaranteed
            used.append(time.process_time() - start)
            seen = looked_at(plan, table, path, Path(folder))
            found = seen.above(plan)
            below += bool(found)
            turned = np.degrees(np.ptp(seen.between, axis=0))
            print(
                f"seed {seed}: turned by {turned[0]:.0f} and {turned[1]:.0f} deg in "
                f"{plan.duration:.2f} s, guaranteed {plan.guaranteed}, deviation "
                f"{seen.deviation_mm:.4f} of {1e3 * plan.max_tcp_deviation:.4f} mm, speeds "
                f"{100 * seen.fast.max():.2f} %, accelerations {100 * seen.sharp.max():.2f} % of "
                f"their limits, above {found}",
                flush=True,
            )
    print(
        f"{planned} of {count} planned, {guaranteed} guaranteed, {below} with a bound below the "
        f"truth; {np.median(used) if used else np.nan:.0f} s of CPU each (median)"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
