"""Names on the arms of the third plant: one JSON line per arm, a table at the end.

    python -m benchmarks.third_plant run OUT.jsonl [--seed S] [--suites clean,single,pairs,outside]
    python -m benchmarks.third_plant table OUT.jsonl

A seed has 84 arms: 12 clean, 44 with one effect, 12 with two, 16 with one that no library is
expected to know. Without a seed they are those of the first blind logs. A run goes on where it
stopped: arms that are in OUT.jsonl are not run again. Lines are those of `benchmarks.naming`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from benchmarks.naming.givers import GIVERS
from benchmarks.naming.lines import NoLog, given, go, read
from benchmarks.naming.measures import table
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot, load_robot


def outcome(case: Any, robot: Robot, givers: Sequence[str]) -> list[dict[str, Any]]:
    """One line per giver: truth beside what was said."""
    try:
        seen = case.identification()
    except RuntimeError as error:
        raise NoLog(str(error)) from error
    log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref, name=case.name)
    truth = [asdict(t) for t in case.truth]
    about = {"case": case.name, "seed": case.planned.seed, "truth": truth}
    return given(about, log, robot, givers)


def run(args: argparse.Namespace) -> None:
    """Arms of all suites in turn, so that a run cut short has some of each."""
    from third_plant.case import Case
    from third_plant.suites import FIRST_SEED, plan

    seed = FIRST_SEED if args.seed is None else args.seed
    print(f"seed {seed}", flush=True)
    robot = load_robot("irb2400")
    suites = args.suites.split(",")
    plans = [arm for arm in plan(seed) if arm.suite in suites and arm.number < args.count]
    plans.sort(key=lambda one: (one.number, suites.index(one.suite)))
    arms = ((arm.name, partial(_lines, Case, arm, robot)) for arm in plans)
    go(Path(args.out), seed, arms, args.by.split(","))


def _lines(case: Any, arm: Any, robot: Robot, givers: Sequence[str]) -> list[dict[str, Any]]:
    return outcome(case(arm), robot, givers)


def main() -> None:
    """Command line."""
    from third_plant.suites import SUITES

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(required=True)
    runner = commands.add_parser("run", help="give names to the arms of a seed")
    runner.add_argument("out")
    runner.add_argument("--suites", default=",".join(SUITES), help="comma between; default all")
    runner.add_argument("--by", default=",".join(GIVERS), help="comma between; default all")
    runner.add_argument("--count", type=int, default=100, help="arms per suite at most")
    runner.add_argument("--seed", type=int)
    runner.set_defaults(do=run)
    shower = commands.add_parser("table", help="counts as Markdown")
    shower.add_argument("files", nargs="+")
    shower.set_defaults(do=lambda args: print(table(read(args.files))))
    args = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        args.do(args)


if __name__ == "__main__":
    main()
