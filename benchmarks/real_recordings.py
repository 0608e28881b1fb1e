"""`identify` with default settings on five real arms, beside two baselines.

    python -m benchmarks.real_recordings MEASURED [NAME ...] [--swapped]

RMSE over mean torque on logs that were not fitted, per joint [%]: as identified; plain least
squares (base parameters, friction, offset, rotor); the file's bodies with friction, offset and
rotor fitted.
`--swapped`: the logs that judged are fitted, and those that were fitted judge.
The last line is ours over the better of the two: the goal is at most 1.05 on every joint.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.real_robots import CASES, VARIANTS, Case
from irb2400_ctrl.diagnosis.preparation.metrics import errors
from irb2400_ctrl.identification import Identification, identify
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def files_bodies(robot: Robot, logs: Sequence[Log], others: Sequence[Log]) -> np.ndarray:
    """RMSE over mean torque of the file's bodies, drives fitted joint by joint, (n,) [%]."""
    model = Model(fit_base(robot)[0])
    layout = ColumnLayout(robot.n)
    seen = [motion_of(log, "angle") for log in logs]
    unseen = [motion_of(log, "angle") for log in others]
    theta = np.zeros(layout.count)
    theta[: layout.inertial] = model.robot.inertial_parameters.ravel()
    rows = [columns(model, layout, m.q, m.qd, m.qdd) for m in seen]
    for j in range(robot.n):
        own = layout.inertial + robot.n * np.arange(4) + j
        X = np.concatenate([r[m.known[:, j], j] for r, m in zip(rows, seen, strict=True)])
        y = np.concatenate([m.tau[m.known[:, j], j] for m in seen])
        theta[own] = np.linalg.lstsq(X[:, own], y - X @ theta, rcond=None)[0]
    found = []
    for m in unseen:
        torque = columns(model, layout, m.q, m.qd, m.qdd) @ theta
        found.append(errors(m.tau, torque, m.known).rmse_over_mean_percent)
    return np.asarray(np.mean(found, axis=0))


def held_out(result: Identification, which: str) -> np.ndarray:
    """Mean over the validation logs, (n,) [%]."""
    logs = [log for log in result.logs if log.role == "validation"]
    return np.asarray(np.mean([log.error(which).rmse_over_mean_percent for log in logs], axis=0))


def table(case: Case) -> tuple[dict[str, np.ndarray], Identification]:
    """Rows of the table, (n,) each, and what was identified."""
    result = identify(case.robot, case.logs, validation=case.others)
    ours = held_out(result, "unseen")
    plain = held_out(result, "plain")
    # least squares of a user differentiates the angles
    bodies = files_bodies(case.robot, case.logs, case.others)
    ratio = ours / np.minimum(plain, bodies)
    rows = {"identify": ours, "plain": plain, "file's bodies": bodies, "ratio": ratio}
    return rows, result


def swapped(case: Case) -> Case:
    """The same, judged by what was fitted before."""
    return replace(case, logs=case.others, others=case.logs)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("measured", type=Path)
    parser.add_argument("names", nargs="*", default=list(CASES), help="also ur10_cb3")
    parser.add_argument("--swapped", action="store_true")
    args = parser.parse_args()
    for name in args.names:
        case = {**CASES, **VARIANTS}[name](args.measured)
        if args.swapped:
            case = swapped(case)
        start = time.process_time()
        rows, result = table(case)
        print(f"{name}: {time.process_time() - start:.1f} s of CPU")
        for what, values in rows.items():
            digits = 2 if what == "ratio" else 1
            print(f"  {what:<14}" + " ".join(f"{v:7.{digits}f}" for v in values))
        for note in result.notes:
            print(f"  {note}")


if __name__ == "__main__":
    main()
