"""Names on runs of an arm whose file was identified from other runs of it: of an arm that did not
change there are none.

    python -m benchmarks.identified_runs FOLDER [--first 0 | --halves] [--load]

FOLDER holds the recordings of `benchmarks/real_robots.py` (public data, not part of this project).
Of the fifty runs of the LWA 4P every fifth is identified from, the first or another of the first
five on, and all others are diagnosed. `--halves`: UR10, TX40, KR300 and Panda, identified from
one part of what is recorded. One line a run, with errors as rms over mean absolute torque by joint.
`--load`: with the torque of a load at the flange added to what is diagnosed, of each arm its own
masses, to see what is lost; the load is found where a body of the last links is named or said.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.real_robots import CASES
from irb2400_ctrl import identify
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.sound_logs import sound_logs
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

APART = 5
"""every so many runs one that is identified from"""
HALVES = {
    "ur10": (1.0, 2.0, 4.0),
    "tx40": (0.5, 1.0),
    "kr300": (30.0, 60.0),
    "panda": (0.5, 1.0, 2.0),
}
"""arms, and loads that are added to each [kg]"""
LWA_LOADS = (2.0,)
LEVER = 0.08
"""[m] from the flange"""


def loaded(robot: Robot, log: Log, mass: float) -> Log:
    """The log with what a load at the flange [kg] would add to its torques."""
    motion = prepare(log)
    more = robot.with_effects(Payload(mass_kg=mass, com_m=(0.0, 0.0, LEVER)))
    states = (motion.q, motion.qd, motion.qdd)
    torques = [Model(arm).inverse_dynamics(*states) for arm in (more, robot)]
    added = motion.as_recorded(np.asarray(torques[0]) - np.asarray(torques[1]))
    at = [np.interp(log.time, motion.time, added[:, j]) for j in range(log.n)]
    return replace(log, tau=log.tau + np.stack(at, axis=1))


def found_load(found: Diagnosis) -> bool:
    """Whether a load is named, or bodies of the last links are, or it is said as moved numbers."""
    last = {found.given.n - 1, found.given.n}
    named = any(
        f.effect.kind == "payload" or (f.effect.kind == "link_inertia" and f.effect.joint in last)
        for f in found.findings
    )
    return named or any(number.name == "load_kg" for number in found.numbers)


def line(robot: Robot, log: Log, mass: float = 0.0) -> tuple[bool, str]:
    """Whether a name is given to a run (of a load: whether it is found), and the verdict in one
    line."""
    found = diagnose(robot, loaded(robot, log, mass) if mass else log)
    names = [f"{f.effect.kind} {f.effect.joint or ''} {f.confidence:.2f}" for f in found.findings]
    left = found.identification.error_after.rmse_over_mean_percent
    told = ", ".join(names) or "-"
    percent = " ".join(f"{v:.0f}" for v in left)
    says = f"{Path(log.name).name}{f' + {mass:g} kg' * (mass > 0)}: {found.verdict}: {told}"
    return found_load(found) if mass else bool(names), f"{says}: {percent} %"


def halves(folder: Path, load: bool) -> None:
    """Four arms: identified from one part of what is recorded, the other diagnosed, both ways."""
    said: list[bool] = []
    for name, masses in HALVES.items():
        case = CASES[name](folder)
        for known, log in ((case.logs, case.others[0]), (case.others, case.logs[0])):
            robot = identify(case.robot, known[:1]).robot
            for mass in masses if load else (0.0,):
                one, text = line(robot, log, mass)
                said.append(one)
                print(f"{name} {text}", flush=True)
    print(f"{sum(said)} of {len(said)} {'loads are found' if load else 'parts get a name'}")


def fifty_runs(folder: Path, first: int, load: bool) -> None:
    """The LWA 4P."""
    robot = CASES["lwa4p"](folder).robot
    runs = [read_log(path) for path in sorted((folder / "lwa4p").glob("*.gz"))]
    others = [log for k, log in enumerate(runs) if k % APART != first]
    counts: list[bool] = []
    refused = 0
    sound = sound_logs(robot, runs[first::APART])
    robot = identify(robot, sound.used).robot
    print(f"identified from {len(sound.used)} runs, {len(sound.left_out)} left out", flush=True)
    for log in others:
        for mass in LWA_LOADS if load else (0.0,):
            try:
                said, text = line(robot, log, mass)
            except InputError as error:
                refused += 1
                print(f"{Path(log.name).name}: {error}", flush=True)
                continue
            counts.append(said)
            print(text, flush=True)
    what = "loads are found" if load else "runs get a name"
    print(f"{sum(counts)} of {len(counts) + refused} {what}, {refused} are refused")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0, choices=range(APART))
    parser.add_argument("--halves", action="store_true")
    parser.add_argument("--load", action="store_true")
    args = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        if args.halves:
            halves(args.folder, args.load)
        else:
            fifty_runs(args.folder, args.first, args.load)


if __name__ == "__main__":
    main()
