"""What the neighbours of a joint tell of a link that has play, on arms of the second plant with one
effect: log odds [nats] where a link was heard to bounce.

python benchmarks/load_changes.py [--count 20] [--seed S]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

PLAY = ("transmission_backlash",)
SWING = ("elastic_joint",)
GROUPS = {
    "play of a wrist axis": (PLAY, (4, 5, 6)),
    "play of axis 1, 2 or 3": (PLAY, (1, 2, 3)),
    "an elastic joint": (SWING, (1, 2, 3, 4, 5, 6)),
    "another effect": (None, (None,)),
}
"""kinds and joints in turn; none: of the whole library, where it is drawn"""
FRACTIONS = (0.03, 0.05, 0.08, 0.15)
"""rms torque over the joint's"""


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20, help="arms of each group")
    parser.add_argument("--seed", type=int, default=None, help="default: a new one, printed")
    args = parser.parse_args()
    seed = int(np.random.SeedSequence().entropy % 2**31) if args.seed is None else args.seed
    print(f"seed {seed}")
    print("| on the arm | arms | that joint is heard | another joint | lowest, median, highest |")
    print("| --- | --- | --- | --- | --- |")
    for place, group in enumerate(GROUPS):
        told = [_of(_case(group, i, [seed, place, i])) for i in range(args.count)]
        print(f"| {group} | {_row([t for t in told if t is not None])} |", flush=True)


def _case(group: str, i: int, seed: list[int]) -> Any:
    """One arm; its joint drawn by `seed` where the group has none of its own."""
    from mujoco_plant.draws import LIBRARY
    from mujoco_plant.present import Wanted
    from mujoco_plant.suites import Case

    kinds, joints = GROUPS[group]
    if kinds is None:
        kinds = tuple(kind for kind in LIBRARY if kind not in PLAY + SWING)
    wanted = Wanted(
        kinds[i % len(kinds)], joints[i % len(joints)], FRACTIONS[i // 3 % len(FRACTIONS)]
    )
    number = int(np.random.default_rng(seed).integers(2**31))
    return Case(number, (wanted,), chirp=True)


def _row(arms: list[tuple[int | None, dict[int, float]]]) -> str:
    """Counts of one group; log odds of those that were heard."""
    right = sum(joint in seen for joint, seen in arms)
    wrong = sum(bool(seen) and joint not in seen for joint, seen in arms)
    heard = [nats for _, seen in arms for nats in seen.values()]
    spread = ", ".join(f"{v:.1f}" for v in np.quantile(heard, [0.0, 0.5, 1.0])) if heard else "-"
    return f"{len(arms)} | {right} | {wrong} | {spread}"


def _of(case: Any) -> tuple[int | None, dict[int, float]] | None:
    """Its joint and those that are heard; None where the drives do not hold the arm."""
    from mujoco_plant.machine import RanAway

    from irb2400_ctrl.diagnosis.comparison.at_load_changes import AtLoadChanges
    from irb2400_ctrl.diagnosis.regressors.bases import Bases
    from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
    from irb2400_ctrl.measurement import Log
    from irb2400_ctrl.measurement.prepared_log import prepare
    from irb2400_ctrl.robot import load_robot

    try:
        read = case.simulate()
    except RanAway:
        return None
    robot = load_robot("irb2400")
    motion = prepare(Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref))
    bases = Bases(robot.bare())
    left = motion.tau - predicted_torque(robot, motion, bases)
    seen = AtLoadChanges(motion, left, bases.model).seen
    (truth,) = case.truth
    print(f"{truth.kind} {truth.joint}, {truth.strength:.0f} sigma: {seen}", file=sys.stderr)
    return truth.joint, seen


if __name__ == "__main__":
    main()
