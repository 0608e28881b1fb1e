"""Names on suites of the second plant: one JSON line per arm, a table at the end.

    python -m benchmarks.naming run OUT.jsonl --count 6 [--suites clean,single] [--seed S]
    python -m benchmarks.naming table OUT.jsonl
    python -m benchmarks.naming run OUT.jsonl --by without_each   (rule by rule left out)
    python -m benchmarks.naming differ OUT.jsonl

A run goes on where it stopped: arms that are in OUT.jsonl are not run again. Without a seed a fresh
one is drawn and printed.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from benchmarks.naming.givers import GIVERS
from benchmarks.naming.lines import NoLog, given, go, read
from benchmarks.naming.measures import table
from benchmarks.naming.without_rules import differences
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot, load_robot


def outcome(case: Any, robot: Robot, givers: Sequence[str]) -> list[dict[str, Any]]:
    """One line per giver: truth beside what was said."""
    from mujoco_plant.machine import RanAway

    try:
        seen = case.simulate()
    except RanAway as error:
        raise NoLog(str(error)) from error
    q_ref = seen.q_ref if case.reading.with_reference else None
    log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=q_ref, name=case.name)
    truth = [
        {
            "kind": t.kind,
            "joint": t.joint,
            "main_joint": t.main_joint,
            "size": t.size,
            "fraction": float(t.fractions.max()),
            "strength": t.strength,
            "in_library": t.in_library,
        }
        for t in case.truth
    ]
    about = {"case": case.name, "seed": case.seed, "truth": truth}
    return given(about, log, robot, givers)


def run(args: argparse.Namespace) -> None:
    """Arms of all suites in turn, so that a run cut short has some of each."""
    from mujoco_plant.suites import SUITES, suite

    seed = args.seed
    if seed is None:
        seed = int(np.random.SeedSequence().generate_state(1)[0] % 10**6)
    print(f"seed {seed}", flush=True)
    robot = load_robot("irb2400")
    suites = args.suites.split(",") if args.suites else list(SUITES)
    cases = (
        case
        for k in range(args.start, args.start + args.count)
        for name in suites
        for case in suite(name, k, 1, seed)
    )
    arms = ((case.name, partial(outcome, case, robot)) for case in cases)
    go(Path(args.out), seed, arms, args.by.split(","))


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    runner = commands.add_parser("run", help="give names to arms of the suites")
    runner.add_argument("out")
    runner.add_argument("--suites", help="comma between; default all")
    runner.add_argument("--by", default=",".join(GIVERS), help="comma between; default all")
    runner.add_argument("--count", type=int, default=6, help="arms per suite")
    runner.add_argument("--start", type=int, default=0)
    runner.add_argument("--seed", type=int)
    runner.set_defaults(do=run)
    shower = commands.add_parser("table", help="counts as Markdown")
    shower.add_argument("files", nargs="+")
    shower.set_defaults(do=lambda args: print(table(read(args.files))))
    differ = commands.add_parser("differ", help="arms with other names where a rule is left out")
    differ.add_argument("files", nargs="+")
    differ.set_defaults(do=lambda args: print(differences(read(args.files))))
    args = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        args.do(args)


if __name__ == "__main__":
    main()
