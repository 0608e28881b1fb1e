"""Angle within which dry friction turns over, as the turns of each arm show it [mrad]: drawn arms
of a plant, or real recordings.

    python -m benchmarks.contact_widths --plant second [--count 20] [--seed S]
    python -m benchmarks.contact_widths --recordings FOLDER

FOLDER is that of `benchmarks/real_robots.py` (public data, not part of this project).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.real_robots import CASES
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts, contacts_of
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.robot import Robot, load_robot

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))


def second(seed: int) -> Iterator[Any]:
    """Logs of arms of the second plant with one effect."""
    from mujoco_plant.machine import RanAway
    from mujoco_plant.suites import suite

    place = 0
    while True:
        (case,) = suite("single", place, 1, seed)
        place += 1
        try:
            yield case.simulate()
        except RanAway:
            continue


def third(seed: int) -> Iterator[Any]:
    """The same of the third plant."""
    from third_plant.case import Case
    from third_plant.suites import plan

    for planned in plan(seed):
        if planned.suite == "single":
            try:
                yield Case(planned).identification()
            except RuntimeError:
                continue


PLANTS: dict[str, Callable[[int], Iterator[Any]]] = {"second": second, "third": third}


def contacts(robot: Robot, log: Log) -> Contacts:
    """Of one log."""
    motion = prepare(log)
    bases = Bases(robot.bare())
    load = bases.model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
    return contacts_of(bases, motion, load)


def said(found: Contacts) -> str:
    """One line."""
    later = f", later on {sorted(found.later)}" if found.later else ""
    return f"{1e3 * found.width:.2f} mrad{later}"


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--plant", choices=PLANTS, default="second")
    parser.add_argument("--count", type=int, default=20, help="arms of the plant")
    parser.add_argument("--seed", type=int, default=None, help="default: a new one, printed")
    parser.add_argument("--recordings", type=Path, default=None, metavar="FOLDER")
    args = parser.parse_args()
    if args.recordings is not None:
        for name in CASES:
            case = CASES[name](args.recordings)
            for log in (*case.logs[:1], *case.others[:1]):
                print(f"{name} {log.name}: {said(contacts(case.robot, log))}", flush=True)
        return
    seed = int(np.random.SeedSequence().entropy % 2**31) if args.seed is None else args.seed
    print(f"seed {seed}")
    robot = load_robot("irb2400")
    widths = []
    for read, _ in zip(PLANTS[args.plant](seed), range(args.count), strict=False):
        log = Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref)
        found = contacts(robot, log)
        print(said(found), flush=True)
        widths.append(1e3 * found.width)
    spread = ", ".join(f"{v:.2f}" for v in np.quantile(widths, [0.1, 0.5, 0.9]))
    print(f"{len(widths)} arms: {spread} mrad (a tenth below, median, a tenth above)")


if __name__ == "__main__":
    main()
