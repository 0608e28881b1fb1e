"""Share of the torque behind quick turns that a loop leaves, joint by joint: arms of the third
plant, or logs of an IRB 2400.

    python -m benchmarks.quick_turns --seed S [--suites clean,single,pairs]
    python -m benchmarks.quick_turns LOG...

A joint whose share is at most `quick_turns.TAKEN` keeps its rows there; the last lines say which
arms have such a joint, and the least share of all others.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from irb2400_ctrl.diagnosis.preparation.quick_turns import TAKEN, left_by_a_loop
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.robot import load_robot

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
ROBOT = load_robot("irb2400")
BASES = Bases(ROBOT.bare())


def shares(log: Log) -> list[float]:
    """Of each joint, 1.0 where its turns say nothing."""
    motion = prepare(log)
    left = motion.tau - predicted_torque(ROBOT, motion, BASES)
    return [left_by_a_loop(BASES, motion, left[:, j], j) for j in range(motion.n)]


def arms(seed: int, suites: Sequence[str]) -> Iterator[tuple[str, set[int], Log]]:
    """Name, joints (from 1) with a hysteresis, and log."""
    from third_plant.case import Case
    from third_plant.suites import plan

    for planned in plan(seed):
        if planned.suite not in suites:
            continue
        case = Case(planned)
        try:
            seen = case.identification()
        except RuntimeError:
            continue
        loops = {effect.joint for effect in case.made.effects if effect.kind == "hysteresis"}
        log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref, name=case.name)
        yield case.name, loops, log


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("logs", nargs="*")
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--suites", default="clean,single,pairs")
    args = parser.parse_args()
    if not args.logs and args.seed is None:
        parser.error("found neither logs nor a seed, expected LOG... or --seed S")
    files: Iterator[tuple[str, set[int], Log]] = ((p, set(), read_log(p)) for p in args.logs)
    read = files if args.logs else arms(args.seed, args.suites.split(","))
    others = [1.0]
    looked = 0
    for name, loops, log in read:
        looked += 1
        found = dict(enumerate(shares(log), 1))
        told = {j: round(share, 2) for j, share in found.items() if share <= TAKEN or j in loops}
        if told:
            print(f"{name}: hysteresis of {sorted(loops)}, shares {told}", flush=True)
        others += [share for j, share in found.items() if j not in loops]
    print(f"{looked} logs; of joints without a hysteresis the least share is {min(others):.2f}")


if __name__ == "__main__":
    main()
