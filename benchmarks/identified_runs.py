"""Names on runs of an arm whose file was identified from other runs of it: of an arm that did not
change there are none.

    python -m benchmarks.identified_runs FOLDER [--first 0 | --halves]

FOLDER holds the recordings of `benchmarks/real_robots.py` (public data, not part of this project).
Of the fifty runs of the LWA 4P every fifth is identified from, the first or another of the first
five on, and all others are diagnosed. `--halves`: UR10, TX40, KR300 and Panda, identified from
one part of what is recorded. One line a run, with errors as rms over mean absolute torque by joint.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from threadpoolctl import threadpool_limits

from benchmarks.real_robots import CASES
from irb2400_ctrl import identify
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.sound_logs import sound_logs
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.robot import Robot

APART = 5
"""every so many runs one that is identified from"""
HALVES = ("ur10", "tx40", "kr300", "panda")


def line(robot: Robot, log: Log) -> tuple[bool, str]:
    """Whether a name is given to a run, and the verdict in one line."""
    found = diagnose(robot, log)
    names = [f"{f.effect.kind} {f.effect.joint or ''} {f.confidence:.2f}" for f in found.findings]
    left = found.identification.error_after.rmse_over_mean_percent
    told = ", ".join(names) or "-"
    percent = " ".join(f"{v:.0f}" for v in left)
    return bool(names), f"{Path(log.name).name}: {found.verdict}: {told}: {percent} %"


def halves(folder: Path) -> None:
    """Four arms: identified from one part of what is recorded, the other diagnosed, both ways."""
    named = 0
    for name in HALVES:
        case = CASES[name](folder)
        for known, log in ((case.logs, case.others[0]), (case.others, case.logs[0])):
            said, text = line(identify(case.robot, known[:1]).robot, log)
            named += said
            print(f"{name} {text}", flush=True)
    print(f"{named} of {2 * len(HALVES)} parts get a name")


def fifty_runs(folder: Path, first: int) -> None:
    """The LWA 4P."""
    robot = CASES["lwa4p"](folder).robot
    runs = [read_log(path) for path in sorted((folder / "lwa4p").glob("*.gz"))]
    others = [log for k, log in enumerate(runs) if k % APART != first]
    named = 0
    refused = 0
    sound = sound_logs(robot, runs[first::APART])
    robot = identify(robot, sound.used).robot
    print(f"identified from {len(sound.used)} runs, {len(sound.left_out)} left out", flush=True)
    for log in others:
        try:
            said, text = line(robot, log)
        except InputError as error:
            refused += 1
            print(f"{Path(log.name).name}: {error}", flush=True)
            continue
        named += said
        print(text, flush=True)
    print(f"{named} of {len(others)} runs get a name, {refused} are refused")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0, choices=range(APART))
    parser.add_argument("--halves", action="store_true")
    args = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        if args.halves:
            halves(args.folder)
        else:
            fifty_runs(args.folder, args.first)


if __name__ == "__main__":
    main()
