"""Whether both parts of a real recording tell the same story, and what each costs.

    python -m benchmarks.real_halves FOLDER [--robots kr300,ur10,panda,tx40,lwa4p] [--drawn]
    python -m benchmarks.real_halves FOLDER --whole --robots ur10,panda

FOLDER holds the recordings of `benchmarks/real_robots.py` (public data, not part of this project):
two runs of the KR300, halves of UR10 and Panda, even and odd blocks of the TX40; of the LWA 4P, of
which no body is known, two runs against those that it is identified from. What an arm has, both
parts show: a name that one part alone gives is marked. Errors are rms over mean absolute torque by
joint. `--drawn`: bodies as uncertain as an import of a URDF states them, whatever the case says.
`--whole`: both parts as one record.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.real_robots import CASES
from irb2400_ctrl.diagnosis import Diagnosis, Finding, diagnose
from irb2400_ctrl.identification import diagnose_change
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot.importing.chain_robot import DRAWN

Name = tuple[str, int | None]


def story(found: Diagnosis) -> dict[Name, Finding]:
    """Findings by kind and joint."""
    return {(f.effect.kind, f.effect.joint): f for f in found.findings}


def told(found: Diagnosis, other: Diagnosis) -> str:
    """One line per name, marked where the other part does not say it."""
    beside = story(other)
    lines = []
    for name, finding in story(found).items():
        kinds = {name[0], *finding.alternatives}
        same = any(kind in kinds and joint == name[1] for kind, joint in beside)
        mark = "" if same else "   this part alone"
        lines.append(
            f"    {name[0]} {name[1] or ''} {finding.confidence:.2f}, "
            f"share {finding.share.max():.3f}{mark}"
        )
    places = [u.joint for u in found.unexplained]
    lines.append(f"    unexplained on {places}, beyond noise on {list(found.beyond_noise)}")
    compared = found.identification
    before, after = (
        " ".join(f"{v:.0f}" for v in error.rmse_over_mean_percent)
        for error in (compared.error_before, compared.error_after)
    )
    lines.append(f"    before {before} %, after {after} %")
    return "\n".join(lines)


def _whole(one: Log, other: Log) -> Log:
    """Two parts of one record."""
    speeds = None if one.qd is None or other.qd is None else np.concatenate([one.qd, other.qd])
    return Log(
        np.concatenate([one.time, other.time]),
        np.concatenate([one.q, other.q]),
        np.concatenate([one.tau, other.tau]),
        qd=speeds,
        name=f"{one.name} and the rest",
    )


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--robots", default="kr300,ur10,panda,tx40,lwa4p")
    parser.add_argument("--drawn", action="store_true")
    parser.add_argument("--whole", action="store_true")
    args = parser.parse_args()
    for name in args.robots.split(","):
        case = CASES[name](args.folder)
        if args.drawn:
            spreads = case.robot.uncertainty.model_copy(update=DRAWN)
            case = replace(case, robot=case.robot.model_copy(update={"uncertainty": spreads}))
        found = []
        print(name, flush=True)
        parts = case.others[:8:7] if name == "lwa4p" else (case.logs[0], case.others[0])
        for log in (_whole(*parts),) if args.whole else parts:
            start = time.process_time()
            with threadpool_limits(limits=1, user_api="blas"):
                if name == "lwa4p":
                    found.append(diagnose_change(case.robot, log, case.logs))
                else:
                    found.append(diagnose(case.robot, log))
            cpu = time.process_time() - start
            print(f"  {log.name}: {log.duration:.0f} s, {found[-1].verdict}, {cpu:.1f} s of CPU")
        for one, other in zip(found, found[::-1], strict=True):
            print(f"  {one.identification.name}\n{told(one, other)}", flush=True)


if __name__ == "__main__":
    main()
