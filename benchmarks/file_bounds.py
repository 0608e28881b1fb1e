"""A random search for a bound of a plan below what its written file needs: 0 aimed at.

    python benchmarks/file_bounds.py [count] [first seed] [rates]

With 0 for the rates the torque may jump: a quarter of the time, and harder on what reads the rows.

Tool paths are drawn anew (without a first seed: from the clock, and printed), planned with the
cubic and the linear interpolation in turn, written, read back as text, and followed 10,000 times a
second with the recursion of `tests/independent_plant`, friction by eq. 55.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import plan_path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from drawn_plans import drawn_path, looked_at


def main(count: int = 1000, first: int | None = None, rates: int = 1) -> None:
    """Print each bound below the truth with its seed, then how many there are."""
    robot = irb.load_robot("irb2400")
    begin = int(time.time()) if first is None else first
    print(f"seeds {begin} to {begin + count - 1}", flush=True)
    planned = guaranteed = below = 0
    price = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(begin, begin + count):
            way: Any = "linear" if seed % 2 else "cubic"
            path = drawn_path(seed)
            try:
                plan = plan_path(
                    robot,
                    path,
                    free_tool_rotation=False,
                    interpolation=way,
                    torque_rate=None if rates else np.inf,
                )
            except InputError:
                continue
            planned += 1
            guaranteed += plan.guaranteed
            seen = looked_at(plan, robot, Path(folder))
            found = seen.above(plan)
            if "duration_without_rates_s" in plan.rates:
                price.append(plan.duration / plan.rates["duration_without_rates_s"] - 1)
            if found or not plan.guaranteed:
                below += bool(found)
                print(
                    f"seed {seed} {way}: guaranteed {plan.guaranteed}, above {found}, {seen}",
                    flush=True,
                )
            if planned % 10 == 0:
                print(f"{planned} planned, {below} below", flush=True)
    price.sort()
    print(
        f"{planned} of {count} reachable, {guaranteed} guaranteed, {below} with a bound below the "
        "truth"
    )
    if price:
        middle = price[len(price) // 2]
        print(f"longer than with a torque that jumps: median {100 * middle:.1f} %")


if __name__ == "__main__":
    main(*(int(value) for value in sys.argv[1:4]))
