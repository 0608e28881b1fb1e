"""Names on runs of an arm whose file was identified from other runs of it: of an arm that did not
change there are none.

    python -m benchmarks.identified_runs FOLDER [--first 0]

FOLDER holds the recordings of `benchmarks/real_robots.py` (public data, not part of this project).
Of the fifty runs of the LWA 4P every fifth is identified from, the first or another of the first
five on, and all others are diagnosed. One line a run, with errors as rms over mean absolute torque
by joint.
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
from irb2400_ctrl.measurement import read_log

APART = 5
"""every so many runs one that is identified from"""


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0, choices=range(APART))
    args = parser.parse_args()
    robot = CASES["lwa4p"](args.folder).robot
    runs = [read_log(path) for path in sorted((args.folder / "lwa4p").glob("*.gz"))]
    others = [log for k, log in enumerate(runs) if k % APART != args.first]
    named = 0
    refused = 0
    with threadpool_limits(limits=1, user_api="blas"):
        sound = sound_logs(robot, runs[args.first :: APART])
        robot = identify(robot, sound.used).robot
        print(f"identified from {len(sound.used)} runs, {len(sound.left_out)} left out", flush=True)
        for log in others:
            try:
                found = diagnose(robot, log)
            except InputError as error:
                refused += 1
                print(f"{Path(log.name).name}: {error}", flush=True)
                continue
            named += bool(found.findings)
            names = [
                f"{f.effect.kind} {f.effect.joint or ''} {f.confidence:.2f}" for f in found.findings
            ]
            left = found.identification.error_after.rmse_over_mean_percent
            told = ", ".join(names) or "-"
            percent = " ".join(f"{v:.0f}" for v in left)
            print(f"{Path(log.name).name}: {found.verdict}: {told}: {percent} %", flush=True)
    print(f"{named} of {len(others)} runs get a name, {refused} are refused")


if __name__ == "__main__":
    main()
