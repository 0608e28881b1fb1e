"""What the turns of a joint say of an offset and of friction that is larger one way, on arms of the
second plant with one of the two: log odds of the friction [nats].

python benchmarks/turns.py [--count 20] [--seed S]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

KINDS = ("coulomb_asymmetry", "torque_offset")
CLEAR = 3.0
"""[nats]"""


def main() -> None:
    """Command line."""
    from mujoco_plant.suites import suite

    count, seed = count_and_seed(__doc__)
    found: dict[str, list[float]] = {kind: [] for kind in KINDS}
    place = 0
    while min(map(len, found.values())) < count:
        (case,) = suite("single", place, 1, seed)
        place += 1
        kind = case.effects[0].kind
        if kind in KINDS and len(found[kind]) < count:
            nats = _of(case)
            if nats is not None:
                found[kind].append(nats)
    print("| on the arm | arms | clearly friction | clearly not | lowest, median, highest [nats] |")
    print("| --- | --- | --- | --- | --- |")
    for kind, nats in found.items():
        values = np.array(nats)
        spread = ", ".join(f"{v:.1f}" for v in np.quantile(values, [0.0, 0.5, 1.0]))
        clear = f"{np.sum(values > CLEAR)} | {np.sum(values < -CLEAR)}"
        print(f"| {kind} | {len(values)} | {clear} | {spread} |")


def count_and_seed(what: str | None) -> tuple[int, int]:
    """Arms of each kind and the seed, as asked for on the command line; the seed is printed."""
    parser = argparse.ArgumentParser(description=what)
    parser.add_argument("--count", type=int, default=20, help="arms of each kind")
    parser.add_argument("--seed", type=int, default=None, help="default: a new one, printed")
    args = parser.parse_args()
    seed = int(np.random.SeedSequence().entropy % 2**31) if args.seed is None else args.seed
    print(f"seed {seed}")
    return args.count, seed


def left_of(case: Any) -> tuple[Any, Any, Any, Any] | None:
    """Log, prepared motion, what the robot as given leaves of it [Nm], and its bases; None where
    the drives do not hold the arm."""
    from mujoco_plant.machine import RanAway

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
    log = Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref)
    motion = prepare(log)
    bases = Bases(robot.bare())
    return log, motion, motion.tau - predicted_torque(robot, motion, bases), bases


def _of(case: Any) -> float | None:
    """Log odds on one arm; None where its drives do not hold it."""
    from irb2400_ctrl.diagnosis.comparison.at_reversals import AtReversals, log_odds

    read = left_of(case)
    if read is None:
        return None
    _, motion, left, _ = read
    (truth,) = case.truth
    dip = AtReversals(motion, left).dip(truth.joint - 1)
    nats = 0.0 if dip is None else log_odds(dip, truth.size)
    print(f"{truth.kind} {truth.joint}: {truth.size:.2f} Nm, {nats:.1f} nats", flush=True)
    return nats


if __name__ == "__main__":
    main()
