"""A random search for a bound of a plan with a carriage that moves below what its file does and
needs: 0 aimed at.

    python benchmarks/moving_rail.py [count] [first seed]

Rails, parts and long ways beside them are drawn anew (without a first seed: from the clock, and
printed), a third of them on a table that turns as well, planned, written, read back as text and
followed 10,000 times a second with the kinematics and dynamics of `tests/rail_cell.py`: torque on a
base that accelerates, speed of the joints, the tip in the eyes of the part, its speed there, speed,
acceleration and range of carriage and table. Beside each plan: whether the arm does the same from a
carriage that stands in the middle.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import Plan, ToolPath, plan_path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from rail_cell import Track, drawn, looked_at

ROBOT = irb.load_robot("irb2400")


def main(count: int = 20, first: int | None = None) -> None:
    """Print each draw, then how many bounds are below the truth."""
    begin = int(time.time()) if first is None else first
    print(f"seeds {begin} to {begin + count - 1}", flush=True)
    planned = guaranteed = below = standing = 0
    used = []
    pushed = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(begin, begin + count):
            track, path = drawn(seed)
            still = stands(track, path)
            standing += still
            start = time.process_time()
            try:
                plan = plan_path(ROBOT, path, cell=track.cell())
            except InputError as error:
                print(f"seed {seed}: refused, {error}", flush=True)
                continue
            planned += 1
            guaranteed += plan.guaranteed
            used.append(time.process_time() - start)
            seen = looked_at(plan, track, path, Path(folder))
            pushed.append(seen.pushed)
            found = seen.above(plan)
            below += bool(found)
            way = 1e3 * np.ptp(seen.between)
            length = 1e3 * np.ptp(path.position[:, 1])
            print(
                f"seed {seed}: carriage by {way:.0f} mm for {length:.0f} mm of part"
                f"{' on a table' if track.table else ''} in {plan.duration:.2f} s (standing: "
                f"{'yes' if still else 'out of reach'}), guaranteed {plan.guaranteed}, torque "
                f"{100 * seen.torque:.2f} of {100 * plan.max_torque_ratio:.2f} %, of it the "
                f"carriage {100 * seen.pushed:.1f} %, deviation {seen.deviation_mm:.4f} of "
                f"{1e3 * plan.max_tcp_deviation:.4f} mm, above {found}",
                flush=True,
            )
    print(
        f"{planned} of {count} planned ({standing} from a carriage that stands), {guaranteed} "
        f"guaranteed, {below} with a bound below the truth; the carriage's acceleration is up to "
        f"{100 * max(pushed, default=np.nan):.1f} % of a torque limit (median "
        f"{100 * np.median(pushed) if pushed else np.nan:.1f} %); "
        f"{np.median(used) if used else np.nan:.0f} s of CPU each (median)"
    )


def stands(track: Track, path: ToolPath) -> bool:
    """Whether a carriage that stands in the middle of the part will do."""
    middle = float(1e3 * (track.place + path.position.mean(axis=0)) @ track.unit)
    cell = track.cell().on_rail(float(np.clip(middle, *track.ends)))
    try:
        return isinstance(plan_path(ROBOT, path, cell=cell), Plan)
    except InputError:
        return False


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
