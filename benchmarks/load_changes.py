"""What the neighbours of a joint tell of a link that has play, on arms of the second plant with one
effect: log odds [nats] where a link was heard to bounce, and whether the diagnosis names it.

python benchmarks/load_changes.py [--count 20] [--seed S]
"""

from __future__ import annotations

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
    from turns import count_and_seed

    count, seed = count_and_seed(__doc__)
    print("| on the arm | arms | that joint is heard | another joint | least to most | named |")
    print("| --- | --- | --- | --- | --- | --- |")
    for place, group in enumerate(GROUPS):
        told = [_of(_case(group, i, [seed, place, i])) for i in range(count)]
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


def _row(arms: list[tuple[Any, dict[int, float], bool]]) -> str:
    """Counts of one group; log odds of those that were heard."""
    right = sum(truth.joint in seen for truth, seen, _ in arms)
    wrong = sum(bool(seen) and truth.joint not in seen for truth, seen, _ in arms)
    heard = [nats for _, seen, _ in arms for nats in seen.values()]
    spread = ", ".join(f"{v:.1f}" for v in np.quantile(heard, [0.0, 0.5, 1.0])) if heard else "-"
    return f"{len(arms)} | {right} | {wrong} | {spread} | {sum(named for *_, named in arms)}"


def _of(case: Any) -> tuple[Any, dict[int, float], bool] | None:
    """What it has, joints that are heard, and whether a diagnosis names it; None where the drives
    do not hold the arm."""
    from turns import left_of

    from irb2400_ctrl import load_robot
    from irb2400_ctrl.diagnosis import diagnose
    from irb2400_ctrl.diagnosis.comparison.at_load_changes import AtLoadChanges

    read = left_of(case)
    if read is None:
        return None
    log, motion, left, bases = read
    seen = AtLoadChanges(motion, left, bases.model).seen
    (truth,) = case.truth
    found = [f.effect for f in diagnose(load_robot("irb2400"), log).findings]
    named = any((e.kind, e.joint) == (truth.kind, truth.joint) for e in found)
    told = [(e.kind, e.joint) for e in found]
    print(f"{truth.kind} {truth.joint}, {truth.strength:.0f} sigma: {seen} {told}", file=sys.stderr)
    return truth, seen, named


if __name__ == "__main__":
    main()
