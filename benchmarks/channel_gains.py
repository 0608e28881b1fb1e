"""Torque channels that do not read alike: what `identify` makes of them, and of such that do.

    python benchmarks/channel_gains.py [--arms 20] [--first 31000]

Arms of the independent plant whose bodies can exist, each drawn within the uncertainty of a data
sheet, 30 s each. Each is identified twice: with the torques of every joint times a gain drawn from
exp(N(0, 0.15^2)), as of torque constants that are not this drive's, and as they are. Printed: how
far the gains found are off the true ones, both over their middle; RMSE over mean torque on another
motion, as identified and of plain least squares, which takes the torques as they were read, over
that of the same arm read right.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from identification.possible_arms import PossibleCase, log_of, possible_robot

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.preparation.metrics import errors
from irb2400_ctrl.identification.fitting.baseline import plain_least_squares
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns
from irb2400_ctrl.identification.fitting.moments import moments, recordings
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.model import Model

SPREAD = 0.15
SECONDS = 30.0


def logs(robot: irb.Robot, seed: int) -> tuple[irb.Log, irb.Log]:
    """A motion of an arm and another one of the same arm."""
    case = PossibleCase(robot, seed, SECONDS)
    other = PossibleCase(robot, seed + 500_000, SECONDS)
    other.__dict__["machine"] = case.machine
    return log_of(case, name="fitted"), log_of(other, name="other")


def plain(robot: irb.Robot, fitted: irb.Log, other: irb.Log) -> np.ndarray:
    """RMSE over mean torque of plain least squares (base parameters, Coulomb and viscous friction,
    offset, rotor) to one log on the other, (n,) [%]."""
    model = Model(fit_base(robot)[0])
    layout = ColumnLayout(robot.n)
    seen, unseen = (motion_of(log, "angle") for log in (fitted, other))
    sums = moments(model, layout, recordings([seen]))
    theta = plain_least_squares(sums)
    torque = columns(model, layout, unseen.q, unseen.qd, unseen.qdd) @ theta
    return errors(unseen.tau, torque, unseen.known).rmse_over_mean_percent


def identified(
    robot: irb.Robot, fitted: irb.Log, other: irb.Log
) -> tuple[np.ndarray | None, np.ndarray]:
    """Gains found (n,), and RMSE over mean torque on the other log, (n,) [%]."""
    found = irb.identify(robot, fitted, validation=other)
    (judged,) = [log for log in found.logs if log.role == "validation"]
    gains = None if found.gains is None else found.gains.values
    return gains, judged.error("unseen").rmse_over_mean_percent


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=31000)
    args = parser.parse_args()
    robot = possible_robot()
    found = []
    off = []
    false = 0
    ratios: dict[str, list[np.ndarray]] = {"identify": [], "plain": []}
    for seed in range(args.first, args.first + args.arms):
        some = logs(robot, seed)
        true = np.exp(SPREAD * np.random.default_rng([seed, 79]).standard_normal(robot.n))
        none, right = identified(robot, *some)
        false += none is not None
        read = [replace(log, tau=log.tau * true) for log in some]
        gains, error = identified(robot, *read)
        ratios["identify"].append(error / right)
        ratios["plain"].append(plain(robot, *read) / right)
        found.append(gains is not None)
        if gains is not None:
            off.append(gains / np.median(gains) / (true / np.median(true)) - 1.0)
        told = "none" if gains is None else " ".join(f"{100 * v:+.1f}" for v in off[-1])
        print(
            f"arm {seed}: gains off by {told} %; error over that of torques read right: identify "
            f"{np.exp(np.log(ratios['identify'][-1]).mean()):.3f}, plain "
            f"{np.exp(np.log(ratios['plain'][-1]).mean()):.3f}",
            flush=True,
        )
    print(f"gains found on {sum(found)} of {args.arms}; on {false} of {args.arms} read right")
    if off:
        size = np.abs(np.array(off)).ravel()
        print(f"off by {100 * np.median(size):.1f} % in the median, {100 * size.max():.1f} at most")
    for name, rows in ratios.items():
        every = np.log(np.array(rows))
        by_arm = np.exp(every.mean(axis=1))
        print(
            f"{name}: error over that of torques read right {np.exp(every.mean()):.3f}; arms "
            f"{by_arm.min():.3f} to {by_arm.max():.3f}, worst joint {np.exp(every.max()):.2f}"
        )


if __name__ == "__main__":
    main()
