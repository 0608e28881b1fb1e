"""Names on runs of an arm whose file was identified from other runs of it: of an arm that did not
change there are none.

    python -m benchmarks.identified_runs FOLDER [--robot lwa4p]

FOLDER holds the recordings of `benchmarks/real_robots.py` (public data, not part of this project).
One line a run that was not refused, with errors as rms over mean absolute torque by joint.
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


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--robot", default="lwa4p")
    args = parser.parse_args()
    case = CASES[args.robot](args.folder)
    named = 0
    refused = 0
    with threadpool_limits(limits=1, user_api="blas"):
        sound = sound_logs(case.robot, case.logs)
        robot = identify(case.robot, sound.used).robot
        print(f"identified from {len(sound.used)} runs, {len(sound.left_out)} left out", flush=True)
        for log in case.others:
            try:
                found = diagnose(robot, log)
            except InputError:
                refused += 1
                continue
            named += bool(found.findings)
            names = [
                f"{f.effect.kind} {f.effect.joint or ''} {f.confidence:.2f}" for f in found.findings
            ]
            left = found.identification.error_after.rmse_over_mean_percent
            told = ", ".join(names) or "-"
            percent = " ".join(f"{v:.0f}" for v in left)
            print(f"{Path(log.name).name}: {found.verdict}: {told}: {percent} %", flush=True)
    print(f"{named} of {len(case.others)} runs get a name, {refused} are refused")


if __name__ == "__main__":
    main()
